//! What is reported, as text or as one JSON object.

use std::fmt::Display;
use std::io::{self, Write as _};
use std::path::Path;

use indicatif::HumanBytes;
use orogeny_engine::{Dropped, MemoryUse};
use serde::Serialize;

/// Where reports go, and in which form.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    json: bool,
}

impl Output {
    /// As JSON or as text.
    pub const fn new(json: bool) -> Self {
        Self { json }
    }

    /// What a command did or found.
    ///
    /// # Errors
    /// When standard output cannot be written.
    pub fn report(self, report: &(impl Serialize + Display)) -> anyhow::Result<()> {
        let mut out = io::stdout().lock();
        if self.json {
            serde_json::to_writer_pretty(&mut out, report)?;
            writeln!(out)?;
        } else {
            write!(out, "{report}")?;
        }
        Ok(out.flush()?)
    }

    /// A line on the way, for people only.
    ///
    /// # Errors
    /// When standard output cannot be written.
    pub fn line(self, line: &str) -> anyhow::Result<()> {
        if !self.json {
            writeln!(io::stdout().lock(), "{line}")?;
        }
        Ok(())
    }

    /// Why the command failed. What cannot be written is lost: there is nowhere left to say so.
    pub fn error(self, message: &str) {
        let mut err = io::stderr().lock();
        if self.json {
            writeln!(err, "{}", serde_json::json!({ "error": message })).ok();
        } else {
            writeln!(err, "error: {message}").ok();
        }
    }
}

/// Whether the reader of standard output has gone away.
pub fn is_broken_pipe(err: &anyhow::Error) -> bool {
    let kind = match (err.downcast_ref::<io::Error>(), err.downcast_ref::<serde_json::Error>()) {
        (Some(err), _) => Some(err.kind()),
        (None, Some(err)) => err.io_error_kind(),
        (None, None) => None,
    };
    kind == Some(io::ErrorKind::BrokenPipe)
}

/// A path as a report holds it.
pub fn text_of(path: &Path) -> String {
    path.display().to_string()
}

/// Notes of the engine, a line each.
pub fn write_notices(f: &mut std::fmt::Formatter<'_>, notices: &[String]) -> std::fmt::Result {
    notices.iter().try_for_each(|notice| writeln!(f, "note: {notice}"))
}

/// What a terrain keeps in memory, and what it may.
pub fn memory_line(memory: &MemoryUse) -> String {
    let MemoryUse { budget_in_bytes, pages_in_bytes, textures_in_bytes, store_in_bytes } = *memory;
    format!(
        "{} for painting, {} of textures, {} on their way to the file, of a budget of {}",
        HumanBytes(pages_in_bytes),
        HumanBytes(textures_in_bytes),
        HumanBytes(store_in_bytes),
        HumanBytes(budget_in_bytes)
    )
}

/// What went from the history; `None` where nothing did.
pub fn dropped_line(dropped: &Dropped) -> Option<String> {
    let (first, last) = (dropped.entries.iter().min()?, dropped.entries.iter().max()?);
    let entries = count(dropped.entries.len() as u64, "operation");
    let size = HumanBytes(dropped.size_in_bytes);
    let num_applied = dropped.applied.len() as u64;
    let what = match dropped.entries.len() as u64 - num_applied {
        0 => "they stay done, and can no longer be undone".to_owned(),
        number if num_applied == 0 => format!("{number} undone, gone for good"),
        number => {
            format!("{num_applied} stay done and can no longer be undone, {number} undone are gone for good")
        }
    };
    Some(format!("{entries} from {first} to {last} ({size}) went from the history: {what}"))
}

/// A number of things: `1 page`, `2 pages`.
pub fn count(number: u64, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}
