//! `jump`: goes to any entry of the history.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use orogeny_engine::{Change, EntryId, HistoryDirection};
use serde::Serialize;

use crate::output::{count, text_of};
use crate::session::Session;

/// What `jump` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// The entry that is to be the last one that shows, as `log` numbers them; 0: before all of them
    entry: u32,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    entry: EntryId,
    undone: Vec<EntryId>,
    redone: Vec<EntryId>,
    elapsed_s: f64,
}

/// Goes there.
///
/// # Errors
/// When there is no such entry, the history cannot be trusted or the file not be written; the terrain is then as it was.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let mut terrain = session.open(&arguments.terrain)?;
    let start = Instant::now();
    let entry = EntryId(arguments.entry);
    let changes = terrain.jump(entry)?;
    let elapsed_s = start.elapsed().as_secs_f64();
    terrain.close()?;
    let in_direction = |direction: HistoryDirection| {
        let is_asked_for = |change: &&Change| change.direction == direction;
        changes.iter().filter(is_asked_for).map(|change| change.entry).collect()
    };
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        entry,
        undone: in_direction(HistoryDirection::Undo),
        redone: in_direction(HistoryDirection::Redo),
        elapsed_s,
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { terrain, entry, undone, redone, elapsed_s } = self;
        let undone = count(undone.len() as u64, "operation");
        let redone = count(redone.len() as u64, "operation");
        writeln!(f, "{terrain}: at entry {entry}; undone {undone}, redone {redone}, in {elapsed_s:.3} s")
    }
}
