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

/// See [`super::test_tools()`].
pub fn test_tools() {
    for Tool { program, asked_by, package } in TOOLS {
        let is_there = || succeeds(Command::new(program).arg(asked_by));
        let by_other_means = format!("{program} with this system's package manager");
        let install = || apt::install(&[package], &by_other_means);
        println!("test tools: {}", ensure(program, is_there, install));
    }
}

/// Installs what is not there, and says what came of it: without it tests skip themselves, so nothing fails here.
fn ensure(
    program: &str,
    is_there: impl Fn() -> bool,
    install: impl FnOnce() -> anyhow::Result<()>,
) -> String {
    if is_there() {
        return format!("{program} is there");
    }
    println!("test tools: {program} is missing");
    match install() {
        Ok(()) if is_there() => format!("{program} is installed"),
        Ok(()) => format!("{program} is installed, but does not run: the tests that need it will skip"),
        Err(err) => format!("the tests that need {program} will skip: {err}"),
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
        assert!(ensure("strace", || false, || Ok(())).contains("will skip"));
    }
}
