//! A history that may not grow: it keeps to its budget after every commit, names what went, and undo reaches to its start.

use orogeny_engine::{EntryState, Quiet, Terrain};
use orogeny_tests::child::is_long;

use crate::support::{apply, assert_same_heights, assert_whole, create, heights, ids, settings, stroke};

const BUDGET_BYTES: u64 = 2 << 20;

/// The strokes come to so many times the budget.
const NUM_BUDGETS: u64 = 2;

#[test]
fn a_history_keeps_to_its_budget_and_undo_reaches_its_oldest_entry() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let mut terrain = create(&path);
    terrain.set_history_budget(Some(BUDGET_BYTES)).unwrap();
    let mut dropped = Vec::new();
    let (mut dropped_in_bytes, mut num_undone, mut number) = (0, 0, 0);
    let wanted_in_bytes = if is_long() { 4 * NUM_BUDGETS } else { NUM_BUDGETS } * BUDGET_BYTES;
    while dropped_in_bytes + BUDGET_BYTES < wanted_in_bytes {
        number += 1;
        terrain.submit(&[stroke(number)], &mut Quiet).unwrap();
        // Some are left behind: those go first.
        if number.is_multiple_of(20) {
            num_undone += terrain.undo(2).unwrap().len();
        }
        // Each waits for the commit.
        let history = terrain.describe().unwrap().history;
        assert_eq!(history.budget_in_bytes, Some(BUDGET_BYTES));
        assert!(history.size_in_bytes <= BUDGET_BYTES, "{} bytes after {number}", history.size_in_bytes);
        let gone = terrain.take_dropped_history().unwrap();
        dropped_in_bytes += gone.size_in_bytes;
        dropped.extend(gone.entries.into_iter().map(|entry| entry.0));
        assert!(number < 100_000, "nothing is ever dropped");
    }
    let log = terrain.log().unwrap();
    let mut all: Vec<u32> = ids(&log, |_| true).into_iter().chain(dropped.iter().copied()).collect();
    all.sort_unstable();
    assert_eq!(all, (1..=number).collect::<Vec<_>>(), "each is there, or was named once");

    // Undo goes to just before the oldest that shows: what went of those that showed is there for good.
    let applied = ids(&log, |entry| entry.state == EntryState::Applied);
    let oldest = applied[0];
    let undone: Vec<u32> = terrain.undo(u32::MAX).unwrap().iter().map(|change| change.entry.0).collect();
    assert!(undone.iter().rev().eq(&applied), "{undone:?}, not {applied:?}");
    assert!(terrain.undo(1).unwrap().is_empty());
    let at_the_start = heights(&path);
    assert_eq!(terrain.redo(u32::MAX).unwrap().len(), applied.len());
    assert_whole(&path);
    assert!(terrain.replay(&folder.path().join("r.orogeny"), settings(), &mut Quiet).is_err());
    terrain.close().unwrap();

    let again = folder.path().join("again.orogeny");
    let mut terrain = create(&again);
    for number in 1..oldest {
        apply(&mut terrain, &[stroke(number)]);
        if number.is_multiple_of(20) {
            terrain.undo(2).unwrap();
        }
    }
    drop(terrain);
    assert_same_heights(&at_the_start, &heights(&again));
    Terrain::open(&path, settings()).unwrap().close().unwrap();
    println!(
        "{number} strokes, {num_undone} undone, {} dropped with {dropped_in_bytes} bytes, {} kept, undo back to before {oldest}",
        dropped.len(),
        log.len()
    );
    assert!(dropped.len() > 10 && num_undone > 0 && oldest > 1);
}
