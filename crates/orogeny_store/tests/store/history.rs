//! Undo, redo, branches, layers, and two connections on one file.

use orogeny_store::{EntryId, EntryState, HistorySummary, Store};

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
    let delta_bytes = store.log().unwrap().iter().map(|entry| entry.delta_bytes).sum();
    assert_eq!(summary, HistorySummary { num_applied: 0, num_undone: 3, num_branch: 2, delta_bytes });
    assert!(delta_bytes > 0);
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
fn two_stores_on_one_file_follow_each_other() {
    let scratch = Scratch::new();
    let mut one = scratch.create();
    let mut two = Store::open(&scratch.path()).unwrap();
    let key = key(&one, 0, 0);
    commit(&mut one, &[(key, page(1))]);
    assert_eq!(bits(&two.load_page(&key).unwrap().unwrap()), bits(&page(1)));
    let mut transaction = two.begin().unwrap();
    transaction.add_layer(&layer("Two", 0.0)).unwrap();
    assert_eq!(transaction.commit("{}", "two").unwrap(), EntryId(2));
    assert_eq!(one.undo(1).unwrap()[0].entry, EntryId(2));
    assert_eq!(one.layers().len(), 1);
    let changes = two.redo(5).unwrap();
    assert_eq!((changes[0].entry, changes[0].layers_changed, two.layers().len()), (EntryId(2), true, 2));
    let transaction = one.begin().unwrap();
    assert_eq!(transaction.layers().len(), 2);
    drop(transaction);
    assert_whole(&one);
}
