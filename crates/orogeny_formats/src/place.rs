//! The file an error is about.
//!
//! Decoders make errors in many places; [`Place`] carries what every one of them names.

use std::fs::{File, Metadata};
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::format::Format;

/// A file and what it is read or written as.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    /// The file.
    pub path: PathBuf,
    /// What it is read or written as.
    pub format: Format,
}

impl Place {
    /// An error for a file that breaks its format's rules.
    pub fn malformed(&self, reason: impl Into<String>) -> Error {
        Error::Malformed { path: self.path.clone(), format: self.format, reason: reason.into() }
    }

    /// An error for a kind of file that is not read.
    pub fn unsupported(&self, reason: impl Into<String>) -> Error {
        Error::Unsupported { path: self.path.clone(), format: self.format, reason: reason.into() }
    }

    /// An error for a file that ends too early.
    pub fn truncated(&self) -> Error {
        Error::Truncated { path: self.path.clone(), format: self.format }
    }

    /// An error of the operating system while reading; an early end is told as such.
    pub fn reading(&self, source: io::Error) -> Error {
        match source.kind() {
            io::ErrorKind::UnexpectedEof => self.truncated(),
            // Decompressors report damage this way.
            io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput => self.malformed(source.to_string()),
            _ => Error::Io { path: self.path.clone(), doing: "read", source },
        }
    }

    /// An error of the operating system while writing.
    pub fn writing(&self, source: io::Error) -> Error {
        Error::Io { path: self.path.clone(), doing: "write", source }
    }

    /// An error for work that would need too much memory, or nothing if `needed` is within `limit`.
    pub fn check_memory(
        &self,
        what: &'static str,
        needed: u64,
        limit: u64,
        instead: &'static str,
    ) -> Result<()> {
        if needed <= limit {
            return Ok(());
        }
        Err(Error::Memory { path: self.path.clone(), what, needed, limit, instead })
    }

    /// Refuses a raster whose sides are 0 or above `limit`.
    pub fn check_size(&self, width: u64, depth: u64, limit: u32) -> Result<(u32, u32)> {
        let side = |samples: u64| u32::try_from(samples).ok().filter(|side| (1..=limit).contains(side));
        match (side(width), side(depth)) {
            (Some(width), Some(depth)) => Ok((width, depth)),
            _ => Err(Error::Size { path: self.path.clone(), width, depth, limit }),
        }
    }

    /// Opens the file for reading; its length comes with it.
    pub fn open(&self) -> Result<(BufReader<File>, u64)> {
        let metadata = plain_file(&self.path)?;
        let file = File::open(&self.path).map_err(|source| Error::Io {
            path: self.path.clone(),
            doing: "open",
            source,
        })?;
        Ok((BufReader::with_capacity(1 << 16, file), metadata.len()))
    }
}

/// The metadata of a path that must be a plain file.
pub(crate) fn plain_file(path: &Path) -> Result<Metadata> {
    if path.as_os_str().is_empty() {
        return Err(Error::EmptyPath);
    }
    match path.metadata() {
        Ok(metadata) if metadata.is_file() => Ok(metadata),
        Ok(_) => Err(Error::NotAFile { path: path.to_path_buf() }),
        Err(err) if matches!(err.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
            Err(Error::NotFound { path: path.to_path_buf(), what: "file" })
        }
        Err(source) => Err(Error::Io { path: path.to_path_buf(), doing: "look at", source }),
    }
}
