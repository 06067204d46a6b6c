//! `replay`: all that the history says, done again on a new terrain.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use orogeny_engine::Replayed;
use serde::Serialize;

use crate::output::{count, text_of};
use crate::progress::ProgressWatch;
use crate::session::Session;

/// What `replay` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain, which is not changed
    terrain: PathBuf,
    /// The terrain to make
    to: PathBuf,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    to: String,
    #[serde(flatten)]
    replayed: Replayed,
    elapsed_s: f64,
}

/// Replays the history.
///
/// # Errors
/// When it does not reach back to the beginning, or an operation cannot be done again; no terrain is made then.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let terrain = session.open_to_read(&arguments.terrain)?;
    let replayed = terrain.replay(&arguments.to, session.settings(), &mut ProgressWatch::new())?;
    terrain.close()?;
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        to: text_of(&arguments.to),
        replayed,
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { terrain, to, replayed, elapsed_s } = self;
        let operations = count(replayed.num_operations, "operation");
        let left_out = match replayed.num_left_out {
            0 => String::new(),
            number => format!(", {number} that do not show left out"),
        };
        writeln!(f, "replayed {operations} of {terrain} as {to}{left_out}, in {elapsed_s:.2} s")
    }
}
