//! Libraries of Python's beside our own: OpenCV, Pillow, GDAL. `OROGENY_BENCH_PYTHON` names an interpreter that has them, which `cargo xtask
//! bench` makes; without it their rows are left out, which is said.

use std::ffi::{OsStr, OsString};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use crate::report::Report;

/// The interpreter that has them.
pub fn interpreter(report: &mut Report) -> Option<OsString> {
    let python = std::env::var_os("OROGENY_BENCH_PYTHON");
    if python.is_none() {
        report.note("Python's libraries not measured: OROGENY_BENCH_PYTHON is not set".to_owned());
    }
    python
}

/// Runs a program that prints how many seconds each of its measurements took.
pub fn seconds<const N: usize>(python: &OsStr, program: &str, arguments: &[String]) -> Result<[f64; N]> {
    let output = Command::new(python).arg("-c").arg(program).args(arguments).output();
    let output = output.with_context(|| format!("cannot start {}", python.display()))?;
    ensure!(output.status.success(), "Python: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout)?;
    let seconds = text.lines().map(str::parse::<f64>).collect::<Result<Vec<_>, _>>()?;
    seconds.try_into().ok().with_context(|| format!("Python printed {text}"))
}
