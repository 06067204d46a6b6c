//! `check`: is a terrain whole?

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::ensure;
use clap::Args;
use orogeny_engine::{Repaired, Terrain};
use serde::Serialize;

use crate::output::{count, text_of};
use crate::session::Session;

/// What `check` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// Make damaged pages again from the history, where it has them, and go on where commits were lost
    #[arg(long)]
    repair: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    is_whole: bool,
    num_pages: u64,
    num_entries: u64,
    num_deltas: u64,
    num_blobs: u64,
    problems: Vec<String>,
    /// What a repair did.
    repairs: Vec<String>,
    elapsed_s: f64,
}

/// Checks the terrain.
///
/// # Errors
/// When it is damaged, or cannot be read at all.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let path = &arguments.terrain;
    let repairs = match arguments.repair {
        true => lines_of(&Terrain::repair(path)?),
        false => Vec::new(),
    };
    let report = Terrain::check(path)?;
    let problems: Vec<_> = report.problems.iter().map(ToString::to_string).collect();
    let is_whole = problems.is_empty();
    session.output().report(&Report {
        terrain: text_of(path),
        is_whole,
        num_pages: report.num_pages,
        num_entries: report.num_entries,
        num_deltas: report.num_deltas,
        num_blobs: report.num_blobs,
        problems,
        repairs,
        elapsed_s: start.elapsed().as_secs_f64(),
    })?;
    ensure!(is_whole, "`{}` is damaged", path.display());
    Ok(())
}

/// What a repair did, for people.
fn lines_of(repaired: &Repaired) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some((found, acknowledged)) = repaired.lost_commits {
        lines.push(match acknowledged > found {
            true => {
                format!("commits {} to {acknowledged} are lost; it goes on from commit {found}", found + 1)
            }
            false => format!("it is not the terrain that was last open here; it goes on from commit {found}"),
        });
    }
    for key in &repaired.pages_from_history {
        lines.push(format!(
            "the page at column {} row {} of field {} was made again from the history, bit for bit",
            key.x, key.z, key.field.0
        ));
    }
    for key in &repaired.lost_pages {
        lines.push(format!(
            "the page at column {} row {} of field {} could not be made again: `salvage` saves the rest",
            key.x, key.z, key.field.0
        ));
    }
    if repaired.levels_made_anew {
        lines.push("coarser levels were made anew".to_owned());
    }
    lines
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for repair in &self.repairs {
            writeln!(f, "repair: {repair}")?;
        }
        for problem in &self.problems {
            writeln!(f, "problem: {problem}")?;
        }
        let Self { terrain, num_pages, num_entries, num_deltas, num_blobs, elapsed_s, .. } = self;
        let verdict = match self.problems.len() as u64 {
            0 => "whole".to_owned(),
            number => count(number, "problem"),
        };
        let pages = count(*num_pages, "page");
        let deltas = count(*num_deltas, "delta");
        let files = count(*num_blobs, "imported file");
        // The terrain's creation is an entry of its own.
        let operations = count(num_entries.saturating_sub(1), "operation");
        writeln!(
            f,
            "{terrain}: {verdict}; {pages}, {operations}, {deltas}, {files} verified in {elapsed_s:.2} s"
        )
    }
}
