//! What the program notes while it runs: the last lines, shared with whatever gathers them.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tracing::Level;

/// Lines that are kept at most.
pub const MAX_LINES: usize = 5_000;

/// A line of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogLine {
    /// When, since the log was begun.
    pub at: Duration,
    /// How much it matters.
    pub level: Level,
    /// The part of the program that noted it.
    pub target: String,
    /// What it says.
    pub text: String,
}

impl LogLine {
    /// As it is copied: `   12.345 WARN  orogeny_engine::apply: text`.
    #[must_use]
    pub fn to_text(&self) -> String {
        format!("{:>9.3} {:<5} {}: {}", self.at.as_secs_f64(), self.level, self.target, self.text)
    }

    /// Whether it matters at least so much, and all words that are searched for are in it.
    #[must_use]
    pub fn is_found(&self, level: Level, search: &str) -> bool {
        // Of levels the lesser is the one that matters more.
        if self.level > level {
            return false;
        }
        let text = self.to_text().to_lowercase();
        search.to_lowercase().split_whitespace().all(|word| text.contains(word))
    }
}

#[derive(Debug)]
struct Lines {
    begun: Instant,
    all: VecDeque<LogLine>,
    /// How many there ever were.
    num_noted: u64,
}

/// The log: every clone is the same one.
#[derive(Debug, Clone)]
pub struct Log(Arc<Mutex<Lines>>);

impl Default for Log {
    fn default() -> Self {
        Self(Arc::new(Mutex::new(Lines { begun: Instant::now(), all: VecDeque::new(), num_noted: 0 })))
    }
}

impl Log {
    /// Notes a line; the oldest goes where there are too many.
    pub fn push(&self, level: Level, target: impl Into<String>, text: impl Into<String>) {
        // What a thread noted before it panicked is still true.
        let mut lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let at = lines.begun.elapsed();
        if lines.all.len() >= MAX_LINES {
            lines.all.pop_front();
        }
        lines.num_noted += 1;
        lines.all.push_back(LogLine { at, level, target: target.into(), text: text.into() });
    }

    /// Those that matter at least so much and hold what is searched for, oldest first.
    #[must_use]
    pub fn found(&self, level: Level, search: &str) -> Vec<LogLine> {
        let lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        lines.all.iter().filter(|line| line.is_found(level, search)).cloned().collect()
    }

    /// How many are kept, and how many there ever were.
    #[must_use]
    pub fn count(&self) -> (usize, u64) {
        let lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        (lines.all.len(), lines.num_noted)
    }

    /// Forgets all of them.
    pub fn clear(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).all.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_lines_are_kept() {
        let log = Log::default();
        let same = log.clone();
        for k in 0..MAX_LINES + 10 {
            same.push(Level::INFO, "test", format!("line {k}"));
        }
        assert_eq!(log.count(), (MAX_LINES, MAX_LINES as u64 + 10));
        assert_eq!(log.found(Level::INFO, "")[0].text, "line 10");
        log.clear();
        assert_eq!(same.count().0, 0);
    }

    #[test]
    fn lines_are_found_by_level_and_words() {
        let log = Log::default();
        log.push(Level::WARN, "orogeny_engine::apply", "the device was lost");
        log.push(Level::INFO, "orogeny_editor", "stroke raise: done");
        log.push(Level::DEBUG, "orogeny_editor", "a file was looked at");
        let num = |level, search: &str| log.found(level, search).len();
        assert_eq!((num(Level::DEBUG, ""), num(Level::INFO, ""), num(Level::WARN, "")), (3, 2, 1));
        assert_eq!((num(Level::DEBUG, "RAISE stroke"), num(Level::DEBUG, "raise lost")), (1, 0));
        assert_eq!(num(Level::INFO, "engine"), 1);
    }
}
