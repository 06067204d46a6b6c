//! Skips: never silent.

use std::ffi::OsStr;
use std::io::Write as _;

/// The file to which `cargo xtask test` has skips written, and which it counts.
const VARIABLE: &str = "OROGENY_SKIP_LOG";

/// Says that the test `name` is left out and why; the test then returns. Only for what a machine cannot have, and never for a
/// missing GPU driver or fixture: those are failures.
///
/// # Panics
/// Where the skip cannot be written down.
pub fn skip(name: &str, reason: &str) {
    skip_to(std::env::var_os(VARIABLE).as_deref(), name, reason);
}

#[allow(clippy::print_stderr, reason = "a skip is to be seen")]
fn skip_to(log: Option<&OsStr>, name: &str, reason: &str) {
    let line = format!("{name}: {}", reason.replace('\n', " "));
    eprintln!("SKIPPED {line}");
    if let Some(log) = log {
        let file = std::fs::OpenOptions::new().append(true).create(true).open(log);
        // One write, so that the lines of tests that skip at once do not mix.
        let written = file.and_then(|mut file| file.write_all(format!("{line}\n").as_bytes()));
        written.unwrap_or_else(|err| panic!("the skip of {line} cannot be written down: {err}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_skip_is_one_line_at_the_end_of_the_log() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("skips");
        std::fs::write(&log, "before: it\n").unwrap();
        skip_to(Some(log.as_os_str()), "first", "no\ndata");
        skip_to(Some(log.as_os_str()), "second", "no time");
        assert_eq!(std::fs::read_to_string(&log).unwrap(), "before: it\nfirst: no data\nsecond: no time\n");
    }

    #[test]
    #[should_panic(expected = "cannot be written down")]
    fn a_skip_that_cannot_be_counted_is_a_failure() {
        let folder = tempfile::tempdir().unwrap();
        skip_to(Some(folder.path().as_os_str()), "first", "no data");
    }

    #[test]
    fn without_a_log_a_skip_is_only_said() {
        skip_to(None, "first", "no data");
    }
}
