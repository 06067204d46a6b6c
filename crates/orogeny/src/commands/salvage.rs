//! `salvage`: what can be read of a damaged terrain.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use orogeny_engine::{Salvaged, Terrain};
use serde::Serialize;

use crate::output::{count, text_of};
use crate::session::Session;

/// What `salvage` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The damaged terrain, which is not changed
    terrain: PathBuf,
    /// The terrain to make of it
    to: PathBuf,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    to: String,
    num_whole_pages: u64,
    num_pages_from_history: u64,
    num_pages_from_coarser_levels: u64,
    num_lost_pages: u64,
    /// What was not whole, for people.
    notices: Vec<String>,
    elapsed_s: f64,
}

/// Saves what is left.
///
/// # Errors
/// When nothing can be read, or the new terrain not be written.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let salvaged = Terrain::salvage(&arguments.terrain, &arguments.to)?;
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        to: text_of(&arguments.to),
        num_whole_pages: salvaged.num_whole_pages,
        num_pages_from_history: salvaged.pages_from_history.len() as u64,
        num_pages_from_coarser_levels: salvaged.pages_from_coarser_levels.len() as u64,
        num_lost_pages: salvaged.lost_pages.len() as u64,
        notices: notices(&salvaged),
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

fn notices(salvaged: &Salvaged) -> Vec<String> {
    let place = |key: &orogeny_engine::PageKey| {
        format!("the page at column {} row {} of field {}", key.x, key.z, key.field.0)
    };
    let from_history = salvaged
        .pages_from_history
        .iter()
        .map(|key| format!("{} was made again from the history", place(key)));
    let from_coarser = salvaged
        .pages_from_coarser_levels
        .iter()
        .map(|(key, level)| format!("{} is what level {level} was left of it", place(key)));
    let lost = salvaged.lost_pages.iter().map(|key| format!("{} is lost", place(key)));
    salvaged.problems.iter().cloned().chain(from_history).chain(from_coarser).chain(lost).collect()
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        crate::output::write_notices(f, &self.notices)?;
        let Self { terrain, to, elapsed_s, .. } = self;
        let whole = count(self.num_whole_pages, "whole page");
        writeln!(
            f,
            "saved {terrain} as {to}: {whole}, {} from the history, {} from coarser levels, {} lost, in {elapsed_s:.2} s",
            self.num_pages_from_history, self.num_pages_from_coarser_levels, self.num_lost_pages
        )
    }
}
