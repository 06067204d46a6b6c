//! The `.json` file beside a picture or a headless file, which says what its samples mean.
//!
//! `hill.png` has `hill.png.json`. It is written when a range is given, for without one a sample is a whole metre.
//! On import it is not obeyed, since a file without a given range is metres one to one; but what it says is told.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::format::SampleType;
use crate::options::ImportOptions;
use crate::place::Place;

/// The longest sidecar that is read, bytes.
const MAX_BYTES: u64 = 1 << 16;

/// What a file of integer samples does not say of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Sidecar {
    /// Heights in metres of the sample 0 and of the greatest sample.
    pub range_m: (f64, f64),
    /// Samples from west to east.
    pub width: u32,
    /// Rows from north to south.
    pub depth: u32,
    /// Distance between samples, metres, if it is known.
    pub spacing_m: Option<f64>,
    /// The sample type: `u8` or `u16`.
    pub sample: String,
    /// `little` or `big`; PNG is always big.
    pub byte_order: String,
}

impl Sidecar {
    /// Where the sidecar of a file is.
    pub fn path_of(file: &Path) -> PathBuf {
        let mut path = file.as_os_str().to_owned();
        path.push(".json");
        PathBuf::from(path)
    }

    /// The sidecar of a file; none where there is none, or something else is in its place.
    pub fn of(file: &Path) -> Option<Self> {
        let path = Self::path_of(file);
        let is_short =
            path.metadata().is_ok_and(|metadata| metadata.is_file() && metadata.len() <= MAX_BYTES);
        let text = is_short.then(|| fs::read_to_string(&path).ok()).flatten()?;
        serde_json::from_str(&text).ok()
    }

    /// Writes the sidecar of `file`, whole or not at all.
    pub(crate) fn write(&self, file: &Path) -> Result<()> {
        let path = Self::path_of(file);
        let failed = |source| Error::Io { path: path.clone(), doing: "write", source };
        let mut temporary = crate::export::temporary_beside(&path)?;
        let text = serde_json::to_string_pretty(self).map_err(|err| failed(err.into()))?;
        writeln!(temporary, "{text}").map_err(failed)?;
        temporary.as_file().sync_all().map_err(failed)?;
        temporary.persist(&path).map_err(|err| failed(err.error))?;
        Ok(())
    }

    /// Removes the sidecar of an earlier export, which would now speak falsely. Another program's file stays.
    pub(crate) fn remove(file: &Path) -> Result<()> {
        if Self::of(file).is_none() {
            return Ok(());
        }
        let path = Self::path_of(file);
        fs::remove_file(&path).map_err(|source| Error::Io { path: path.clone(), doing: "remove", source })
    }
}

/// What a person should know of how integer samples were read.
pub(crate) fn import_notices(place: &Place, sample: SampleType, options: &ImportOptions) -> Vec<String> {
    if sample.range_maximum().is_none() || options.range_m.is_some() {
        return Vec::new();
    }
    let mut notices = vec![format!("no range was given: its {sample} samples are read as whole metres")];
    if let Some(Sidecar { range_m: (low, high), .. }) = Sidecar::of(&place.path) {
        notices.push(format!(
            "{} says its range is {low},{high}: give that to read it so",
            Sidecar::path_of(&place.path).display()
        ));
    }
    notices
}
