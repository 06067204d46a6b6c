//! Child processes: a test binary started again, in the role that an environment variable names.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Set in a child: the terrain or folder that it works on.
const CHILD_PATH: &str = "OROGENY_TEST_CHILD";

/// What a child was started for; `None` in the parent.
#[must_use]
#[allow(clippy::print_stdout, reason = "standard output is how a child speaks with its parent")]
pub fn child_path() -> Option<PathBuf> {
    let path = std::env::var_os(CHILD_PATH)?;
    // The test harness leaves the name of the test on the line.
    println!();
    Some(PathBuf::from(path))
}

/// This test again, by its full name, as a child that works on `path`, its output piped.
///
/// # Panics
/// Where the system does not say what binary this is.
#[must_use]
pub fn child(test: &str, path: &Path) -> Command {
    let mut command = Command::new(std::env::current_exe().expect("this binary"));
    as_child(&mut command, path).args(child_arguments(test));
    command
}

/// What makes a test binary run one test.
#[must_use]
pub const fn child_arguments(test: &str) -> [&str; 3] {
    ["--exact", test, "--nocapture"]
}

/// Makes any command the child of a test.
pub fn as_child<'a>(command: &'a mut Command, path: &Path) -> &'a mut Command {
    command.env(CHILD_PATH, path).stdin(Stdio::piped()).stdout(Stdio::piped())
}

/// Tells the parent that something is done.
#[allow(clippy::print_stdout, reason = "standard output is how a child speaks with its parent")]
pub fn acknowledge(what: &str) {
    println!("ack {what}");
}

/// The lines of a child; one cut off by its end does not count.
#[must_use]
pub fn whole_lines(output: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(output);
    text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n')).map(str::to_owned).collect()
}

/// Everything that a child acknowledged.
#[must_use]
pub fn acknowledged(output: &[u8]) -> Vec<String> {
    let lines = whole_lines(output);
    lines.iter().filter_map(|line| line.strip_prefix("ack ").map(str::to_owned)).collect()
}

/// Whether the long, exhaustive form of a test was asked for.
#[must_use]
pub fn is_long() -> bool {
    std::env::var_os("OROGENY_TEST_LONG").is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_was_cut_off_does_not_count() {
        assert_eq!(acknowledged(b"\nack 1\nother\nack 2 3\nack 4"), ["1", "2 3"]);
        assert!(acknowledged(b"ack").is_empty());
    }
}
