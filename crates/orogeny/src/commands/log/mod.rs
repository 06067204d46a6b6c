//! `log`: what was done.

mod layers;
mod select;
mod summary;

use std::fmt;
use std::path::PathBuf;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use clap::Args;
use indicatif::HumanDuration;
use orogeny_engine::{Entry, EntryId, EntryState};
use serde::Serialize;
use serde_json::Value;

use self::summary::summary;
use crate::output::{count, text_of};
use crate::session::Session;

/// What `log` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain
    terrain: PathBuf,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    /// The last entry that showed when it was dropped; 0: none was.
    dropped_up_to: EntryId,
    entries: Vec<ReportedEntry>,
}

#[derive(Debug, Serialize)]
struct ReportedEntry {
    id: EntryId,
    parent: EntryId,
    state: EntryState,
    author: String,
    time_unix_ms: i64,
    num_pages: u32,
    delta_bytes: u64,
    operation: Value,
}

/// Lists the history.
///
/// # Errors
/// When the history cannot be read.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let terrain = session.open_to_read(&arguments.terrain)?;
    let entries = terrain.log()?.into_iter().map(reported).collect::<Result<_, _>>()?;
    let dropped_up_to = terrain.describe()?.history.dropped_up_to;
    terrain.close()?;
    session.output().report(&Report { terrain: text_of(&arguments.terrain), dropped_up_to, entries })
}

fn reported(entry: Entry) -> serde_json::Result<ReportedEntry> {
    Ok(ReportedEntry {
        id: entry.id,
        parent: entry.parent,
        state: entry.state,
        author: entry.author,
        time_unix_ms: entry.time_unix_ms,
        num_pages: entry.num_pages,
        delta_bytes: entry.delta_bytes,
        operation: serde_json::from_str(&entry.operation_json)?,
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.dropped_up_to != EntryId(0) {
            writeln!(
                f,
                "{}: what was done up to entry {} went from the history",
                self.terrain, self.dropped_up_to
            )?;
        } else if self.entries.is_empty() {
            return writeln!(f, "{}: nothing was done yet", self.terrain);
        }
        for entry in &self.entries {
            let state = match entry.state {
                EntryState::Applied => "",
                EntryState::Undone => "undone",
                EntryState::Branch => "left behind",
            };
            let pages = count(entry.num_pages.into(), "page");
            let age = age(entry.time_unix_ms, SystemTime::now());
            let what = summary(&entry.operation);
            writeln!(f, "{:>5}  {state:<11}  {pages:>10}  {age:<16}  {what}", entry.id.0)?;
        }
        Ok(())
    }
}

/// How long ago, for people.
fn age(time_unix_ms: i64, now: SystemTime) -> String {
    let time = UNIX_EPOCH + Duration::from_millis(time_unix_ms.max(0).unsigned_abs());
    match now.duration_since(time) {
        Ok(age) => format!("{} ago", HumanDuration(age)),
        Err(_) => "in the future".to_owned(), // the clock was set back
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_told_and_clocks_may_be_wrong() {
        let now = UNIX_EPOCH + Duration::from_secs(3600);
        assert_eq!(age(0, now), "60 minutes ago");
        assert_eq!(age(7_200_000, now), "in the future");
    }
}
