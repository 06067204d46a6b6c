//! The power goes, or one write never reaches the disk: every state that a disk may then hold is tried, from a list of
//! what a real process wrote and synced.

use std::collections::BTreeMap;

use crate::disk::{Disk, Files, lay_out};
use crate::script::{STEPS, State, TERRAIN, new_terrain, num_steps, reopen, run, states};
use crate::strace_log::{Change, Event};
use crate::support::{Seeded, child_path, is_long};
use crate::trace;

/// States of a disk in the suite, beside the certain ones.
const NUM_SAMPLES: usize = 140;

/// Lost writes in the suite.
const NUM_LOST_WRITES: usize = 100;

/// Seeds for each moment of a long run.
const NUM_SEEDS: usize = 4;

/// Whether a log that lost its end is seen, which takes a record of the last commit outside of it.
const IS_LOST_END_OF_LOG_SEEN: bool = false;

/// What a child did, from the list of its system calls, and the states it went through.
struct Recording {
    before: Files,
    events: Vec<Event>,
    states: Vec<State>,
}

impl Recording {
    /// `None` where nothing can be traced.
    fn of(test: &str, what: &str) -> Option<Self> {
        if !trace::is_possible(what) {
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let (path, field) = new_terrain(folder.path());
        let before = trace::files(folder.path());
        let events = trace::run_undisturbed(test, &path).log.events;
        let recording = Self { before, events, states: states(field) };
        // The list is complete if it leads to the very files that are there.
        let end = recording.disk_after(recording.events.len(), None).undisturbed();
        assert!(end == trace::files(folder.path()), "the files are not what the list of writes leads to");
        Some(recording)
    }

    /// The disk after so many events, one of them left out.
    fn disk_after(&self, num_events: usize, left_out: Option<usize>) -> Disk {
        let mut disk = Disk::new(self.before.clone());
        for (index, event) in self.events.iter().enumerate().take(num_events) {
            if Some(index) != left_out {
                disk.take(event);
            }
        }
        disk
    }

    /// How many steps were acknowledged in so many events.
    fn num_acknowledged(&self, num_events: usize) -> usize {
        let lines = self.events.iter().take(num_events).filter_map(|event| match event {
            Event::Acknowledge(line) => Some(line.clone()),
            _ => None,
        });
        num_steps(&lines.collect::<Vec<_>>())
    }

    /// Opens a terrain as a disk may hold it after so many events: whole, at the acknowledged step or the one begun.
    fn assert_whole(&self, files: &Files, num_events: usize, case: &str) {
        let num_acknowledged = self.num_acknowledged(num_events);
        let folder = lay_out(files);
        let state = reopen(&folder.path().join(TERRAIN)).unwrap_or_else(|problem| {
            panic!("power lost after {num_events} events, {num_acknowledged} steps, {case}: {problem}")
        });
        let mut possible = self.states.iter().skip(num_acknowledged).take(2);
        if !possible.any(|possible| *possible == state) {
            let found = self.states.iter().position(|other| *other == state);
            panic!(
                "power lost after {num_events} events, {case}: {num_acknowledged} steps were acknowledged, the \
                 terrain is as after {found:?}"
            );
        }
    }
}

#[test]
fn a_power_loss_costs_nothing_that_was_acknowledged() {
    if let Some(path) = child_path() {
        return run(&path);
    }
    let test = "power_loss::a_power_loss_costs_nothing_that_was_acknowledged";
    let Some(recording) = Recording::of(test, "a power loss") else { return };
    let num_events = recording.events.len();
    let at_stake = |moment: &usize| recording.disk_after(*moment, None).num_pending() > 0;

    // Right behind an acknowledgement, with nothing but what is certain.
    let mut num_certain = 0;
    for moment in 1..=num_events {
        if matches!(recording.events[moment - 1], Event::Acknowledge(_)) {
            let files = recording.disk_after(moment, None).certain();
            recording.assert_whole(&files, moment, "nothing is left that was not synced");
            num_certain += 1;
        }
    }
    assert_eq!(num_certain, STEPS.len());

    let mut random = Seeded(0x0005_eed1);
    let moments: Vec<usize> = if is_long() {
        (0..=num_events).flat_map(|moment| [moment; NUM_SEEDS]).collect()
    } else {
        (0..NUM_SAMPLES).map(|_| random.below(num_events as u64 + 1) as usize).collect()
    };
    let mut num_at_stake = 0;
    for (seed, moment) in moments.iter().enumerate() {
        let disk = recording.disk_after(*moment, None);
        num_at_stake += usize::from(disk.num_pending() > 0);
        let files = disk.after_power_loss(&mut Seeded(seed as u64));
        recording.assert_whole(&files, *moment, &format!("seed {seed}"));
    }
    println!(
        "{num_certain} certain and {} sampled states of a disk, {num_at_stake} with writes at stake, of {} moments \
         in {num_events} events",
        moments.len(),
        (0..=num_events).filter(at_stake).count(),
    );
    assert!(num_at_stake > moments.len() / 2, "most of the time nothing was at stake");
}

/// How a terrain took the loss of a write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    /// It is as if the write had not been lost.
    Harmless,
    /// Damage is named.
    Seen,
    /// It is whole and as it was after an earlier step: acknowledged ones are gone.
    EndIsGone,
    /// It is in no state in which it ever was.
    Wrong,
}

/// What becomes of a terrain after so many events when one write did not happen.
fn verdict(recording: &Recording, files: &Files, num_events: usize) -> Verdict {
    let folder = lay_out(files);
    let Ok(state) = reopen(&folder.path().join(TERRAIN)) else { return Verdict::Seen };
    let num_acknowledged = recording.num_acknowledged(num_events);
    let is_in = |states: &[State]| states.contains(&state);
    if is_in(&recording.states[num_acknowledged..=num_acknowledged]) {
        Verdict::Harmless
    } else if is_in(&recording.states[..num_acknowledged]) {
        Verdict::EndIsGone
    } else {
        Verdict::Wrong
    }
}

/// Never wrong heights in silence.
fn is_seen_or_harmless(verdict: Verdict, file: &str) -> bool {
    match verdict {
        Verdict::Harmless | Verdict::Seen => true,
        Verdict::EndIsGone => !IS_LOST_END_OF_LOG_SEEN && file.ends_with("-wal"),
        Verdict::Wrong => false,
    }
}

#[test]
fn a_lost_write_is_seen_or_harmless() {
    if let Some(path) = child_path() {
        return run(&path);
    }
    let test = "power_loss::a_lost_write_is_seen_or_harmless";
    let Some(recording) = Recording::of(test, "a lost write") else { return };
    let is_acknowledgement = |event: &Event| matches!(event, Event::Acknowledge(_));
    let last_work = recording.events.iter().rposition(is_acknowledgement).unwrap();
    let before_last_close = recording.events[..last_work].iter().rposition(is_acknowledgement).unwrap() + 1;
    let mut cases = Vec::new();
    for (index, event) in recording.events.iter().enumerate() {
        let Event::Change { file, change: Change::Write { .. } } = event else { continue };
        // The process ends when it is next told that all is safe, before it closes the terrain, or behind everything.
        let next = recording.events[index..].iter().position(is_acknowledgement);
        let mut moments = vec![next.map_or(recording.events.len(), |next| index + next + 1)];
        moments.extend([before_last_close, recording.events.len()]);
        moments.retain(|moment| *moment > index);
        moments.dedup();
        cases.extend(moments.into_iter().map(|moment| (index, file, moment)));
    }
    // One that was overwritten or removed since is no loss.
    let mut random = Seeded(0x0005_eed2);
    let mut verdicts: BTreeMap<Verdict, usize> = BTreeMap::new();
    let mut wrong = Vec::new();
    let num_wanted = if is_long() { cases.len() } else { NUM_LOST_WRITES.min(cases.len()) };
    let (mut num_lost, mut num_without_effect) = (0, 0);
    while num_lost < num_wanted && !cases.is_empty() {
        let (index, file, moment) = cases.swap_remove(random.below(cases.len() as u64) as usize);
        let files = recording.disk_after(moment, Some(index)).undisturbed();
        if files == recording.disk_after(moment, None).undisturbed() {
            num_without_effect += 1;
            continue;
        }
        num_lost += 1;
        let verdict = verdict(&recording, &files, moment);
        *verdicts.entry(verdict).or_default() += 1;
        if !is_seen_or_harmless(verdict, file) {
            wrong.push(format!("event {index}, a write to {file}, seen after {moment} events: {verdict:?}"));
        }
    }
    println!("{num_lost} lost writes: {verdicts:?}; {num_without_effect} more had no effect");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(num_lost >= NUM_LOST_WRITES.min(num_wanted), "only {num_lost} writes were lost");
    assert!(verdicts.contains_key(&Verdict::Seen), "no loss was seen");
}
