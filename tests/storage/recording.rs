//! What a real process wrote and synced, step by step, to be played back onto a disk.

use crate::disk::{Disk, Files, lay_out};
use crate::script::{State, Step, TERRAIN, new_terrain, num_steps, reopen, states};
use crate::strace_log::Event;
use crate::trace;

/// What a child did, from the list of its system calls, and the states it went through.
pub struct Recording {
    before: Files,
    pub events: Vec<Event>,
    /// After each number of steps.
    pub states: Vec<State>,
}

impl Recording {
    /// What `test` does as a child that makes these steps; `None` where nothing can be traced.
    pub fn of(test: &str, steps: &[Step], what: &str) -> Option<Self> {
        if !trace::is_possible(what) {
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let (path, field) = new_terrain(folder.path());
        let before = trace::files(folder.path());
        let events = trace::run_undisturbed(test, &path, steps.len()).log.events;
        let recording = Self { before, events, states: states(field, steps) };
        // The list is complete if it leads to the very files that are there.
        let end = recording.disk_after(recording.events.len(), None).undisturbed();
        assert!(end == trace::files(folder.path()), "the files are not what the list of writes leads to");
        Some(recording)
    }

    /// The disk after so many events, one of them left out.
    pub fn disk_after(&self, num_events: usize, left_out: Option<usize>) -> Disk {
        let mut disk = Disk::new(self.before.clone());
        for (index, event) in self.events.iter().enumerate().take(num_events) {
            if Some(index) != left_out {
                disk.take(event);
            }
        }
        disk
    }

    pub fn is_acknowledgement(&self, index: usize) -> bool {
        matches!(self.events.get(index), Some(Event::Acknowledge(_)))
    }

    /// How many steps were acknowledged in so many events.
    pub fn num_acknowledged(&self, num_events: usize) -> usize {
        let lines = self.events.iter().take(num_events).filter_map(|event| match event {
            Event::Acknowledge(line) => Some(line.clone()),
            _ => None,
        });
        num_steps(&lines.collect::<Vec<_>>())
    }

    /// Opens a terrain as a disk may hold it after so many events: whole, at the acknowledged step or the one begun.
    pub fn assert_whole(&self, files: &Files, num_events: usize, case: &str) {
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
