//! What `undo` and `redo` share: going back and forth in the history.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use orogeny_engine::{Change, EntryId, Result, Terrain};
use serde::Serialize;

use crate::output::{count, text_of};
use crate::session::Session;

/// What both take.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// How many operations; fewer where the history ends
    #[arg(short, long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    number: u32,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    #[serde(skip)]
    did: &'static str,
    entries: Vec<EntryId>,
    num_pages: u64,
    layers_changed: bool,
    elapsed_s: f64,
}

/// Goes through the history and reports it as what was `did`.
///
/// # Errors
/// When the history cannot be trusted or the file not be written; the terrain is then as it was.
pub fn run(
    arguments: &Arguments,
    session: &Session,
    did: &'static str,
    travel: impl FnOnce(&mut Terrain, u32) -> Result<Vec<Change>>,
) -> anyhow::Result<()> {
    let mut terrain = session.open(&arguments.terrain)?;
    let start = Instant::now();
    let changes = travel(&mut terrain, arguments.number)?;
    let elapsed_s = start.elapsed().as_secs_f64();
    terrain.close()?;
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        did,
        entries: changes.iter().map(|change| change.entry).collect(),
        num_pages: changes.iter().map(|change| change.pages.len() as u64).sum(),
        layers_changed: changes.iter().any(|change| change.layers_changed),
        elapsed_s,
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { terrain, did, entries, num_pages, elapsed_s, .. } = self;
        if entries.is_empty() {
            return writeln!(f, "{terrain}: there is nothing that could be {did}");
        }
        let operations = count(entries.len() as u64, "operation");
        let pages = count(*num_pages, "page");
        writeln!(f, "{terrain}: {did} {operations}, {pages}, in {elapsed_s:.3} s")
    }
}
