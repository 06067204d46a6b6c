//! The power goes: states that a disk may then hold are made from what a process wrote and synced, and opened.

use crate::recording::Recording;
use crate::script::{STEPS, TERRAIN, long_log, run};
use crate::strace_log::Event;
use crate::support::{Seeded, child_path, is_long};

/// States of a disk in the suite, beside the certain ones.
const NUM_SAMPLES: usize = 140;
const NUM_SAMPLES_OF_LONG_LOG: usize = 25;

/// Seeds for each moment of a long run.
const NUM_SEEDS: usize = 4;

/// Where the test of a long log begins to look: more than one step before the log is moved.
const NUM_EVENTS_BEFORE_MOVE: usize = 100;

/// Opens a terrain right behind each acknowledgement, when nothing is left but what is certain.
fn assert_acknowledged_is_certain(recording: &Recording, moments: impl Iterator<Item = usize>) -> usize {
    let mut num_certain = 0;
    for moment in moments.filter(|moment| recording.is_acknowledgement(moment - 1)) {
        let files = recording.disk_after(moment, None).certain();
        recording.assert_whole(&files, moment, "nothing is left that was not synced");
        num_certain += 1;
    }
    num_certain
}

/// Opens a terrain after each of these moments, when chance has decided on what was not synced.
fn assert_whole_whatever_is_lost(recording: &Recording, moments: &[usize]) {
    let mut num_at_stake = 0;
    for (seed, moment) in moments.iter().enumerate() {
        let disk = recording.disk_after(*moment, None);
        num_at_stake += usize::from(disk.num_pending() > 0);
        let files = disk.after_power_loss(&mut Seeded(seed as u64));
        recording.assert_whole(&files, *moment, &format!("seed {seed}"));
    }
    println!(
        "{} states of a disk after a power loss, {num_at_stake} with writes at stake, over {} events",
        moments.len(),
        recording.events.len()
    );
    assert!(num_at_stake > moments.len() / 2, "most of the time nothing was at stake");
}

/// Moments by chance, among the first to the last; all of them, more than once, in a long run.
fn moments(first: usize, last: usize, num_samples: usize) -> Vec<usize> {
    if is_long() {
        return (first..=last).flat_map(|moment| [moment; NUM_SEEDS]).collect();
    }
    let mut random = Seeded(0x0005_eed1);
    (0..num_samples).map(|_| first + random.below((last - first) as u64 + 1) as usize).collect()
}

#[test]
fn a_power_loss_costs_nothing_that_was_acknowledged() {
    if let Some(path) = child_path() {
        return run(&path, &STEPS);
    }
    let test = "power_loss::a_power_loss_costs_nothing_that_was_acknowledged";
    let Some(recording) = Recording::of(test, &STEPS, "a power loss") else { return };
    let num_events = recording.events.len();
    let num_certain = assert_acknowledged_is_certain(&recording, 1..=num_events);
    assert_eq!(num_certain, STEPS.len());
    assert_whole_whatever_is_lost(&recording, &moments(0, num_events, NUM_SAMPLES));
}

#[test]
fn a_power_loss_while_the_log_begins_anew_costs_nothing() {
    let steps = long_log();
    if let Some(path) = child_path() {
        return run(&path, &steps);
    }
    let test = "power_loss::a_power_loss_while_the_log_begins_anew_costs_nothing";
    let Some(recording) = Recording::of(test, &steps, "a power loss while the log begins anew") else {
        return;
    };
    // The log is moved when the terrain itself is first written to; the next commit begins it anew.
    let is_write_to_terrain = |event: &Event| matches!(event, Event::Change { file, .. } if file == TERRAIN);
    let moved = recording.events.iter().position(is_write_to_terrain).unwrap();
    let first = moved.saturating_sub(NUM_EVENTS_BEFORE_MOVE);
    let mut acknowledged =
        (moved..recording.events.len()).filter(|index| recording.is_acknowledgement(*index));
    let last = acknowledged.nth(3).expect("the log is moved only when the terrain is closed") + 1;
    let num_certain = assert_acknowledged_is_certain(&recording, first..=last);
    assert!(num_certain > 3, "{num_certain}");
    assert_whole_whatever_is_lost(&recording, &moments(first, last, NUM_SAMPLES_OF_LONG_LOG));
}
