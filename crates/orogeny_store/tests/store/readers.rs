//! One writer, any number of readers.

use orogeny_store::{EntryId, Error, Store};

use crate::support::{Scratch, assert_whole, bits, commit, contents, key, layer, page};

#[test]
fn a_second_writer_is_told_who_has_the_terrain() {
    let scratch = Scratch::new();
    let store = scratch.create();
    let err = Store::open(&scratch.path()).unwrap_err();
    let Error::Busy { holder: Some(holder), .. } = &err else { panic!("{err}") };
    assert_eq!(holder.process, std::process::id());
    assert!(err.to_string().contains(&format!("process {}", std::process::id())), "{err}");
    drop(store);
    Store::open(&scratch.path()).unwrap();
}

#[test]
fn readers_see_the_last_commit_and_change_nothing() {
    let scratch = Scratch::new();
    let mut writer = scratch.create();
    let mut reader = Store::open_to_read(&scratch.path()).unwrap();
    let at = key(&writer, 0, 0);
    for seed in 1..4 {
        commit(&mut writer, &[(at, page(seed))]);
        assert_eq!(bits(&reader.load_page(&at).unwrap().unwrap()), bits(&page(seed)));
    }
    let mut transaction = writer.begin().unwrap();
    transaction.write_pages(&[(at, page(9))]).unwrap();
    assert_eq!(bits(&reader.load_page(&at).unwrap().unwrap()), bits(&page(3)));
    transaction.add_layer(&layer("Two", 0.0)).unwrap();
    transaction.commit("{}", "two").unwrap();
    assert_eq!(reader.layers().len(), 1);
    reader.refresh().unwrap();
    assert_eq!(reader.layers(), writer.layers());
    assert_eq!(reader.num_commits().unwrap(), writer.num_commits().unwrap());
    assert_whole(&reader);
    assert!(matches!(reader.begin(), Err(Error::OpenedToRead { .. })));
    assert!(matches!(reader.undo(1), Err(Error::OpenedToRead { .. })));
    assert!(matches!(reader.set_history_budget(None), Err(Error::OpenedToRead { .. })));
    assert!(matches!(reader.compact(), Err(Error::OpenedToRead { .. })));
    writer.undo(1).unwrap();
    drop(writer);
    assert_eq!(reader.log().unwrap().len(), 4);
    drop(reader);
    // What a writer has to leave to a reader goes with the next one.
    Store::open(&scratch.path()).unwrap().close().unwrap();
    assert_eq!(scratch.files(), ["terrain.orogeny"]);
}

#[test]
fn reading_leaves_a_closed_terrain_as_it_is() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let at = key(&store, 0, 0);
    commit(&mut store, &[(at, page(1))]);
    store.close().unwrap();
    let bytes = std::fs::read(scratch.path()).unwrap();
    let reader = Store::open_to_read(&scratch.path()).unwrap();
    assert_eq!(contents(&reader, at.field).len(), 4);
    drop(reader);
    assert_eq!(std::fs::read(scratch.path()).unwrap(), bytes);
    assert_eq!(scratch.files(), ["terrain.orogeny"]);
}

#[test]
fn a_log_that_lost_its_end_is_damage() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let at = key(&store, 0, 0);
    for seed in 1..=6 {
        commit(&mut store, &[(at, page(seed))]);
    }
    // As a kill leaves it: copies of what is on disk while the terrain is open.
    let copy = scratch.folder().join("copy.orogeny");
    let suffixed = |suffix: &str| scratch.folder().join(format!("copy.orogeny{suffix}"));
    for suffix in ["", "-wal", "-head"] {
        let from = scratch.folder().join(format!("terrain.orogeny{suffix}"));
        std::fs::copy(from, suffixed(suffix)).unwrap();
    }
    drop(store);
    let log = std::fs::read(suffixed("-wal")).unwrap();
    std::fs::write(suffixed("-wal"), &log[..log.len() - 1]).unwrap();
    for open in [Store::open, Store::open_to_read, Store::open] {
        let err = open(&copy).unwrap_err();
        assert!(matches!(err, Error::LostCommits { found: 6, acknowledged: 7, .. }), "{err}");
        assert!(err.to_string().contains("lost its last 1 commits"), "{err}");
    }
    let report = Store::check_file(&copy).unwrap();
    assert!(matches!(report.problems.as_slice(), [Error::LostCommits { .. }]), "{:?}", report.problems);
    // The rest is whole, and goes on.
    let repaired = Store::repair(&copy).unwrap();
    assert_eq!(repaired.lost_commits, Some((6, 7)));
    let store = Store::open(&copy).unwrap();
    assert_eq!(bits(&store.load_page(&at).unwrap().unwrap()), bits(&page(5)));
    assert_eq!(store.log().unwrap().last().unwrap().id, EntryId(5));
    assert_whole(&store);
}

#[test]
fn what_a_reader_holds_stays_while_others_commit() {
    let scratch = Scratch::new();
    let mut writer = scratch.create();
    let at = key(&writer, 0, 0);
    commit(&mut writer, &[(at, page(1))]);
    let mut reader = Store::open_to_read(&scratch.path()).unwrap();
    for seed in 2..4 {
        reader.hold().unwrap();
        let (num_layers, num_commits) = (reader.layers().len(), reader.num_commits().unwrap());
        let mut transaction = writer.begin().unwrap();
        transaction.add_layer(&layer(&format!("Layer {seed}"), 0.0)).unwrap();
        transaction.write_pages(&[(at, page(seed))]).unwrap();
        transaction.commit("{}", "both").unwrap();
        // What reads several things for itself does not end it.
        assert_eq!(reader.log().unwrap().len(), seed as usize - 1);
        reader.refresh().unwrap();
        assert_eq!((reader.layers().len(), reader.num_commits().unwrap()), (num_layers, num_commits));
        assert_eq!(bits(&reader.load_page(&at).unwrap().unwrap()), bits(&page(seed - 1)));
    }
    reader.hold().unwrap();
    assert_eq!(reader.layers(), writer.layers());
    assert_eq!(bits(&reader.load_page(&at).unwrap().unwrap()), bits(&page(3)));
    // A writer has nothing to hold.
    writer.hold().unwrap();
    commit(&mut writer, &[(at, page(4))]);
    drop(reader);
    writer.close().unwrap();
    assert_eq!(scratch.files(), ["terrain.orogeny"]);
}

#[test]
fn what_an_older_terrain_left_behind_says_nothing_about_a_new_one() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let at = key(&store, 0, 0);
    for seed in 1..5 {
        commit(&mut store, &[(at, page(seed))]);
    }
    let left_behind = std::fs::read(scratch.folder().join("terrain.orogeny-head")).unwrap();
    drop(store);
    std::fs::remove_file(scratch.path()).unwrap();
    std::fs::write(scratch.folder().join("terrain.orogeny-head"), left_behind).unwrap();
    let mut store = scratch.create();
    assert!(Store::open_to_read(&scratch.path()).is_ok());
    commit(&mut store, &[(at, page(9))]);
    store.close().unwrap();
    assert_whole(&Store::open(&scratch.path()).unwrap());
}

#[test]
fn a_second_writer_that_got_past_the_lock_is_seen() {
    let scratch = Scratch::new();
    let mut one = scratch.create();
    let at = key(&one, 0, 0);
    commit(&mut one, &[(at, page(1))]);
    std::fs::remove_file(scratch.folder().join("terrain.orogeny-head")).unwrap();
    let mut two = Store::open(&scratch.path()).unwrap();
    commit(&mut two, &[(at, page(2))]);
    assert!(matches!(one.begin(), Err(Error::Busy { .. })));
    assert!(matches!(one.undo(1), Err(Error::Busy { .. })));
    assert_eq!(two.undo(2).unwrap().len(), 2);
    assert_whole(&two);
}
