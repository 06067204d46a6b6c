//! One write never reaches the disk, although it was synced: that is seen, or it does no harm.
//!
//! The process is taken not to notice: it goes on by what the system remembers of the write. The terrain is opened when
//! that is forgotten.

use std::collections::BTreeMap;

use crate::disk::{Files, lay_out};
use crate::recording::Recording;
use crate::script::{STEPS, State, TERRAIN, reopen, run};
use crate::strace_log::{Change, Event};
use crate::support::{Seeded, child_path, is_long};

/// Lost writes in the suite.
const NUM_LOST_WRITES: usize = 100;

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

/// Never wrong heights in silence, and never the loss of what was acknowledged.
const fn is_seen_or_harmless(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Harmless | Verdict::Seen)
}

/// Every write, by its place among the events, its file, and a number of events after which the terrain is opened.
fn cases(recording: &Recording) -> Vec<(usize, &str, usize)> {
    let num_events = recording.events.len();
    let mut acknowledgements = (0..num_events).filter(|index| recording.is_acknowledgement(*index)).rev();
    let before_last_close = acknowledgements.nth(1).unwrap() + 1;
    let mut cases = Vec::new();
    for (index, event) in recording.events.iter().enumerate() {
        let Event::Change { file, change: Change::Write { .. } } = event else { continue };
        // The process ends when it is next told that all is safe, before it closes the terrain, or behind everything.
        let next =
            (index..num_events).find(|index| recording.is_acknowledgement(*index)).unwrap_or(num_events - 1);
        let mut moments = vec![next + 1, before_last_close, num_events];
        moments.retain(|moment| *moment > index);
        moments.dedup();
        cases.extend(moments.into_iter().map(|moment| (index, file.as_str(), moment)));
    }
    cases
}

#[test]
fn a_lost_write_is_seen_or_harmless() {
    if let Some(path) = child_path() {
        return run(&path, &STEPS);
    }
    let test = "lost_write::a_lost_write_is_seen_or_harmless";
    let Some(recording) = Recording::of(test, &STEPS, "a lost write") else { return };
    let mut cases = cases(&recording);
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
        if !is_seen_or_harmless(verdict) {
            wrong.push(format!("event {index}, a write to {file}, seen after {moment} events: {verdict:?}"));
        }
    }
    println!("{num_lost} lost writes: {verdicts:?}; {num_without_effect} more had no effect");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(num_lost >= NUM_LOST_WRITES.min(num_wanted), "only {num_lost} writes were lost");
    assert!(verdicts.contains_key(&Verdict::Seen), "no loss was seen");
}
