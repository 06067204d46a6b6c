//! Damaged files: never a panic, never wrong content in silence, and an error that names the place.

use std::path::Path;

use orogeny_field::PageKey;
use orogeny_store::{Entry, Error, Layer, Store};
use rusqlite::Connection;

use crate::support::{Scratch, bits, commit, contents, key, page};

/// A terrain with a few pages, one of them undone, closed; and all that it says.
struct Whole {
    scratch: Scratch,
    bytes: Vec<u8>,
    layers: Vec<Layer>,
    log: Vec<Entry>,
    pages: Vec<(PageKey, Vec<u32>)>,
}

impl Whole {
    fn new() -> Self {
        let scratch = Scratch::new();
        let mut store = scratch.create();
        for (x, z) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let key = key(&store, x, z);
            commit(&mut store, &[(key, page(10 * z + x))]);
        }
        let touched = key(&store, 0, 0);
        commit(&mut store, &[(touched, page(7))]);
        let undone = key(&store, 2, 2);
        commit(&mut store, &[(undone, page(9))]);
        store.undo(1).unwrap();
        let (layers, log) = (store.layers().to_vec(), store.log().unwrap());
        let pages = contents(&store, layers[0].heights);
        store.close().unwrap();
        let bytes = std::fs::read(scratch.path()).unwrap();
        Self { scratch, bytes, layers, log, pages }
    }

    fn sql(&self, sql: &str) {
        Connection::open(self.scratch.path()).unwrap().execute_batch(sql).unwrap();
    }

    fn open(&self) -> Store {
        Store::open(&self.scratch.path()).unwrap()
    }

    /// Replaces the file, with no log beside it.
    fn replace(&self, bytes: &[u8]) {
        for suffix in ["-wal", "-shm"] {
            std::fs::remove_file(self.scratch.folder().join(format!("terrain.orogeny{suffix}"))).ok();
        }
        std::fs::write(self.scratch.path(), bytes).unwrap();
    }

    /// Whether the damage in the file was seen, rather than changed nothing.
    fn is_damage_seen(&self, path: &Path) -> bool {
        let store = match Store::open(path) {
            Ok(store) => store,
            Err(
                Error::NotATerrain { .. }
                | Error::NewerVersion { .. }
                | Error::Damaged { .. }
                | Error::Io { .. }
                | Error::ReadOnly { .. },
            ) => return true,
            Err(err) => panic!("{err:?}"),
        };
        let reported = match store.check() {
            Ok(report) => !report.problems.is_empty(),
            Err(_) => true,
        };
        let mut is_same = store.layers() == self.layers && store.log().is_ok_and(|log| log == self.log);
        for (key, expected) in &self.pages {
            match store.load_page(key) {
                Ok(Some(page)) if bits(&page) == *expected => {}
                Ok(found) => {
                    assert!(reported, "{key:?} came back wrong ({}), and nothing says so", found.is_some());
                    is_same = false;
                }
                Err(_) => is_same = false,
            }
        }
        assert!(is_same || reported, "something differs, and the check says nothing");
        reported
    }
}

#[test]
fn a_damaged_page_is_named_and_the_others_are_not_concerned() {
    let whole = Whole::new();
    let (damaged, _) = whole.pages[1];
    whole.sql(&format!(
        "UPDATE page_data SET bytes = CAST(substr(bytes, 1, 40) || x'5a' || substr(bytes, 42) AS BLOB)
         WHERE id = (SELECT data FROM page WHERE z = {} AND x = {})",
        damaged.z, damaged.x
    ));
    let store = whole.open();
    let err = store.load_page(&damaged).unwrap_err();
    assert!(matches!(err, Error::DamagedPage { key, .. } if key == damaged), "{err}");
    let text = err.to_string();
    assert!(text.contains("column 1 row 0 of level 0 of field 1"), "{text}");
    for (key, expected) in whole.pages.iter().filter(|(key, _)| *key != damaged) {
        assert_eq!(bits(&store.load_page(key).unwrap().unwrap()), *expected);
    }
    let report = store.check().unwrap();
    assert!(
        matches!(report.problems.as_slice(), [Error::DamagedPage { key, .. }] if *key == damaged),
        "{:?}",
        report.problems
    );
}

#[test]
fn pages_in_each_others_place_are_seen() {
    let whole = Whole::new();
    whole.sql("UPDATE page SET data = 3 - data WHERE data IN (1, 2)");
    let store = whole.open();
    let damaged = whole.pages.iter().filter(|(key, _)| store.load_page(key).is_err()).count();
    assert_eq!(damaged, 2);
}

#[test]
fn missing_and_monstrous_bytes_are_refused() {
    for (sql, expected) in [
        ("PRAGMA foreign_keys = OFF; DELETE FROM page_data WHERE id = 1", "missing"),
        ("UPDATE page_data SET bytes = zeroblob(40000000) WHERE id = 1", "40000000 bytes"),
        ("UPDATE page_data SET bytes = x'' WHERE id = 1", "checksum"),
        ("UPDATE page SET codec = 300 WHERE data = 1", "300"),
        ("UPDATE page SET checksum = x'00' WHERE data = 1", "damaged"),
        ("UPDATE page SET revision = revision - 1 WHERE data = 1", "checksum"),
    ] {
        let whole = Whole::new();
        whole.sql(sql);
        let store = whole.open();
        let err = store.load_page(&whole.pages[0].0).unwrap_err();
        assert!(matches!(err, Error::DamagedPage { key, .. } if key == whole.pages[0].0), "{err}");
        assert!(err.to_string().contains(expected), "{err}");
        assert!(!store.check().unwrap().problems.is_empty());
    }
}

#[test]
fn a_lost_write_is_seen_by_the_check_and_by_undo() {
    // The page's rows as they were before the last change of it: content, checksum and revision fit each other.
    let whole = Whole::new();
    whole.open().undo(1).unwrap();
    whole.sql("CREATE TABLE old AS SELECT revision, codec, checksum, bytes FROM page JOIN page_data ON data = id WHERE data = 1");
    whole.open().redo(1).unwrap();
    whole.sql(
        "UPDATE page SET (revision, codec, checksum) = (SELECT revision, codec, checksum FROM old) WHERE data = 1;
         UPDATE page_data SET bytes = (SELECT bytes FROM old) WHERE id = 1;
         DROP TABLE old;",
    );
    let mut store = whole.open();
    let err = store.undo(1).unwrap_err();
    assert!(matches!(err, Error::DamagedPage { key, .. } if key == whole.pages[0].0), "{err}");
    assert!(err.to_string().contains("entry 1, the history wants that of entry 5"), "{err}");
    // What is above it was made of what was lost, and shows it too.
    let damaged = whole.pages[0].0;
    let report = store.check().unwrap();
    let keys = report.problems.iter().map(|problem| match problem {
        Error::DamagedPage { key, .. } => *key,
        other => panic!("{other}"),
    });
    assert_eq!(keys.collect::<Vec<_>>(), [damaged.parent(), damaged]);
}

#[test]
fn a_damaged_delta_stops_undo_before_anything_changes() {
    for (sql, place) in [
        ("UPDATE delta SET bytes = zeroblob(100) WHERE entry = 4", "column 1 row 1"),
        ("UPDATE delta SET bytes = zeroblob(40000000) WHERE entry = 4", "column 1 row 1"),
        ("DELETE FROM delta WHERE entry = 4", "entry 4"),
        ("UPDATE entry SET operation = '[]' WHERE id = 4", "entry 4"),
        ("UPDATE entry SET num_pages = 2 WHERE id = 4", "entry 4"),
        ("UPDATE entry SET parent = 4 WHERE id = 4", "entry 4"),
    ] {
        let whole = Whole::new();
        whole.sql(sql);
        let mut store = whole.open();
        // Two entries: the first would go well.
        let err = store.undo(2).unwrap_err();
        assert!(matches!(err, Error::DamagedHistory { entry, .. } if entry.0 == 4), "{err}");
        assert!(err.to_string().contains(place), "{err}");
        assert_eq!(contents(&store, whole.layers[0].heights), whole.pages);
        assert!(!store.check().unwrap().problems.is_empty(), "{sql}");
        // The last one can still be undone.
        assert_eq!(store.undo(1).unwrap().len(), 1);
    }
}

/// No checksum covers where redo leads.
#[test]
fn redo_goes_only_to_what_was_done_next() {
    for sql in ["UPDATE entry SET next = 6 WHERE id = 0", "UPDATE entry SET next = 0 WHERE id = 0"] {
        let whole = Whole::new();
        whole.open().undo(u32::MAX).unwrap();
        whole.sql(sql);
        let mut store = whole.open();
        let err = store.redo(u32::MAX).unwrap_err();
        assert!(matches!(err, Error::DamagedHistory { entry, .. } if entry.0 == 0), "{sql}: {err}");
        assert!(!store.check().unwrap().problems.is_empty(), "{sql}");
        assert!(contents(&store, whole.layers[0].heights).is_empty(), "{sql}");
    }
}

#[test]
fn painting_goes_on_over_a_budget_that_damage_keeps_the_history_from() {
    for sql in ["UPDATE entry SET author = 'x' WHERE id = 2", "UPDATE entry SET parent = 5 WHERE id = 2"] {
        let whole = Whole::new();
        let mut store = whole.open();
        let size = store.history_summary().unwrap().size_in_bytes;
        store.set_history_budget(Some(size)).unwrap();
        store.close().unwrap();
        whole.sql(sql);
        let mut store = whole.open();
        let at = key(&store, 3, 1);
        for seed in 30..33 {
            commit(&mut store, &[(at, page(seed))]);
        }
        assert_eq!(bits(&store.load_page(&at).unwrap().unwrap()), bits(&page(32)));
        assert!(store.history_summary().is_err() || store.history_summary().unwrap().size_in_bytes > size);
        assert!(!store.check().unwrap().problems.is_empty());
    }
}

#[test]
fn rows_that_say_what_the_terrain_is_are_checked() {
    for sql in [
        "UPDATE document SET width = width + 1",
        "UPDATE document SET spacing_m = 2",
        "UPDATE document SET width = -1",
        "PRAGMA foreign_keys = OFF; UPDATE document SET head = 4",
        "DELETE FROM document",
        "UPDATE field SET constant = 101",
        "PRAGMA foreign_keys = OFF; DELETE FROM field",
        "UPDATE layer SET state = replace(state, 'Base', 'Bass')",
        "DROP TABLE layer",
    ] {
        let whole = Whole::new();
        whole.sql(sql);
        let err = Store::open(&whole.scratch.path()).unwrap_err();
        assert!(matches!(err, Error::Damaged { .. }), "{sql}: {err}");
    }
    let whole = Whole::new();
    whole.sql("DELETE FROM layer");
    assert!(!whole.open().check().unwrap().problems.is_empty());
}

#[test]
fn a_file_cut_short_anywhere_is_seen() {
    let whole = Whole::new();
    let path = whole.scratch.path();
    let step = if std::env::var_os("OROGENY_TEST_LONG").is_some() { 1 } else { 1021 };
    let mut lengths: Vec<usize> = (0..whole.bytes.len()).step_by(step).collect();
    lengths.extend((8192..whole.bytes.len()).step_by(8192).flat_map(|edge| [edge - 1, edge, edge + 1]));
    assert!(lengths.len() > 50, "{}", lengths.len());
    for length in lengths {
        whole.replace(&whole.bytes[..length]);
        // The end of the last page of the database may be filling, of which nothing is missed.
        let may_be_filling = length > whole.bytes.len() - 8192;
        assert!(whole.is_damage_seen(&path) || may_be_filling, "cut to {length} of {}", whole.bytes.len());
    }
    whole.replace(&whole.bytes);
    assert!(!whole.is_damage_seen(&path), "the whole file counts as damaged");
}

#[test]
fn a_flipped_bit_is_seen_or_changes_nothing() {
    let whole = Whole::new();
    let path = whole.scratch.path();
    let num_flips = if std::env::var_os("OROGENY_TEST_LONG").is_some() { 10_000 } else { 250 };
    let mut state = 0x0bad_cafe_u64;
    let mut num_seen = 0;
    for _ in 0..num_flips {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let bit = (state >> 24) as usize % (whole.bytes.len() * 8);
        let mut bytes = whole.bytes.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        whole.replace(&bytes);
        num_seen += u32::from(whole.is_damage_seen(&path));
    }
    // Most of a file of few pages is free space and filling.
    assert!(num_seen > num_flips / 10, "{num_seen} of {num_flips} seen");
}
