//! strace, with which the storage tests cause faults at single system calls.

use std::process::Command;

use super::apt;
use crate::cargo::succeeds;

const PACKAGES: [&str; 1] = ["strace"];
const BY_OTHER_MEANS: &str = "strace with this system's package manager";

/// See [`super::tracer()`].
pub fn tracer() {
    let is_there = || succeeds(Command::new("strace").arg("--version"));
    println!("tracer: {}", ensure(is_there, || apt::install(&PACKAGES, BY_OTHER_MEANS)));
}

/// Installs what is not there, and says what came of it: without it tests skip themselves, so nothing fails here.
fn ensure(is_there: impl Fn() -> bool, install: impl FnOnce() -> anyhow::Result<()>) -> String {
    if is_there() {
        return "strace is there".to_owned();
    }
    println!("tracer: strace is missing");
    match install() {
        Ok(()) if is_there() => "strace is installed".to_owned(),
        Ok(()) => "strace is installed, but does not run: the tests that need it will skip".to_owned(),
        Err(err) => format!("the tests that need strace will skip: {err}"),
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn what_is_there_is_not_installed_again() {
        let installs = |is_there: bool, works: bool| {
            let is_there = Cell::new(is_there);
            ensure(
                || is_there.get(),
                || {
                    is_there.set(works);
                    if works { Ok(()) } else { anyhow::bail!("no right to install packages") }
                },
            )
        };
        assert_eq!(installs(true, false), "strace is there");
        assert_eq!(installs(false, true), "strace is installed");
        let failed = installs(false, false);
        assert!(failed.contains("will skip") && failed.contains("no right"), "{failed}");
        assert!(ensure(|| false, || Ok(())).contains("will skip"));
    }
}
