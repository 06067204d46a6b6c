//! Programs that some tests work by: strace, with which the storage tests cause faults at single system calls; a screen that no one sees,
//! and hands for its mouse and keys, for the editor; a browser for the page of the service.

use std::process::Command;

use super::apt;
use crate::cargo::succeeds;

/// A program, how it is asked whether it is there, and its package.
struct Tool {
    program: &'static str,
    asked_by: &'static str,
    package: &'static str,
}

const TOOLS: [Tool; 4] = [
    Tool { program: "strace", asked_by: "--version", package: "strace" },
    Tool { program: "Xvfb", asked_by: "-help", package: "xvfb" },
    Tool { program: "xdotool", asked_by: "--version", package: "xdotool" },
    Tool { program: "chromium", asked_by: "--version", package: "chromium" },
];

const VALGRIND: Tool = Tool { program: "valgrind", asked_by: "--version", package: "valgrind" };

/// See [`super::test_tools()`].
pub fn test_tools() {
    for tool in TOOLS {
        println!("test tools: {}", tool.ensure("the tests that need it"));
    }
}

/// See [`super::valgrind()`].
pub fn valgrind() -> bool {
    println!("test tools: {}", VALGRIND.ensure("the counting of instructions"));
    VALGRIND.is_there()
}

impl Tool {
    fn is_there(&self) -> bool {
        succeeds(Command::new(self.program).arg(self.asked_by))
    }

    fn ensure(&self, what_skips: &str) -> String {
        let by_other_means = format!("{} with this system's package manager", self.program);
        let install = || apt::install(&[self.package], &by_other_means);
        ensure(self.program, what_skips, || self.is_there(), install)
    }
}

/// Installs what is not there, and says what came of it: without it tests skip themselves, so nothing fails here.
fn ensure(
    program: &str,
    what_skips: &str,
    is_there: impl Fn() -> bool,
    install: impl FnOnce() -> anyhow::Result<()>,
) -> String {
    if is_there() {
        return format!("{program} is there");
    }
    println!("test tools: {program} is missing");
    match install() {
        Ok(()) if is_there() => format!("{program} is installed"),
        Ok(()) => format!("{program} is installed, but does not run: {what_skips} will skip"),
        Err(err) => format!("{program} cannot be installed, so {what_skips} will skip: {err}"),
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
                "strace",
                "its tests",
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
        assert!(ensure("strace", "its tests", || false, || Ok(())).contains("will skip"));
    }
}
