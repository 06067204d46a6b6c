//! The one error type of this crate.

use std::io;
use std::path::PathBuf;

use crate::compile::Diagnostic;

/// The result of compiling shaders.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a folder of shaders could not be compiled.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder could not be read: check that it exists and may be read.
    #[error("cannot read {}: {source}; check that it exists and may be read", path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },

    /// The folder is larger than any real one: check that it is the shader folder.
    #[error("more than {limit} {unit} of shaders below {root}; check that this is the shader folder")]
    TooLarge {
        /// The folder.
        root: String,
        /// The largest number that is read.
        limit: usize,
        /// What was counted: files, bytes.
        unit: &'static str,
    },

    /// There is no entry-point file, so nothing would have been checked: add one, or correct the path.
    #[error("no entry-point file below {root}; expected at least one .wgsl file in {folders}")]
    NoShaders {
        /// The folder.
        root: String,
        /// The folders that hold entry-point files, separated by commas.
        folders: String,
    },

    /// Some shaders are wrong; every error found, sorted by file and line.
    #[error("{} in the shaders\n\n{}", count(diagnostics), list(diagnostics))]
    Broken {
        /// What is wrong and where; never empty.
        diagnostics: Vec<Diagnostic>,
    },

    /// A custom brush is wrong; every error found, sorted by line.
    #[error("{} in {file}\n\n{}", count(diagnostics), list(diagnostics))]
    BrokenBrush {
        /// The file, as the caller named it.
        file: String,
        /// What is wrong and where; never empty.
        diagnostics: Vec<Diagnostic>,
    },

    /// The compiler stopped in the middle of a custom brush, which is a mistake in the compiler: report the file.
    #[error(
        "the shader compiler failed on {file}; write the brush in another way, and report the file as a mistake"
    )]
    CompilerFailed {
        /// The file, as the caller named it.
        file: String,
    },

    /// The system gave no thread to compile a custom brush on: try again when it has less to do.
    #[error("no thread to compile the brush on: {source}; try again when the system has less to do")]
    Thread {
        /// What the system said.
        source: io::Error,
    },
}

fn count(diagnostics: &[Diagnostic]) -> String {
    match diagnostics.len() {
        1 => "1 error".to_owned(),
        n => format!("{n} errors"),
    }
}

fn list(diagnostics: &[Diagnostic]) -> String {
    diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}
