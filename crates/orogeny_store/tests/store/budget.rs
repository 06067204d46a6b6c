//! A history within a budget: the oldest goes, by name, and the terrain stays as it is.

use orogeny_store::{EntryId, EntryState, Store};

use crate::support::{Scratch, assert_whole, commit, contents, key, layer, page};

fn ids(entries: &[EntryId]) -> Vec<u32> {
    entries.iter().map(|entry| entry.0).collect()
}

fn kept(store: &Store) -> Vec<u32> {
    store.log().unwrap().iter().map(|entry| entry.id.0).collect()
}

/// Twelve entries of one page each, a layer among them, all of the same size.
fn painted(scratch: &Scratch) -> Store {
    let mut store = scratch.create();
    for seed in 1..=12 {
        let at = key(&store, seed % 5, seed % 3);
        let mut transaction = store.begin().unwrap();
        transaction.write_pages(&[(at, page(seed))]).unwrap();
        if seed == 2 {
            transaction.add_layer(&layer("More", 1.0)).unwrap();
        }
        transaction.commit("{}", "test").unwrap();
    }
    store
}

#[test]
fn what_is_over_the_budget_goes_oldest_first_and_what_is_kept_can_be_undone() {
    let scratch = Scratch::new();
    let mut store = painted(&scratch);
    let field = store.layers()[0].heights;
    let all = store.history_summary().unwrap().size_in_bytes;
    let (shown, layers) = (contents(&store, field), store.layers().to_vec());
    let dropped = store.set_history_budget(Some(all / 2)).unwrap();
    let num_dropped = dropped.entries.len() as u32;
    assert!((5..9).contains(&num_dropped), "{dropped:?}");
    assert_eq!(ids(&dropped.entries), (1..=num_dropped).collect::<Vec<_>>());
    assert_eq!(kept(&store), (num_dropped + 1..=12).collect::<Vec<_>>());
    let summary = store.history_summary().unwrap();
    assert_eq!(
        (summary.size_in_bytes, summary.budget_in_bytes),
        (all - dropped.size_in_bytes, Some(all / 2))
    );
    assert_eq!((contents(&store, field), store.layers()), (shown.clone(), &*layers));
    assert_whole(&store);
    // As far as the history goes back, and on again; the layer was made before that.
    assert_eq!(store.undo(u32::MAX).unwrap().len() as u32, 12 - num_dropped);
    assert_eq!(store.layers(), layers);
    assert_whole(&store);
    drop(store);
    let mut store = Store::open(&scratch.path()).unwrap();
    assert_eq!(store.redo(u32::MAX).unwrap().len() as u32, 12 - num_dropped);
    assert_eq!(contents(&store, field), shown);
    assert_whole(&store);
    // Every commit from here on keeps to it, and says what went.
    let mut last_dropped = num_dropped;
    for seed in 20..40 {
        let at = key(&store, seed % 5, seed % 3);
        let mut transaction = store.begin().unwrap();
        transaction.write_pages(&[(at, page(seed))]).unwrap();
        transaction.record("{}", "test").unwrap();
        let committed = transaction.commit_recorded().unwrap();
        for id in ids(&committed.dropped.entries) {
            assert_eq!(id, last_dropped + 1);
            last_dropped = id;
        }
        assert!(store.history_summary().unwrap().size_in_bytes <= all / 2);
    }
    assert!(last_dropped > 20, "{last_dropped}");
    assert_whole(&store);
}

#[test]
fn branches_go_before_what_shows_and_what_could_be_redone_last() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    // 1 - 2 - 3 - 4, 2 - 5 - 6 - 7, and 6, 7 undone.
    for (id, parent) in [(1, 0), (2, 1), (3, 2), (4, 3), (5, 2), (6, 5), (7, 6)] {
        store.jump(EntryId(parent)).unwrap();
        let at = key(&store, id % 5, 0);
        commit(&mut store, &[(at, page(id))]);
    }
    store.undo(2).unwrap();
    let mut order = Vec::new();
    let mut budget = store.history_summary().unwrap().size_in_bytes;
    while budget > 0 {
        budget -= budget.min(4000);
        order.extend(ids(&store.set_history_budget(Some(budget)).unwrap().entries));
        assert_whole(&store);
    }
    assert_eq!(order, [4, 3, 1, 2, 5, 7, 6]);
    assert!(store.log().unwrap().is_empty());
    assert!(store.undo(1).unwrap().is_empty() && store.redo(1).unwrap().is_empty());
    // An operation larger than the budget is done, and cannot be undone.
    let at = key(&store, 4, 2);
    let mut transaction = store.begin().unwrap();
    transaction.write_pages(&[(at, page(99))]).unwrap();
    let entry = transaction.record("{}", "test").unwrap();
    assert_eq!(transaction.commit_recorded().unwrap().dropped.entries, [entry]);
    assert!(store.load_page(&at).unwrap().is_some() && store.undo(1).unwrap().is_empty());
    store.set_history_budget(None).unwrap();
    commit(&mut store, &[(at, page(100))]);
    assert_eq!(store.undo(1).unwrap().len(), 1);
    assert_whole(&store);
}

#[test]
fn compacting_gives_space_back_and_changes_nothing() {
    let scratch = Scratch::new();
    let mut store = painted(&scratch);
    let field = store.layers()[0].heights;
    store.undo(6).unwrap();
    let at = key(&store, 0, 0);
    commit(&mut store, &[(at, page(50))]);
    let dropped = store.drop_branches().unwrap();
    assert_eq!(dropped.entries.len(), 6);
    assert!(store.log().unwrap().iter().all(|entry| entry.state == EntryState::Applied));
    let (shown, log) = (contents(&store, field), store.log().unwrap());
    let (before, after) = store.compact().unwrap();
    assert!(before - after > dropped.size_in_bytes / 2, "{before} to {after}, {dropped:?}");
    assert_eq!((contents(&store, field), store.log().unwrap()), (shown, log));
    assert_whole(&store);
    assert_eq!(store.undo(u32::MAX).unwrap().len(), 7);
}
