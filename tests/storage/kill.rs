//! `SIGKILL` at random moments: everything acknowledged is there, and what is there is whole.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::Path;
use std::time::Duration;

use orogeny_field::{FieldId, Page, PageKey};
use orogeny_store::{EntryId, EntryState, NewLayer, Store};

use crate::support::{
    PAGES, Seeded, acknowledge, acknowledged, assert_whole, child, child_path, contents, create, page,
};

/// Kills after which a test starts with a new terrain, so that its history stays short enough to replay.
const KILLS_PER_TERRAIN: usize = 10;

/// What entry `id` paints: three pages of the base layer, a function of the number alone.
pub fn painted(field: FieldId, id: u32) -> Vec<(PageKey, Page)> {
    let num_pages = PAGES.0 * PAGES.1;
    let place = |i: u32| (id * 7 + i * 4) % num_pages;
    (0..3)
        .map(|i| (PageKey::full_resolution(field, place(i) % PAGES.0, place(i) / PAGES.0), page(id * 3 + i)))
        .collect()
}

pub const fn adds_layer(id: u32) -> bool {
    id % 10 == 5
}

const fn is_undone_at_once(id: u32) -> bool {
    id % 7 == 3
}

/// Paints, and now and then undoes, until it is killed.
fn paint_without_pause(path: &Path) -> ! {
    let mut store = Store::open(path).unwrap();
    let field = store.layers()[0].heights;
    loop {
        let id = store.log().unwrap().last().map_or(0, |entry| entry.id.0) + 1;
        let mut transaction = store.begin().unwrap();
        transaction.write_pages(&painted(field, id)).unwrap();
        if adds_layer(id) {
            transaction.add_layer(&NewLayer { name: format!("Layer {id}"), constant_m: 1.0 }).unwrap();
        }
        let entry = transaction.commit(&format!("{{\"number\": {id}}}"), "child").unwrap();
        acknowledge(&format!("commit {entry}"));
        if is_undone_at_once(id) {
            let undone = store.undo(1).unwrap();
            acknowledge(&format!("undo {}", undone[0].entry));
        }
    }
}

/// Checks a terrain that was just reopened against what was acknowledged before the kill. Returns the last entry.
fn verify(store: &mut Store, acknowledged: &[String], undo_to_the_start: bool) {
    assert_whole(store);
    let log = store.log().unwrap();
    for entry in &log {
        assert_eq!(entry.operation_json, format!("{{\"number\": {}}}", entry.id));
    }
    for line in acknowledged {
        let id = EntryId(line.split(' ').next_back().unwrap().parse().unwrap());
        assert!(log.iter().any(|entry| entry.id == id), "`{line}` was acknowledged and is lost");
    }
    let applied: Vec<u32> =
        log.iter().filter(|entry| entry.state == EntryState::Applied).map(|entry| entry.id.0).collect();
    let head = applied.last().copied().unwrap_or(0);
    if let Some(last) = acknowledged.last() {
        let (action, id) = last.split_once(' ').unwrap();
        let id: u32 = id.parse().unwrap();
        let parent = log.iter().find(|entry| entry.id.0 == id).unwrap().parent.0;
        let parent_of_head = log.iter().find(|entry| entry.id.0 == head).map(|entry| entry.parent.0);
        // Where the acknowledged action left the terrain, or one action further.
        let as_acknowledged = if action == "undo" { parent } else { id };
        let next_undone = action == "commit" && is_undone_at_once(id) && head == parent;
        let next_committed = head == id + 1 && parent_of_head == Some(as_acknowledged);
        assert!(head == as_acknowledged || next_undone || next_committed, "{head} after `{last}`");
    }

    let field = store.layers()[0].heights;
    let mut expected = BTreeMap::new();
    for id in &applied {
        expected.extend(painted(field, *id));
    }
    assert_eq!(contents(store), expected);
    assert_eq!(store.layers().len(), 1 + applied.iter().filter(|id| adds_layer(**id)).count());

    if undo_to_the_start {
        assert_eq!(store.undo(u32::MAX).unwrap().len(), applied.len());
        assert!(contents(store).is_empty());
        let redone: Vec<u32> =
            store.redo(u32::try_from(applied.len()).unwrap()).unwrap().iter().map(|c| c.entry.0).collect();
        assert_eq!(redone, applied);
        assert_eq!(contents(store), expected);
        assert_whole(store);
    }
}

#[test]
fn a_killed_process_loses_nothing_that_it_acknowledged() {
    if let Some(path) = child_path() {
        paint_without_pause(&path);
    }
    let num_kills = if crate::support::is_long() { 1000 } else { 20 };
    let mut random = Seeded(0x0005_eed0);
    let mut num_acknowledged = 0;
    let mut num_mid_work = 0;
    let mut folder = tempfile::tempdir().unwrap();
    for kill in 0..num_kills {
        if kill % KILLS_PER_TERRAIN == 0 {
            folder = tempfile::tempdir().unwrap();
            create(&folder.path().join("t.orogeny")).close().unwrap();
        }
        let path = folder.path().join("t.orogeny");
        let mut process =
            child("kill::a_killed_process_loses_nothing_that_it_acknowledged", &path).spawn().unwrap();
        std::thread::sleep(Duration::from_micros(20_000 + random.below(150_000)));
        process.kill().unwrap();
        let mut output = Vec::new();
        process.stdout.take().unwrap().read_to_end(&mut output).unwrap();
        let status = process.wait().unwrap();
        assert!(status.code().is_none(), "the child ended by itself: {}", String::from_utf8_lossy(&output));
        let lines = acknowledged(&output);
        num_acknowledged += lines.len();
        num_mid_work += usize::from(folder.path().join("t.orogeny-wal").exists());
        let mut store = Store::open(&path).unwrap();
        verify(&mut store, &lines, kill % 5 == 4);
    }
    println!(
        "{num_kills} kills, {num_acknowledged} acknowledged actions, a log left behind {num_mid_work} times"
    );
    assert!(num_acknowledged > num_kills, "the children were too slow for the test to say anything");
    assert!(num_mid_work > num_kills / 2, "most kills came before any work");
}

#[test]
fn a_killed_transaction_leaves_no_trace_however_large() {
    const TEST: &str = "kill::a_killed_transaction_leaves_no_trace_however_large";
    if let Some(path) = child_path() {
        let mut store = Store::open(&path).unwrap();
        let field = store.layers()[0].heights;
        let mut transaction = store.begin().unwrap();
        // More than the database caches, so that uncommitted pages are in the log on disk.
        for seed in 0..200 {
            for z in 0..PAGES.1 {
                let row =
                    (0..PAGES.0).map(|x| (PageKey { field, level: 0, z, x }, page(seed * 15 + z * 5 + x)));
                transaction.write_pages(&row.collect::<Vec<_>>()).unwrap();
            }
        }
        transaction.add_layer(&NewLayer { name: "Lost".to_owned(), constant_m: 0.0 }).unwrap();
        acknowledge("written");
        std::thread::sleep(Duration::from_secs(600));
        unreachable!("the parent did not kill this process");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let mut store = create(&path);
    let mut transaction = store.begin().unwrap();
    transaction.write_pages(&painted(transaction.layers()[0].heights, 1)).unwrap();
    transaction.commit("{\"number\": 1}", "parent").unwrap();
    let before = contents(&store);
    store.close().unwrap();

    let mut process = child(TEST, &path).spawn().unwrap();
    let mut stdout = std::io::BufReader::new(process.stdout.take().unwrap());
    let mut output = Vec::new();
    while acknowledged(&output).is_empty() {
        let num_read = std::io::BufRead::read_until(&mut stdout, b'\n', &mut output).unwrap();
        assert!(num_read > 0, "the child ended by itself: {}", String::from_utf8_lossy(&output));
    }
    process.kill().unwrap();
    process.wait().unwrap();

    let mut store = Store::open(&path).unwrap();
    assert_eq!(contents(&store), before);
    verify(&mut store, &["commit 1".to_owned()], true);
    store.close().unwrap();
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["t.orogeny"]);
}
