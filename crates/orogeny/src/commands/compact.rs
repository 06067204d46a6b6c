//! `compact`: gives space back, and limits what the history takes.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use indicatif::HumanBytes;
use orogeny_engine::Dropped;
use serde::Serialize;

use crate::output::{dropped_line, text_of, write_notices};
use crate::session::Session;
use crate::values::{self, HistoryBudget};

/// What `compact` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// Drop what was undone and left behind by later operations
    #[arg(long)]
    drop_branches: bool,
    /// What the history may take in the file from now on, such as 500MiB or 20GiB: the oldest operations over it can no
    /// longer be undone; `none`: no limit
    #[arg(long, value_name = "SIZE", value_parser = values::history_budget)]
    history_budget: Option<HistoryBudget>,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    before_in_bytes: u64,
    after_in_bytes: u64,
    dropped_branches: Dropped,
    dropped: Dropped,
    elapsed_s: f64,
}

/// Compacts the terrain.
///
/// # Errors
/// When the file cannot be rewritten; nothing is lost then.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let mut terrain = session.open(&arguments.terrain)?;
    let dropped_branches = match arguments.drop_branches {
        true => terrain.drop_branches()?,
        false => Dropped::default(),
    };
    let dropped = match arguments.history_budget {
        Some(HistoryBudget(budget_in_bytes)) => terrain.set_history_budget(budget_in_bytes)?,
        None => Dropped::default(),
    };
    let (before_in_bytes, after_in_bytes) = terrain.compact()?;
    terrain.close()?;
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        before_in_bytes,
        after_in_bytes,
        dropped_branches,
        dropped,
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for dropped in [&self.dropped_branches, &self.dropped] {
            write_notices(f, dropped_line(dropped).as_slice())?;
        }
        let Self { terrain, before_in_bytes, after_in_bytes, elapsed_s, .. } = self;
        let (before, after) = (HumanBytes(*before_in_bytes), HumanBytes(*after_in_bytes));
        writeln!(f, "{terrain}: {before} before, {after} after, in {elapsed_s:.2} s")
    }
}
