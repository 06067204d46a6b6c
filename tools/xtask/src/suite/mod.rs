//! `test`: sets up, builds and runs the whole suite, and says in the last line what came of it.
//!
//! What the tests get from here, in the environment:
//!
//! | variable | meaning |
//! | --- | --- |
//! | `OROGENY_SKIP_LOG` | a file; a test that must skip appends one line, `NAME: REASON`, and returns |
//! | `OROGENY_TEST_LONG` | set to 1 by `--long`: the long tests run too |
//! | `OROGENY_TEST_PYTHON` | a Python with what the service's clients work by; not set where there is none |
//! | `OROGENY_TEST_GODOT` | the user's: a Godot 4; without it one in the path, or its test skips |
//! | `OROGENY_DATA` | the user's: a folder of real terrains; without it their tests skip |
//! | `XDG_RUNTIME_DIR` | a private folder; without one, some drivers complain in every test |
//!
//! A skip is never silent: it is printed, counted, and taken off the passed ones (to the test runner it had passed).

mod totals;

use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

use anyhow::Context as _;

use crate::cargo::{cargo, private_runtime_folder, scratch_folder, status};
use crate::setup::{self, Need};
use totals::Totals;

/// The packages whose unit tests need neither a GPU driver nor another process.
const QUICK_PACKAGES: [&str; 6] =
    ["orogeny_field", "orogeny_reference", "orogeny_shaders", "orogeny_store", "orogeny_formats", "xtask"];

/// Which tests run.
#[derive(Debug, Default, PartialEq)]
pub struct Options {
    /// Only the unit tests of [`QUICK_PACKAGES`].
    pub quick: bool,
    /// The long tests too.
    pub long: bool,
    /// Parts of test names; all tests where empty.
    pub filters: Vec<String>,
}

/// Runs the tests; fails when one fails, one ends without a result, or none ran.
///
/// # Errors
///
/// Something the tests need is missing and cannot be installed, or cargo cannot be started.
pub fn run(options: &Options) -> anyhow::Result<ExitCode> {
    let mut python = None;
    if !options.quick {
        setup::graphics(Need::Required)?;
        setup::test_tools();
        python = setup::python(options.long);
    }
    if std::env::var_os("OROGENY_DATA").is_none() {
        println!(
            "OROGENY_DATA is not set: the tests on real terrains outside this repository will be skipped"
        );
    }
    let scratch = scratch_folder()?;
    let environment = Environment {
        runtime_dir: private_runtime_folder()?,
        skip_log: scratch.join(format!("skips-{}.log", std::process::id())),
        long: options.long,
        python,
    };
    std::fs::write(&environment.skip_log, "")
        .with_context(|| format!("cannot write {}", environment.skip_log.display()))?;

    println!("building the tests");
    let start = Instant::now();
    let built = status(environment.give_to(test_command(options).arg("--no-run")))?.success();
    println!("{} in {:.1} s", if built { "built" } else { "NOT BUILT" }, start.elapsed().as_secs_f64());

    let start = Instant::now();
    let (totals, success) =
        if built { run_built(options, &environment)? } else { (Totals::default(), false) };
    let skips = std::fs::read_to_string(&environment.skip_log).context("the skip log is gone")?;
    std::fs::remove_file(&environment.skip_log).context("cannot remove the skip log")?;

    if built {
        println!("\ntests ran for {:.1} s", start.elapsed().as_secs_f64());
    }
    let report = Report { totals, skips: skips.lines().map(str::to_owned).collect(), success };
    print!("{report}");
    Ok(if report.passed() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn test_command(options: &Options) -> Command {
    // All binaries run even when one fails: the totals speak of the whole suite.
    let mut command = cargo(["test", "--no-fail-fast"]);
    if options.quick {
        command.args(["--lib", "--bins"]);
        for package in QUICK_PACKAGES {
            command.args(["--package", package]);
        }
    } else {
        command.arg("--workspace");
    }
    command
}

/// Runs tests that are built, passing their output on line by line; whether cargo was content comes second.
fn run_built(options: &Options, environment: &Environment) -> anyhow::Result<(Totals, bool)> {
    let mut command = test_command(options);
    environment.give_to(&mut command).arg("--").args(&options.filters).stdout(Stdio::piped());
    let mut child = command.spawn().context("cannot start cargo")?;
    let output = child.stdout.take().context("cargo's output cannot be read")?;
    let totals =
        pass_on(BufReader::new(output), std::io::stdout().lock()).context("cannot pass on the output")?;
    Ok((totals, child.wait()?.success()))
}

fn pass_on(mut from: impl BufRead, mut to: impl Write) -> std::io::Result<Totals> {
    let mut totals = Totals::default();
    let mut line = Vec::new();
    while from.read_until(b'\n', &mut line)? > 0 {
        to.write_all(&line)?;
        to.flush()?;
        totals.read_line(&String::from_utf8_lossy(&line));
        line.clear();
    }
    totals.finish();
    Ok(totals)
}

struct Environment {
    runtime_dir: PathBuf,
    skip_log: PathBuf,
    long: bool,
    python: Option<PathBuf>,
}

impl Environment {
    fn give_to<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command.env("XDG_RUNTIME_DIR", &self.runtime_dir).env("OROGENY_SKIP_LOG", &self.skip_log);
        if self.long {
            command.env("OROGENY_TEST_LONG", "1");
        }
        if let Some(python) = &self.python {
            command.env("OROGENY_TEST_PYTHON", python);
        }
        command
    }
}

/// What is said at the end.
struct Report {
    totals: Totals,
    /// One line for each test that skipped itself.
    skips: Vec<String>,
    /// Whether cargo built and ran everything without complaint.
    success: bool,
}

impl Report {
    fn passed(&self) -> bool {
        self.success && self.num_failed() == 0
    }

    fn num_skipped(&self) -> u64 {
        self.skips.len() as u64 + self.totals.ignored
    }

    fn num_failed(&self) -> u64 {
        let failed = self.totals.failed + self.totals.unfinished;
        // Whatever makes the suite as a whole fail shows in the last line as well.
        if failed == 0 && (!self.success || self.totals.num_ran() == 0) { 1 } else { failed }
    }

    fn num_passed(&self) -> u64 {
        self.totals.passed.saturating_sub(self.skips.len() as u64)
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for skip in &self.skips {
            writeln!(f, "SKIPPED (counted): {skip}")?;
        }
        if self.totals.ignored > 0 {
            writeln!(f, "IGNORED (counted as skipped): {} tests", self.totals.ignored)?;
        }
        if self.totals.filtered_out > 0 {
            writeln!(f, "not asked for: {} tests", self.totals.filtered_out)?;
        }
        if self.totals.unfinished > 0 {
            writeln!(
                f,
                "ENDED WITHOUT A RESULT: {} test binaries, each counted as a failure",
                self.totals.unfinished
            )?;
        }
        if self.totals.num_ran() == 0 {
            writeln!(f, "NO TEST RAN, which counts as a failure")?;
        } else if !self.success && self.totals.failed + self.totals.unfinished == 0 {
            writeln!(f, "CARGO FAILED with every test passed, which counts as a failure")?;
        }
        writeln!(
            f,
            "{} passed, {} failed, {} skipped",
            self.num_passed(),
            self.num_failed(),
            self.num_skipped()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(output: &str, skips: &[&str], success: bool) -> Report {
        let totals = pass_on(output.as_bytes(), Vec::new()).unwrap();
        Report { totals, skips: skips.iter().map(ToString::to_string).collect(), success }
    }

    fn last_line(report: &Report) -> String {
        report.to_string().lines().next_back().unwrap().to_owned()
    }

    const TEN_AND_TWO: &str = "running 10 tests\n\
        test result: ok. 10 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s\n\
        running 3 tests\n\
        test result: ok. 2 passed; 0 failed; 1 ignored; 0 measured; 4 filtered out; finished in 0.01s\n";

    #[test]
    fn the_last_line_holds_the_totals_and_skips_are_no_passes() {
        let report = report(TEN_AND_TWO, &["real_terrain: OROGENY_DATA is not set"], true);
        assert_eq!(last_line(&report), "11 passed, 0 failed, 2 skipped");
        assert!(report.to_string().contains("SKIPPED (counted): real_terrain: OROGENY_DATA is not set\n"));
        assert!(report.to_string().contains("not asked for: 4 tests\n"));
        assert!(report.passed());
    }

    #[test]
    fn a_failure_a_crash_a_bad_build_and_no_tests_all_fail() {
        let failed = "running 2 tests\ntest result: FAILED. 1 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out\n";
        let crashed = format!("{TEN_AND_TWO}running 5 tests\ntest a ... ok\n");
        let nothing =
            "running 0 tests\ntest result: ok. 0 passed; 0 failed; 0 ignored; 0 measured; 9 filtered out\n";
        for (report, expected) in [
            (report(failed, &[], false), "1 passed, 1 failed, 0 skipped"),
            (report(&crashed, &[], false), "12 passed, 1 failed, 1 skipped"),
            (report(&crashed, &[], true), "12 passed, 1 failed, 1 skipped"),
            (report(TEN_AND_TWO, &[], false), "12 passed, 1 failed, 1 skipped"),
            (report(nothing, &[], true), "0 passed, 1 failed, 0 skipped"),
            (report("", &[], false), "0 passed, 1 failed, 0 skipped"),
        ] {
            assert_eq!(last_line(&report), expected);
            assert!(!report.passed(), "{expected}");
        }
    }

    #[test]
    fn output_passes_through_byte_for_byte() {
        let output = b"one\n\xff\xfe not text\nlast line without an end";
        let mut passed = Vec::new();
        pass_on(output.as_slice(), &mut passed).unwrap();
        assert_eq!(passed, output);
    }

    #[test]
    fn the_quick_packages_exist() {
        let root = crate::cargo::workspace_root();
        for package in QUICK_PACKAGES {
            let found = ["crates", "tools"].iter().any(|parent| root.join(parent).join(package).is_dir());
            assert!(found, "{package}");
        }
    }
}
