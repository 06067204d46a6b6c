//! `run`, `demo` and `bench`: a release build, then the program itself; `golden` and `pictures`: pictures drawn anew.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use anyhow::ensure;

use crate::cargo::{cargo, private_runtime_folder, status, workspace_root};
use crate::setup::{self, Need};

/// Builds the release binary and runs `orogeny ARGS` in the user's current folder; the exit code is the program's.
///
/// # Errors
///
/// Cargo cannot be started.
pub fn run(program_args: &[OsString]) -> anyhow::Result<ExitCode> {
    run_release("orogeny", program_args)
}

/// Builds the release binary, says how long that took, and runs the demo into `folder`.
///
/// # Errors
///
/// The build fails, or cargo cannot be started.
pub fn demo(folder: Option<PathBuf>) -> anyhow::Result<ExitCode> {
    setup::graphics(Need::Optional)?;
    println!("building Orogeny (the first time takes a few minutes)");
    let start = Instant::now();
    let built = status(&mut cargo(["build", "--release", "--package", "orogeny", "--bin", "orogeny"]))?;
    ensure!(built.success(), "the build failed: the compiler's messages are above");
    println!("built in {:.1} s\n", start.elapsed().as_secs_f64());

    let folder = folder.unwrap_or_else(|| default_demo_folder(std::env::current_dir().ok().as_deref()));
    run_release("orogeny", &["demo".into(), folder.into()])
}

/// Builds and runs the benchmark suite with these arguments, beside libraries in a Python of xtask's own unless `OROGENY_BENCH_PYTHON`
/// names another.
///
/// # Errors
///
/// Cargo cannot be started.
pub fn bench(bench_args: &[OsString]) -> anyhow::Result<ExitCode> {
    const PYTHON: &str = "OROGENY_BENCH_PYTHON";
    let is_measured = !bench_args.iter().any(|arg| arg == "--document");
    let python = if is_measured && std::env::var_os(PYTHON).is_none() { setup::bench_python() } else { None };
    run_release_with("benchsuite", bench_args, python.map(|python| (PYTHON, python)))
}

/// Draws the golden pictures anew, in the place of those in `tests/golden/pictures`.
///
/// # Errors
///
/// Cargo cannot be started.
pub fn golden() -> anyhow::Result<ExitCode> {
    drawn_by_tests("pictures", "golden", "OROGENY_GOLDEN")
}

/// Draws the pictures of the guide to the editor anew, in the place of those in `docs/images`.
///
/// # Errors
///
/// Cargo cannot be started.
pub fn pictures() -> anyhow::Result<ExitCode> {
    drawn_by_tests("editor", "every_picture_is_in_the_guide", "OROGENY_PICTURES")
}

/// Runs the tests that draw pictures where a variable says so. Of the workspace, so that what its tests were built with serves here too.
fn drawn_by_tests(target: &str, filter: &str, variable: &str) -> anyhow::Result<ExitCode> {
    setup::graphics(Need::Required)?;
    let mut command = cargo(["test", "--quiet", "--workspace", "--test", target, filter]);
    command.env(variable, "write");
    give_runtime_folder(&mut command)?;
    let drawn = status(&mut command)?;
    Ok(if drawn.success() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Gives a command the folder that graphics drivers ask for, where the user has none.
fn give_runtime_folder(command: &mut Command) -> anyhow::Result<()> {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        command.env("XDG_RUNTIME_DIR", private_runtime_folder()?);
    }
    Ok(())
}

fn run_release(package: &str, args: &[OsString]) -> anyhow::Result<ExitCode> {
    run_release_with(package, args, None)
}

fn run_release_with(
    package: &str,
    args: &[OsString],
    variable: Option<(&str, PathBuf)>,
) -> anyhow::Result<ExitCode> {
    let mut command = cargo(["run", "--quiet", "--release", "--manifest-path"]);
    command.arg(workspace_root().join("Cargo.toml")).args(["--package", package, "--"]).args(args);
    command.envs(variable);
    give_runtime_folder(&mut command)?;
    if let Ok(folder) = std::env::current_dir() {
        command.current_dir(folder); // paths in the arguments are the user's
    }
    let code = status(&mut command)?.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

/// `out/demo` of the workspace, which git ignores; shortened where the user stands in the workspace's root.
fn default_demo_folder(current: Option<&Path>) -> PathBuf {
    let root = workspace_root();
    let relative = PathBuf::from("out").join("demo");
    if current == Some(root.as_path()) { relative } else { root.join(relative) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_demo_goes_to_the_workspace_wherever_the_user_stands() {
        let root = workspace_root();
        assert_eq!(default_demo_folder(Some(&root)), Path::new("out/demo"));
        assert_eq!(default_demo_folder(Some(&root.join("crates"))), root.join("out/demo"));
        assert_eq!(default_demo_folder(None), root.join("out/demo"));
    }
}
