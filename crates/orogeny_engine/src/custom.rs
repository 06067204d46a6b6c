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
}

impl CustomBrushFile {
    /// Opens and compiles a file.
    ///
    /// # Errors
    /// [`Error::Read`]; [`Error::Shader`] with every error and its line.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self> {
        let path = path.into();
        let stamp = stamp(&path)?;
        let program = Arc::new(compile(&path)?);
        Ok(Self { path, stamp: Some(stamp), program })
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
        let stamp = stamp(&self.path)?;
        if self.stamp == Some(stamp) {
            return Ok(false);
        }
        self.stamp = Some(stamp);
        self.program = Arc::new(compile(&self.path)?);
        Ok(true)
    }
}

fn stamp(path: &Path) -> Result<(u64, SystemTime)> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let metadata = std::fs::metadata(path).map_err(failed)?;
    Ok((metadata.len(), metadata.modified().map_err(failed)?))
}

fn compile(path: &Path) -> Result<CustomProgram> {
    let bytes = resources::read(path, MAX_BYTES)?;
    resources::compile(bytes, &path.to_string_lossy(), path.to_string_lossy().into_owned())
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
        assert!(!file.refresh().unwrap(), "what is wrong is told once");
        std::fs::write(&path, good.replace("Lifts", "Lifts again")).unwrap();
        file.stamp = None;
        assert!(file.refresh().unwrap());
        assert_eq!(file.summary(), "Lifts again.");
        assert!(CustomBrushFile::open(folder.path().join("none.wgsl")).is_err());
    }
}
