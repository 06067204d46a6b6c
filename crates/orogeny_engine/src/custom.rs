//! Custom brushes as files that change while the program runs.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use orogeny_brush::CustomProgram;
pub use orogeny_shaders::custom::CustomParameter;

use crate::resources;
use crate::{Error, Result};

/// The most bytes that are read.
const MAX_BYTES: u64 = 1 << 20;

/// A user's WGSL file: compiled when it is opened and whenever it has changed. What does not compile leaves the last good one.
#[derive(Debug)]
pub struct CustomBrushFile {
    path: PathBuf,
    /// Of the content that was looked at last, good or not.
    stamp: Option<(u64, SystemTime)>,
    program: Arc<CustomProgram>,
    /// What the last good one was made of.
    text: Vec<u8>,
    /// Whether the file is that.
    is_good: bool,
    /// Where the last good one lies while the file is not that.
    copy: Option<tempfile::TempDir>,
}

impl CustomBrushFile {
    /// Opens and compiles a file.
    ///
    /// # Errors
    /// [`Error::Read`]; [`Error::Shader`] with every error and its line.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self> {
        let path = path.into();
        let stamp = stamp(&path)?;
        let (text, program) = compile(&path)?;
        Ok(Self { path, stamp: Some(stamp), program: Arc::new(program), text, is_good: true, copy: None })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The last good one's first line of comment.
    #[must_use]
    pub fn summary(&self) -> &str {
        &self.program.brush.summary
    }

    /// The last good one's parameters.
    #[must_use]
    pub fn parameters(&self) -> &[CustomParameter] {
        &self.program.brush.parameters
    }

    /// How many operations the last good one takes for one sample and instance at most.
    #[must_use]
    pub fn num_operations(&self) -> u64 {
        self.program.brush.num_operations
    }

    /// Compiles the file anew where it has changed; whether it had. What is wrong with a changed file is told once, and the last
    /// good one stays.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn refresh(&mut self) -> Result<bool> {
        let stamp = stamp(&self.path);
        if stamp.as_ref().ok().is_some_and(|stamp| self.stamp == Some(*stamp)) {
            return Ok(false);
        }
        self.is_good = false;
        self.stamp = Some(stamp?);
        let (text, program) = compile(&self.path)?;
        (self.text, self.program, self.is_good, self.copy) = (text, Arc::new(program), true, None);
        Ok(true)
    }

    /// A file with the last good one, to paint with: the file itself or, where that is not good, a copy of what it was before, which
    /// is there for as long as this is.
    ///
    /// # Errors
    /// [`Error::Write`] where no copy can be made.
    pub fn good_file(&mut self) -> Result<PathBuf> {
        if self.is_good {
            return Ok(self.path.clone());
        }
        let name = self.path.file_name().unwrap_or_default();
        if let Some(folder) = &self.copy {
            return Ok(folder.path().join(name));
        }
        let failed = |source| Error::Write { path: std::env::temp_dir(), source };
        let folder = tempfile::tempdir().map_err(failed)?;
        let path = folder.path().join(name);
        std::fs::write(&path, &self.text).map_err(failed)?;
        self.copy = Some(folder);
        Ok(path)
    }
}

fn stamp(path: &Path) -> Result<(u64, SystemTime)> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let metadata = std::fs::metadata(path).map_err(failed)?;
    Ok((metadata.len(), metadata.modified().map_err(failed)?))
}

fn compile(path: &Path) -> Result<(Vec<u8>, CustomProgram)> {
    let bytes = resources::read(path, MAX_BYTES)?;
    let name = path.to_string_lossy();
    let program = resources::compile(bytes.clone(), &name, name.clone().into_owned())?;
    Ok((bytes, program))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_breaks_leaves_the_last_good_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lift.wgsl");
        let good = "// Lifts.\nfn brush(at: BrushInput) -> f32 {\n    return at.height_m + at.weight;\n}\n";
        std::fs::write(&path, good).unwrap();
        let mut file = CustomBrushFile::open(&path).unwrap();
        assert_eq!((file.summary(), file.parameters().len()), ("Lifts.", 0));
        assert!(!file.refresh().unwrap(), "it has not changed");
        std::fs::write(&path, good.replace("weight;", "waight;")).unwrap();
        // Two writes may fall into one tick of the file system's clock.
        file.stamp = None;
        let err = file.refresh().unwrap_err().to_string();
        assert!(err.contains("lift.wgsl:3"), "{err}");
        assert_eq!(file.summary(), "Lifts.");
        let copy = file.good_file().unwrap();
        assert!(copy != path && std::fs::read_to_string(&copy).unwrap() == good);
        assert!(!file.refresh().unwrap(), "what is wrong is told once");
        std::fs::write(&path, good.replace("Lifts", "Lifts again")).unwrap();
        file.stamp = None;
        assert!(file.refresh().unwrap());
        assert_eq!(file.summary(), "Lifts again.");
        assert!(file.good_file().unwrap() == path && !copy.exists());
        std::fs::remove_file(&path).unwrap();
        file.refresh().unwrap_err();
        assert!(file.good_file().unwrap() != path, "it paints on");
        assert!(CustomBrushFile::open(folder.path().join("none.wgsl")).is_err());
    }
}
