//! `instructions`: how many instructions each CPU kernel takes, beside the counts that are kept.
//!
//! Times vary by a fifth on a shared machine; these counts do not vary at all, so they show a kernel that became a little slower
//! on the machine that looks at every change. They depend on the compiler: a new one is a reason to keep new counts.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::{Command, ExitCode, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context as _, ensure};

use crate::cargo::{cargo, scratch_folder, status, workspace_root};
use crate::setup;

/// By how much a count may differ from the kept one.
const TOLERANCE: f64 = 0.03;

/// Counts by kernel.
type Counts = BTreeMap<String, u64>;

/// What came of counting.
#[derive(Debug, PartialEq)]
pub enum Outcome {
    /// All counts are what they were.
    Same,
    /// Some are not: they are printed.
    Different,
    /// Nothing was counted, and why.
    NotCounted(&'static str),
}

/// Counts, prints and compares; with `is_kept` keeps the counts instead.
///
/// # Errors
///
/// The kernels cannot be built or run, or there are no kept counts to compare with.
pub fn run(is_kept: bool) -> anyhow::Result<ExitCode> {
    if is_kept {
        let Some(counts) = count()? else { return Ok(ExitCode::FAILURE) };
        let path = kept_path();
        let text = serde_json::to_string_pretty(&counts)? + "\n";
        std::fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
        println!("{} counts kept in {}", counts.len(), path.display());
        return Ok(ExitCode::SUCCESS);
    }
    Ok(if compare()? == Outcome::Same { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Counts, prints each count beside the kept one, and says whether all are within 3 %.
///
/// # Errors
///
/// As [`run`].
pub fn compare() -> anyhow::Result<Outcome> {
    let path = kept_path();
    let text = std::fs::read_to_string(&path).with_context(|| {
        format!("cannot read {}: `cargo xtask instructions --keep` makes it", path.display())
    })?;
    let kept: Counts =
        serde_json::from_str(&text).with_context(|| format!("{} is broken", path.display()))?;
    let Some(counts) = count()? else { return Ok(Outcome::NotCounted("valgrind cannot be installed")) };
    let differences = differences(&kept, &counts);
    for (kernel, count) in &counts {
        let before = kept
            .get(kernel)
            .map_or_else(|| "new".to_owned(), |before| format!("{:+.2} %", change(*before, *count) * 100.0));
        println!("{kernel:<26} {count:>12} {before:>10}");
    }
    for difference in &differences {
        println!("DIFFERENT: {difference}");
    }
    if !differences.is_empty() {
        println!("if that is meant, `cargo xtask instructions --keep` keeps the new counts");
    }
    Ok(if differences.is_empty() { Outcome::Same } else { Outcome::Different })
}

/// What is beyond the tolerance, new or gone, in words.
fn differences(kept: &Counts, counts: &Counts) -> Vec<String> {
    let changed = counts.iter().filter_map(|(kernel, count)| match kept.get(kernel) {
        None => Some(format!("{kernel} has no kept count")),
        Some(before) if change(*before, *count).abs() > TOLERANCE => {
            Some(format!("{kernel}: {count} instructions, kept were {before}"))
        }
        Some(_) => None,
    });
    let gone = kept.keys().filter(|kernel| !counts.contains_key(*kernel));
    changed.chain(gone.map(|kernel| format!("{kernel} is kept and was not counted"))).collect()
}

fn change(before: u64, now: u64) -> f64 {
    now as f64 / before.max(1) as f64 - 1.0
}

fn kept_path() -> PathBuf {
    workspace_root().join("tools/instructions/counts.json")
}

/// `None` where there is nothing to count by: that is told.
fn count() -> anyhow::Result<Option<Counts>> {
    if !setup::valgrind() {
        return Ok(None);
    }
    let built = status(&mut cargo(["build", "--release", "--package", "instructions"]))?;
    ensure!(built.success(), "the kernels cannot be built");
    let target = scratch_folder()?;
    let program = target.with_file_name("release").join("instructions");
    let listed =
        Command::new(&program).output().with_context(|| format!("cannot start {}", program.display()))?;
    let names: Vec<_> = std::str::from_utf8(&listed.stdout)?.lines().map(str::to_owned).collect();
    ensure!(!names.is_empty(), "there are no kernels to count");
    let (next, counts) = (AtomicUsize::new(0), Mutex::new(Counts::new()));
    let work = || -> anyhow::Result<()> {
        while let Some(name) = names.get(next.fetch_add(1, Ordering::Relaxed)) {
            let count = count_one(&program, name).with_context(|| format!("kernel `{name}`"))?;
            counts.lock().map_err(|_| anyhow::anyhow!("another kernel failed"))?.insert(name.clone(), count);
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .try_for_each(|worker| worker.join().map_err(|_| anyhow::anyhow!("a thread failed"))?)
    })?;
    counts.into_inner().map(Some).map_err(|_| anyhow::anyhow!("a thread failed"))
}

fn count_one(program: &std::path::Path, name: &str) -> anyhow::Result<u64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=*measured*"])
        .arg(program)
        .arg(name)
        .stdin(Stdio::null())
        .output()
        .context("cannot start valgrind")?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{said}");
    collected(&said).with_context(|| format!("valgrind counted nothing: {said}"))
}

/// The count in `==PID== Collected : COUNT`.
fn collected(said: &str) -> Option<u64> {
    let line = said.lines().find_map(|line| line.split_once("Collected :"))?;
    line.1.trim().parse().ok().filter(|count| *count > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(pairs: &[(&str, u64)]) -> Counts {
        pairs.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect()
    }

    #[test]
    fn a_difference_beyond_the_tolerance_is_seen_both_ways_and_so_is_what_is_new_or_gone() {
        let kept = counts(&[("a", 1000), ("b", 1000), ("c", 1000), ("d", 1000)]);
        assert!(differences(&kept, &counts(&[("a", 1029), ("b", 971), ("c", 1000), ("d", 1000)])).is_empty());
        let found = differences(&kept, &counts(&[("a", 1031), ("b", 969), ("c", 1000), ("e", 5)]));
        assert_eq!(
            found,
            [
                "a: 1031 instructions, kept were 1000",
                "b: 969 instructions, kept were 1000",
                "e has no kept count",
                "d is kept and was not counted",
            ]
        );
    }

    #[test]
    fn the_count_is_found_and_nothing_is_none() {
        assert_eq!(collected("==7== Events    : Ir\n==7== Collected : 4211\n==7==\n"), Some(4211));
        assert_eq!(collected("==7== Collected : 0\n"), None);
        assert_eq!(collected("valgrind: no such program"), None);
    }
}
