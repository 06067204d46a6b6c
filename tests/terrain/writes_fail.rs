//! Disks that fill up or fail while a terrain is painted, from one system call on, by strace: an error, and no
//! acknowledgement of what is not there.

use std::path::Path;
use std::process::Command;

use orogeny_engine::Terrain;
use orogeny_tests::child::{as_child, child_arguments, child_path, is_long, whole_lines};
use orogeny_tests::{Random, skip};

use crate::painter::{Painter, assert_kept};
use crate::support::create;

const TEST: &str =
    "writes_fail::a_disk_that_fails_under_a_painter_is_an_error_and_costs_nothing_acknowledged";

/// Steps of a run after which something is wrong with the test.
const MAX_STEPS: usize = 10_000;

/// What fails, how, and from which of the calls of a thread at the latest. strace counts the calls of each thread for itself;
/// all commits come from one.
const FAULTS: [(&str, &str, f64); 4] = [
    ("pwrite64", "ENOSPC", 1200.0),
    ("fdatasync", "EIO", 40.0),
    ("pwrite64", "EIO", 1200.0),
    ("fdatasync", "ENOSPC", 40.0),
];

/// Paints until something fails, then once more.
fn paint_until_it_fails(path: &Path) {
    let mut painter = match Painter::open(path) {
        Ok(painter) => painter,
        Err(err) => return println!("error {err}"),
    };
    let failed = (0..MAX_STEPS).find_map(|_| painter.step().err());
    println!("error {}", failed.expect("nothing failed"));
    // All that follows on an error is refused, or is there as any other.
    let further = painter.look_again().and_then(|()| painter.step()).and_then(|()| painter.flush());
    println!("further {}", further.map_or_else(|err| err.to_string(), |()| "done".to_owned()));
}

/// Whether processes can be traced here, and faults injected.
fn is_traceable() -> bool {
    let mut command = Command::new("strace");
    let output = command
        .args(["-f", "-q", "-o", "/dev/null", "-e", "trace=fdatasync"])
        .args(["-e", "inject=fdatasync:error=EIO:when=1+", "true"])
        .output();
    let reason = match output {
        Ok(output) if output.status.success() => return true,
        Ok(output) => String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        Err(err) => format!("strace: {err}"),
    };
    skip(TEST, &format!("no process can be traced ({reason})"));
    false
}

#[test]
fn a_disk_that_fails_under_a_painter_is_an_error_and_costs_nothing_acknowledged() {
    if let Some(path) = child_path() {
        return paint_until_it_fails(&path);
    }
    if !is_traceable() {
        return;
    }
    let num_cases = if is_long() { 8 } else { 4 };
    let mut random = Random::new(0x05ee_d003);
    let (mut num_fired, mut num_acknowledged, mut num_replayed, mut num_done_further) = (0, 0, 0, 0);
    for case in 0..num_cases {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.orogeny");
        create(&path).close().unwrap();
        let (call, error, latest) = FAULTS[case % FAULTS.len()];
        // Syncs also fail once and never again, which is the harder case.
        let is_once = call == "fdatasync" && random.bits().is_multiple_of(2);
        let number = random.within(3.0, latest) as u32;
        let fault = format!("inject={call}:error={error}:when={number}{}", if is_once { "" } else { "+" });
        let log = folder.path().join("strace");
        let mut command = Command::new("strace");
        command.args(["-f", "-q", "-o"]).arg(&log).args(["-e", &format!("trace={call}"), "-e", &fault]);
        command.arg(std::env::current_exe().unwrap()).args(child_arguments(TEST));
        let output = as_child(&mut command, &path).output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        let lines = whole_lines(&output.stdout);
        assert!(output.status.success(), "{fault}: {errors}, {lines:?}");
        num_fired += usize::from(std::fs::read_to_string(&log).unwrap().contains("(INJECTED)"));
        let error = lines.iter().find(|line| line.starts_with("error "));
        let error = error.unwrap_or_else(|| panic!("{fault}: no error in {lines:?}"));
        num_done_further += usize::from(lines.iter().any(|line| line == "further done"));
        num_acknowledged += lines.iter().filter(|line| line.starts_with("ack ")).count().saturating_sub(1);
        println!("{fault}: {error}");
        num_replayed += assert_kept(&path, &lines);
        // It can be painted on again.
        let mut terrain = Terrain::open(&path, crate::support::settings()).unwrap();
        crate::support::apply(&mut terrain, &[crate::support::stroke(1)]);
    }
    println!(
        "{num_fired} disks of {num_cases} failed, {num_acknowledged} actions acknowledged before, {num_replayed} operations \
         replayed, {num_done_further} further strokes done"
    );
    assert_eq!(num_fired, num_cases);
    assert!(num_acknowledged > num_cases);
}
