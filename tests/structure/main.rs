//! The shape of the repository, held by tests: which crate may see which, which file belongs to which, how long and
//! how big a file may be.
//!
//! Each check is a function over data, and beside the test that runs it on this repository stand tests that show it
//! failing on made-up bad data.

#![cfg(test)]

mod files;
mod graph;
mod layering;
mod stems;

use std::path::{Path, PathBuf};

/// The repository's root.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// Fails with all problems at once, one a line.
fn assert_none(problems: &[String]) {
    assert!(problems.is_empty(), "problems: {}\n  {}", problems.len(), problems.join("\n  "));
}
