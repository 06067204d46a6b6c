//! `check`: everything that is known about the code without running its tests, each step timed.
//!
//! Every step runs even when one fails, so that one run shows all there is to mend. The compiling steps choose the
//! whole workspace, also where one package would do: cargo then picks the same features as in `cargo xtask test`, and
//! neither compiles a dependency again that the other has.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::bail;

use crate::cargo::{cargo, status, succeeds};
use crate::setup;

/// Which steps run.
#[derive(Debug, Default, PartialEq)]
pub struct Selection {
    /// Only these, where there is one.
    pub only: Vec<String>,
    /// Not these.
    pub skip: Vec<String>,
}

/// How a step ended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Outcome {
    Passed,
    Failed,
    /// Not run, and why.
    Skipped(&'static str),
}

struct Step {
    name: &'static str,
    run: fn() -> anyhow::Result<Outcome>,
}

/// In running order: the quick ones first.
const STEPS: [Step; 7] = [
    Step { name: "fmt", run: fmt },
    Step { name: "shaders", run: shaders },
    Step { name: "clippy", run: clippy },
    Step { name: "docs", run: docs },
    Step { name: "structure", run: structure },
    Step { name: "instructions", run: instructions },
    Step { name: "deny", run: deny },
];

/// Runs the selected steps and sums them up.
///
/// # Errors
///
/// A step that does not exist is named, or none is left.
pub fn run(selection: &Selection) -> anyhow::Result<ExitCode> {
    let steps = select(&STEPS, selection)?;
    let mut results = Vec::new();
    for step in steps {
        println!("\n== check: {}", step.name);
        let start = Instant::now();
        let outcome = (step.run)().unwrap_or_else(|err| {
            println!("error: {err:#}");
            Outcome::Failed
        });
        results.push((step.name, outcome, start.elapsed()));
    }

    println!("\n== check: summary");
    for (name, outcome, duration) in &results {
        println!("{}", summary_line(name, *outcome, *duration));
    }
    let count =
        |wanted: fn(&Outcome) -> bool| results.iter().filter(|(_, outcome, _)| wanted(outcome)).count();
    let num_failed = count(|outcome| *outcome == Outcome::Failed);
    let num_skipped = count(|outcome| matches!(outcome, Outcome::Skipped(_)));
    println!(
        "{} steps passed, {num_failed} failed, {num_skipped} skipped",
        results.len() - num_failed - num_skipped
    );
    Ok(if num_failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn select<'a>(steps: &'a [Step], selection: &Selection) -> anyhow::Result<Vec<&'a Step>> {
    for name in selection.only.iter().chain(&selection.skip) {
        if !steps.iter().any(|step| step.name == name) {
            let names: Vec<_> = steps.iter().map(|step| step.name).collect();
            bail!("there is no step `{name}`; the steps are {}", names.join(", "));
        }
    }
    let wanted = |step: &&Step| {
        (selection.only.is_empty() || selection.only.iter().any(|name| name == step.name))
            && !selection.skip.iter().any(|name| name == step.name)
    };
    let selected: Vec<_> = steps.iter().filter(wanted).collect();
    if selected.is_empty() {
        bail!("--only and --skip leave no step to run");
    }
    Ok(selected)
}

fn summary_line(name: &str, outcome: Outcome, duration: Duration) -> String {
    let seconds = duration.as_secs_f64();
    match outcome {
        Outcome::Passed => format!("  {name:<12} passed   {seconds:7.1} s"),
        Outcome::Failed => format!("  {name:<12} FAILED   {seconds:7.1} s"),
        Outcome::Skipped(why) => format!("  {name:<12} SKIPPED  {seconds:7.1} s  ({why})"),
    }
}

fn outcome_of(command: &mut std::process::Command) -> anyhow::Result<Outcome> {
    Ok(if status(command)?.success() { Outcome::Passed } else { Outcome::Failed })
}

fn fmt() -> anyhow::Result<Outcome> {
    setup::component("rustfmt")?;
    outcome_of(&mut cargo(["fmt", "--all", "--check"]))
}

/// The build script of the shader crate resolves, validates and lints every shader.
fn shaders() -> anyhow::Result<Outcome> {
    outcome_of(&mut cargo(["check", "--package", "orogeny_shaders"]))
}

fn clippy() -> anyhow::Result<Outcome> {
    setup::component("clippy")?;
    outcome_of(&mut cargo(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))
}

fn docs() -> anyhow::Result<Outcome> {
    outcome_of(cargo(["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
}

/// The layers, the stage stems and the files' shape: `tests/structure`.
fn structure() -> anyhow::Result<Outcome> {
    outcome_of(&mut cargo(["test", "--workspace", "--test", "structure"]))
}

/// What each CPU kernel costs: `tools/instructions`.
fn instructions() -> anyhow::Result<Outcome> {
    use crate::instructions::Outcome as Counted;
    Ok(match crate::instructions::compare()? {
        Counted::Same => Outcome::Passed,
        Counted::Different => Outcome::Failed,
        Counted::NotCounted(why) => Outcome::Skipped(why),
    })
}

fn deny() -> anyhow::Result<Outcome> {
    if !succeeds(&mut cargo(["deny", "--version"])) {
        let why = "cargo-deny is not installed: `cargo install --locked cargo-deny`";
        println!("SKIPPED: licences, bans and sources of dependencies are not looked at; {why}");
        return Ok(Outcome::Skipped(why));
    }
    outcome_of(&mut cargo(["deny", "check", "licenses", "bans", "sources"]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(only: &[&str], skip: &[&str]) -> anyhow::Result<Vec<&'static str>> {
        let owned = |names: &[&str]| names.iter().map(ToString::to_string).collect();
        let selection = Selection { only: owned(only), skip: owned(skip) };
        Ok(select(&STEPS, &selection)?.iter().map(|step| step.name).collect())
    }

    #[test]
    fn the_selection_keeps_the_running_order() {
        assert_eq!(names(&[], &[]).unwrap().len(), STEPS.len());
        assert_eq!(names(&["docs", "fmt"], &[]).unwrap(), ["fmt", "docs"]);
        assert_eq!(names(&["docs", "fmt"], &["docs"]).unwrap(), ["fmt"]);
        assert!(!names(&[], &["clippy"]).unwrap().contains(&"clippy"));
    }

    #[test]
    fn an_unknown_or_empty_selection_is_an_error() {
        for (only, skip) in [(["fnt"], [].as_slice()), (["fmt"], ["nothing"].as_slice()), (["fmt"], &["fmt"])]
        {
            assert!(names(&only, skip).is_err(), "{only:?} {skip:?}");
        }
        assert!(names(&["fnt"], &[]).unwrap_err().to_string().contains("fmt, shaders"));
    }

    #[test]
    fn the_summary_cannot_be_misread() {
        let line = |outcome| summary_line("deny", outcome, Duration::from_millis(1250));
        assert_eq!(line(Outcome::Passed), "  deny         passed       1.2 s");
        assert_eq!(line(Outcome::Failed), "  deny         FAILED       1.2 s");
        assert_eq!(line(Outcome::Skipped("absent")), "  deny         SKIPPED      1.2 s  (absent)");
    }
}
