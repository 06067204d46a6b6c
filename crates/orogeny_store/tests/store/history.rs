//! Undo, redo, branches, layers.

use orogeny_store::{EntryId, EntryState, Error, HistorySummary, Store};

use crate::support::{Scratch, assert_whole, bits, commit, contents, key, layer, page};

fn states(store: &Store) -> Vec<EntryState> {
    store.log().unwrap().iter().map(|entry| entry.state).collect()
}

#[test]
fn undo_and_redo_stop_at_the_ends_and_survive_reopening() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let (field, key) = (store.layers()[0].heights, key(&store, 0, 0));
    let mut shown = vec![contents(&store, field)];
    for seed in 1..=5 {
        commit(&mut store, &[(key, page(seed))]);
        shown.push(contents(&store, field));
    }
    assert!(store.redo(1).unwrap().is_empty());
    assert!(store.undo(0).unwrap().is_empty());
    let undone = store.undo(2).unwrap();
    assert_eq!(undone.iter().map(|change| change.entry).collect::<Vec<_>>(), [EntryId(5), EntryId(4)]);
    assert_eq!(contents(&store, field), shown[3]);
    drop(store);
    let mut store = Store::open(&scratch.path()).unwrap();
    assert_eq!(store.undo(1000).unwrap().len(), 3);
    assert_eq!(contents(&store, field), shown[0]);
    assert!(store.undo(1).unwrap().is_empty());
    for expected in &shown[1..] {
        assert_eq!(store.redo(1).unwrap().len(), 1);
        assert_eq!(&contents(&store, field), expected);
        assert_whole(&store);
    }
    assert!(store.redo(u32::MAX).unwrap().is_empty());
}

#[test]
fn what_is_left_behind_stays_in_the_log_as_a_branch() {
    use EntryState::{Applied, Branch, Undone};
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let key = key(&store, 0, 0);
    for seed in 1..=3 {
        commit(&mut store, &[(key, page(seed))]);
    }
    store.undo(2).unwrap();
    assert_eq!(states(&store), [Applied, Undone, Undone]);
    commit(&mut store, &[(key, page(4))]);
    commit(&mut store, &[(key, page(5))]);
    assert_eq!(states(&store), [Applied, Branch, Branch, Applied, Applied]);
    store.undo(3).unwrap();
    assert_eq!(states(&store), [Undone, Branch, Branch, Undone, Undone]);
    let summary = store.history_summary().unwrap();
    let taken = |entry: &orogeny_store::Entry| entry.delta_bytes + entry.operation_json.len() as u64;
    let size_in_bytes = store.log().unwrap().iter().map(taken).sum();
    let expected =
        HistorySummary { size_in_bytes, num_undone: 3, num_branch: 2, ..HistorySummary::default() };
    assert_eq!(summary, expected);
    assert_eq!(store.redo(9).unwrap().len(), 3);
    assert_eq!(bits(&store.load_page(&key).unwrap().unwrap()), bits(&page(5)));
    let parents: Vec<_> = store.log().unwrap().iter().map(|entry| entry.parent.0).collect();
    assert_eq!(parents, [0, 1, 2, 1, 4]);
    assert_whole(&store);
}

#[test]
fn a_layer_is_undone_with_its_pages_and_comes_back_the_same() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let base = store.layers().to_vec();
    let mut transaction = store.begin().unwrap();
    let sculpt = transaction.add_layer(&layer("Sculpt", 7.0)).unwrap();
    let key = orogeny_field::PageKey::full_resolution(sculpt.heights, 1, 1);
    transaction.write_pages(&[(key, page(1))]).unwrap();
    transaction.commit("{}", "test").unwrap();
    let both = store.layers().to_vec();
    assert_eq!(both, [base.clone(), vec![sculpt.clone()]].concat());

    let undone = store.undo(1).unwrap();
    assert!(undone[0].layers_changed);
    assert_eq!(store.layers(), base);
    assert_eq!(store.load_page(&key).unwrap(), None);
    store.redo(1).unwrap();
    assert_eq!(store.layers(), both);
    assert_eq!(bits(&store.load_page(&key).unwrap().unwrap()), bits(&page(1)));

    // Another layer made after an undo is another layer.
    store.undo(1).unwrap();
    let mut transaction = store.begin().unwrap();
    let other = transaction.add_layer(&layer("Other", 0.0)).unwrap();
    transaction.commit("{}", "test").unwrap();
    assert!(other.id > sculpt.id && other.heights > sculpt.heights);
    assert_whole(&store);
    store.close().unwrap();
    assert_eq!(Store::open(&scratch.path()).unwrap().layers(), [base, vec![other]].concat());
}

#[test]
fn any_entry_can_be_jumped_to_on_branches_too() {
    use EntryState::{Applied, Branch};
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let field = store.layers()[0].heights;
    let mut shown = vec![contents(&store, field)];
    // 1 - 2 - 3 - 4, 2 - 5 - 6, 1 - 7
    for (id, parent) in [(1, 0), (2, 1), (3, 2), (4, 3), (5, 2), (6, 5), (7, 1)] {
        store.jump(EntryId(parent)).unwrap();
        let page_of = key(&store, id % 4, id % 3);
        assert_eq!(commit(&mut store, &[(page_of, page(id))]), EntryId(id));
        shown.push(contents(&store, field));
    }
    for target in [4, 6, 7, 0, 3, 6, 1, 7, 4, 2, 2] {
        let from = store.log().unwrap().iter().rev().find(|e| e.state == Applied).map_or(0, |e| e.id.0);
        let changes = store.jump(EntryId(target)).unwrap();
        assert_eq!(changes.is_empty(), from == target);
        assert_eq!(contents(&store, field), shown[target as usize], "from {from} to {target}");
        assert_whole(&store);
    }
    // A branch that was jumped to is the one that redo leads to.
    store.jump(EntryId(6)).unwrap();
    store.undo(2).unwrap();
    assert_eq!(store.redo(9).unwrap().iter().map(|change| change.entry.0).collect::<Vec<_>>(), [5, 6]);
    assert_eq!(states(&store), [Applied, Applied, Branch, Branch, Applied, Applied, Branch]);
    let err = store.jump(EntryId(8)).unwrap_err();
    assert!(matches!(err, Error::UnknownEntry { entry: EntryId(8) }), "{err}");
}

#[test]
fn clocks_that_jump_change_nothing_but_what_is_said() {
    use std::time::{Duration, SystemTime, UNIX_EPOCH};
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let clocks: [fn() -> SystemTime; 3] = [
        || UNIX_EPOCH + Duration::from_secs(4_000_000_000),
        || UNIX_EPOCH - Duration::from_secs(5),
        || UNIX_EPOCH + Duration::from_secs(1),
    ];
    let at = key(&store, 1, 1);
    for (clock, seed) in clocks.into_iter().zip(1..) {
        store.set_clock(clock);
        commit(&mut store, &[(at, page(seed))]);
    }
    let times: Vec<_> = store.log().unwrap().iter().map(|entry| entry.time_unix_ms).collect();
    assert_eq!(times, [4_000_000_000_000, 0, 1000]);
    assert_eq!(store.undo(2).unwrap().len(), 2);
    assert_eq!(bits(&store.load_page(&at).unwrap().unwrap()), bits(&page(1)));
    store.redo(1).unwrap();
    assert_whole(&store);
}
