//! Kills, failing syncs and full disks at single system calls of a run, by strace.

use std::collections::BTreeMap;
use std::os::unix::process::ExitStatusExt as _;

use orogeny_field::FieldId;

use crate::script::{Model, STEPS, State, Step, new_terrain, num_steps, reopen, run};
use crate::support::{Seeded, child_path, is_long};
use crate::trace::{self, Traced};

/// Faults of each kind in the suite.
const NUM_KILLS: usize = 30;
const NUM_SYNC_ERRORS: usize = 20;
const NUM_FULL_DISKS: usize = 15;

/// One fault: the call, the number of the first that it hits, and whether it hits all from there on.
type Place = (&'static str, usize, bool);

/// One run with a fault in it, and the terrain after it.
struct Case {
    name: String,
    field: FieldId,
    traced: Traced,
    state: State,
}

impl Case {
    /// Runs `test` as a child with a fault, and opens what it leaves, which has to be whole.
    fn new(test: &str, fault: &str, (call, number, is_lasting): Place) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (path, field) = new_terrain(folder.path());
        let plus = if is_lasting { "+" } else { "" };
        let fault = format!("inject={call}:{fault}:when={number}{plus}");
        let traced = trace::run(test, &path, Some(&fault));
        let state = reopen(&path).unwrap_or_else(|problem| panic!("{fault}, {:?}: {problem}", traced.lines));
        Self { name: fault, field, traced, state }
    }

    fn num_acknowledged(&self) -> usize {
        num_steps(&self.traced.lines)
    }

    /// The step that failed and the kind of the error.
    fn error(&self) -> Option<(usize, &str)> {
        let error = self.traced.lines.iter().find_map(|line| line.strip_prefix("error "))?;
        let (step, kind) = error.split_once(' ').unwrap();
        Some((step.parse().unwrap(), kind))
    }

    /// What became of the commit that was tried behind an error.
    fn further(&self) -> Option<&str> {
        self.traced.lines.iter().find_map(|line| line.strip_prefix("further "))
    }

    /// Whether the terrain is as after so many steps, or so many and the further commit.
    fn is_after(&self, num_steps: usize, further: &[bool]) -> bool {
        let Some(steps) = STEPS.get(..num_steps) else { return false };
        further.iter().any(|is_further| {
            let mut model = Model::after(steps);
            if *is_further {
                model.take(Step::Paint);
            }
            model.state(self.field) == self.state
        })
    }

    /// The child ends by itself, with an error in the step behind the last that it acknowledged.
    fn assert_refused(&self) -> &str {
        let lines = &self.traced.lines;
        let errors = String::from_utf8_lossy(&self.traced.output.stderr);
        assert!(self.traced.output.status.success(), "{}, {lines:?}: {errors}", self.name);
        let (step, kind) = self.error().unwrap_or_else(|| panic!("{}: no error in {lines:?}", self.name));
        assert_eq!(step, self.num_acknowledged() + 1, "{}: {lines:?}", self.name);
        assert!(self.further().is_some(), "{}: {lines:?}", self.name);
        kind
    }
}

/// How often a run without a fault makes each of these calls; those that it does not make are left out.
fn num_calls(test: &str, calls: &[&'static str]) -> Vec<(&'static str, usize)> {
    let folder = tempfile::tempdir().unwrap();
    let traced = trace::run_undisturbed(test, &new_terrain(folder.path()).0, STEPS.len());
    assert!(traced.log.failed.iter().all(|(call, _)| call == "openat"), "{:?}", traced.log.failed);
    let count = |call: &&'static str| Some((*call, *traced.log.num_calls.get(*call)?));
    calls.iter().filter_map(count).collect()
}

/// All places of a fault, or a sample of them that has some of each call.
fn places(counts: &[(&'static str, usize)], lasting: &[bool], num_samples: usize) -> Vec<Place> {
    let of_call = |(call, count): &(&'static str, usize)| -> Vec<Place> {
        (1..=*count).flat_map(|number| lasting.iter().map(move |l| (*call, number, *l))).collect()
    };
    let mut calls: Vec<Vec<Place>> = counts.iter().map(of_call).collect();
    if is_long() {
        return calls.concat();
    }
    let mut random = Seeded(0x0005_eed3);
    let mut sample = Vec::new();
    while sample.len() < num_samples && calls.iter().any(|places| !places.is_empty()) {
        for places in calls.iter_mut().filter(|places| !places.is_empty()) {
            sample.push(places.swap_remove(random.below(places.len() as u64) as usize));
        }
    }
    sample
}

#[test]
fn a_kill_at_any_call_leaves_the_old_or_the_new_state() {
    if let Some(path) = child_path() {
        return run(&path, &STEPS);
    }
    let test = "inject::a_kill_at_any_call_leaves_the_old_or_the_new_state";
    if !trace::is_possible("a kill at a system call") {
        return;
    }
    let counts = num_calls(test, &["pwrite64", "write", "ftruncate", "fsync", "fdatasync", "unlink"]);
    let places = places(&counts, &[false], NUM_KILLS);
    let mut num_fired = 0;
    let mut kept = BTreeMap::new();
    for place in &places {
        let case = Case::new(test, "signal=KILL", *place);
        let status = case.traced.output.status;
        num_fired += usize::from(status.signal() == Some(9) || status.code() == Some(128 + 9));
        let num_acknowledged = case.num_acknowledged();
        let is_old = case.is_after(num_acknowledged, &[false]);
        let is_new = case.is_after(num_acknowledged + 1, &[false]);
        assert!(is_old || is_new, "{}: {num_acknowledged} steps were acknowledged", case.name);
        *kept.entry(if is_old { "old" } else { "new" }).or_insert(0) += 1;
    }
    println!("{num_fired} kills of {} at calls among {counts:?}; states kept: {kept:?}", places.len());
    assert_eq!(num_fired, places.len());
}

#[test]
fn a_sync_that_fails_is_an_error_and_no_acknowledgement() {
    if let Some(path) = child_path() {
        return run(&path, &STEPS);
    }
    let test = "inject::a_sync_that_fails_is_an_error_and_no_acknowledgement";
    if !trace::is_possible("a failing sync") {
        return;
    }
    let counts = num_calls(test, &["fsync", "fdatasync"]);
    let places = places(&counts, &[false, true], NUM_SYNC_ERRORS);
    let (mut num_fired, mut num_on_the_folder) = (0, 0);
    let mut further = BTreeMap::new();
    for place in &places {
        let case = Case::new(test, "error=EIO", *place);
        let failed: Vec<_> =
            case.traced.log.failed.iter().filter(|(call, _)| call.ends_with("sync")).collect();
        num_fired += usize::from(!failed.is_empty());
        // SQLite goes on when it is the folder that could not be synced.
        if case.error().is_none() && failed.iter().all(|(_, file)| file.is_empty()) {
            num_on_the_folder += 1;
            assert!(case.is_after(STEPS.len(), &[false]), "{}", case.name);
            continue;
        }
        let kind = case.assert_refused();
        // The second where it was the record of the commit that could not be synced.
        assert!(["Io", "DiskFailed"].contains(&kind), "{}: {kind}", case.name);
        let result = case.further().unwrap();
        assert_ne!(result, "committed", "{}: {:?}", case.name, case.traced.lines);
        *further.entry(result.to_owned()).or_insert(0) += 1;
        let num_acknowledged = case.num_acknowledged();
        let possible: &[bool] = if result.starts_with("committed") { &[true] } else { &[false, true] };
        assert!(
            case.is_after(num_acknowledged, possible) || case.is_after(num_acknowledged + 1, possible),
            "{}: {:?}",
            case.name,
            case.traced.lines
        );
    }
    println!(
        "{num_fired} failing syncs of {} among {counts:?}, {num_on_the_folder} of the folder alone; further commits: \
         {further:?}",
        places.len()
    );
    assert_eq!(num_fired, places.len());
    assert!(num_on_the_folder < places.len() / 2);
}

#[test]
fn a_disk_that_fills_up_at_any_write_costs_nothing() {
    if let Some(path) = child_path() {
        return run(&path, &STEPS);
    }
    let test = "inject::a_disk_that_fills_up_at_any_write_costs_nothing";
    if !trace::is_possible("a disk that fills up at one write") {
        return;
    }
    let counts = num_calls(test, &["pwrite64"]);
    let places = places(&counts, &[true], NUM_FULL_DISKS);
    let mut num_fired = 0;
    for place in &places {
        let case = Case::new(test, "error=ENOSPC", *place);
        num_fired += usize::from(case.traced.log.failed.iter().any(|(call, _)| call == "pwrite64"));
        assert_eq!(case.assert_refused(), "DiskFull", "{}", case.name);
        assert_eq!(case.further(), Some("refused DiskFull"), "{}", case.name);
        let num_acknowledged = case.num_acknowledged();
        assert!(case.is_after(num_acknowledged, &[false]), "{}: {:?}", case.name, case.traced.lines);
    }
    println!("{num_fired} full disks of {} at writes among {counts:?}", places.len());
    assert_eq!(num_fired, places.len());
}
