//! Files of older versions, brought up to date: everything that was there stays as it was, or nothing is changed.

use orogeny_field::{HeightBounds, PageKey, SampleRect};
use orogeny_store::{Entry, EntryId, EntryState, Error, Store, format};
use rusqlite::Connection;
use rusqlite::types::Value;

use crate::support::{Scratch, assert_whole, bits, contents, error_of};

/// What the fixture is: `tests/fixtures/README.md`.
const VERSION_1: &[u8] = include_bytes!("../fixtures/version-1.orogeny.zst");

const VERSION_2: &[u8] = include_bytes!("../fixtures/version-2.orogeny.zst");

/// Hash of the heights that the program which wrote it exported.
const HEIGHTS_BLAKE3: &str = "5188ee17f64214688740d24f6243e6c76158c2c7c970b66c07ce8cb378578c8b";

fn fixture(packed: &[u8]) -> Scratch {
    let scratch = Scratch::new();
    std::fs::write(scratch.path(), zstd::stream::decode_all(packed).unwrap()).unwrap();
    scratch
}

fn version_1() -> Scratch {
    fixture(VERSION_1)
}

fn sql(scratch: &Scratch) -> Connection {
    Connection::open(scratch.path()).unwrap()
}

fn version(scratch: &Scratch) -> i32 {
    sql(scratch).query_row("PRAGMA user_version", [], |row| row.get(0)).unwrap()
}

fn upgraded(scratch: &Scratch) -> Store {
    Store::open(&scratch.path()).unwrap()
}

/// Every row of every table, and the schema, as SQLite has them.
fn rows(scratch: &Scratch) -> Vec<Vec<Value>> {
    let conn = sql(scratch);
    let all = |query: &str| {
        let mut statement = conn.prepare(query).unwrap();
        let num_columns = statement.column_count();
        let row = |row: &rusqlite::Row<'_>| (0..num_columns).map(|column| row.get(column)).collect();
        statement.query_map([], row).unwrap().collect::<Result<Vec<Vec<Value>>, _>>().unwrap()
    };
    let mut rows = all("SELECT name, sql FROM sqlite_schema ORDER BY name");
    for table in all("SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY name") {
        let [Value::Text(table)] = table.as_slice() else { panic!("{table:?}") };
        rows.extend(all(&format!("SELECT * FROM {table} ORDER BY 1, 2")));
    }
    rows
}

/// The heights of the only layer, as `.r32` holds them, hashed.
fn heights_blake3(store: &Store) -> String {
    let (layout, bounds, layer) = (store.layout(), store.grid().bounds(), &store.layers()[0]);
    let mut heights = vec![layer.constant_m; (bounds.width() * bounds.depth()) as usize];
    for (x, z) in layout.pages_in(bounds) {
        let key = PageKey::full_resolution(layer.heights, x, z);
        let Some(page) = store.load_page(&key).unwrap() else { continue };
        let rect = layout.page_rect(&key);
        let inside = rect.intersection(&bounds);
        for z in inside.z0..inside.z1 {
            let row = page.row(z.abs_diff(rect.z0), 0, inside.width()).unwrap();
            let start = (z * bounds.x1 + inside.x0) as usize;
            heights[start..start + row.len()].copy_from_slice(row);
        }
    }
    let bytes: Vec<u8> = heights.into_iter().flat_map(f32::to_le_bytes).collect();
    blake3::hash(&bytes).to_hex().to_string()
}

/// What the log says, without what follows from it.
fn told(log: &[Entry]) -> Vec<(u32, String, EntryState)> {
    log.iter().map(|entry| (entry.id.0, entry.operation_json.clone(), entry.state)).collect()
}

#[test]
fn heights_and_log_stay_and_what_is_new_is_there() {
    let scratch = version_1();
    let operations: Vec<String> = sql(&scratch)
        .prepare("SELECT operation FROM entry WHERE id > 0 ORDER BY id")
        .unwrap()
        .query_map([], |row| row.get(0))
        .unwrap()
        .collect::<Result<_, _>>()
        .unwrap();
    let store = upgraded(&scratch);
    assert_eq!(heights_blake3(&store), HEIGHTS_BLAKE3);
    assert_whole(&store);

    use EntryState::{Applied, Branch, Undone};
    let states = [Applied, Applied, Applied, Applied, Branch, Applied, Applied, Undone];
    let expected = (1..).zip(operations).zip(states).map(|((id, operation), state)| (id, operation, state));
    assert_eq!(told(&store.log().unwrap()), expected.collect::<Vec<_>>());
    let history = store.history_summary().unwrap();
    assert!(history.size_in_bytes > 90_000, "{history:?}");
    assert_eq!(history.budget_in_bytes, None);

    let field = store.layers()[0].heights;
    let coarse = PageKey { field, level: 1, z: 0, x: 0 };
    let pages = contents(&store, field);
    let keys: Vec<_> = pages.iter().map(|(key, _)| *key).collect();
    assert_eq!(keys, [PageKey::full_resolution(field, 0, 0), PageKey::full_resolution(field, 1, 0), coarse]);
    let bounds_of = |key: &PageKey| {
        let page = store.load_page(key).unwrap().unwrap();
        let rect: SampleRect = store.layout().page_rect(key);
        let inside = rect.intersection(&store.grid().bounds());
        let row = |z: i32| page.row(z.abs_diff(rect.z0), 0, inside.width());
        let rows = (inside.z0..inside.z1).map(|z| HeightBounds::of_row(row(z).unwrap()).unwrap());
        rows.reduce(HeightBounds::with).unwrap()
    };
    let (west, east) = (bounds_of(&keys[0]), bounds_of(&keys[1]));
    assert_eq!(store.page_bounds(&keys[0]).unwrap(), Some(west));
    assert_eq!(store.page_bounds(&keys[1]).unwrap(), Some(east));
    assert_eq!(store.page_bounds(&coarse).unwrap(), Some(west.with(east)));
    store.close().unwrap();
    assert_eq!((version(&scratch), scratch.files().len()), (format::FORMAT_VERSION, 1));
}

#[test]
fn a_file_of_version_2_keeps_its_pages_and_gets_the_errors_of_coarse_ones() {
    let scratch = fixture(VERSION_2);
    assert_eq!(version(&scratch), 2);
    let store = upgraded(&scratch);
    assert_eq!(heights_blake3(&store), HEIGHTS_BLAKE3);
    assert_whole(&store);
    let field = store.layers()[0].heights;
    let coarse = PageKey { field, level: 1, z: 0, x: 0 };
    let error_m = error_of(&store, &coarse);
    assert!(error_m > Some(1.0), "{error_m:?}");
    assert_eq!(error_of(&store, &PageKey::full_resolution(field, 1, 0)), Some(0.0));
    let pages = contents(&store, field);
    store.close().unwrap();
    assert_eq!(version(&scratch), format::FORMAT_VERSION);

    let from_version_1 = version_1();
    let store = upgraded(&from_version_1);
    assert_eq!(contents(&store, field), pages);
    assert_eq!(error_of(&store, &coarse), error_m);
}

#[test]
fn what_is_damaged_in_a_file_of_version_2_stays_so_and_is_mended_as_ever() {
    let scratch = fixture(VERSION_2);
    sql(&scratch).execute_batch("UPDATE page SET checksum = x'00' WHERE level = 0 AND x = 1").unwrap();
    let store = upgraded(&scratch);
    let field = store.layers()[0].heights;
    let damaged = PageKey::full_resolution(field, 1, 0);
    assert!(matches!(store.load_page(&damaged), Err(Error::DamagedPage { .. })));
    // What is left of it is still there, and counts as being as far off as it is high.
    let coarse = PageKey { field, level: 1, z: 0, x: 0 };
    assert!(store.load_page(&coarse).unwrap().is_some());
    let bounds = store.page_bounds(&coarse).unwrap().unwrap();
    assert_eq!(error_of(&store, &coarse), Some(bounds.max_m - bounds.min_m));
    store.close().unwrap();
    assert_eq!(Store::repair(&scratch.path()).unwrap().pages_from_history, [damaged]);
    let store = Store::open_to_read(&scratch.path()).unwrap();
    assert_whole(&store);
    assert!(error_of(&store, &coarse) < Some(bounds.max_m - bounds.min_m));
}

#[test]
fn its_history_goes_to_the_start_to_branches_and_back() {
    let scratch = version_1();
    let mut store = upgraded(&scratch);
    let undone: Vec<_> = store.undo(u32::MAX).unwrap().iter().map(|change| change.entry.0).collect();
    assert_eq!(undone, [7, 6, 4, 3, 2, 1]);
    let field = store.layers()[0].heights;
    assert!(store.page_keys(field).unwrap().is_empty());
    assert_whole(&store);
    assert_eq!(store.redo(6).unwrap().len(), 6);
    assert_eq!(heights_blake3(&store), HEIGHTS_BLAKE3);
    for target in [5, 8, 0, 7] {
        store.jump(EntryId(target)).unwrap();
        assert_eq!(heights_blake3(&store) == HEIGHTS_BLAKE3, target == 7, "entry {target}");
        assert_whole(&store);
    }
}

#[test]
fn opening_again_changes_nothing() {
    let scratch = version_1();
    upgraded(&scratch).close().unwrap();
    let bytes = std::fs::read(scratch.path()).unwrap();
    let store = upgraded(&scratch);
    let pages = contents(&store, store.layers()[0].heights);
    store.close().unwrap();
    assert!(std::fs::read(scratch.path()).unwrap() == bytes, "opening it again changed the file");
    let reader = Store::open_to_read(&scratch.path()).unwrap();
    assert_eq!(contents(&reader, reader.layers()[0].heights), pages);
}

#[test]
fn opening_for_reading_says_what_to_do_and_changes_nothing() {
    let scratch = version_1();
    let bytes = std::fs::read(scratch.path()).unwrap();
    let err = Store::open_to_read(&scratch.path()).unwrap_err();
    assert!(matches!(err, Error::OlderVersion { version: 1, current: format::FORMAT_VERSION, .. }), "{err}");
    assert!(err.to_string().contains("open it for writing once"), "{err}");
    assert_eq!((std::fs::read(scratch.path()).unwrap() == bytes, scratch.files().len()), (true, 1));
}

#[test]
fn an_upgrade_that_fails_leaves_version_1_and_works_once_the_damage_is_mended() {
    let damages = [
        ("UPDATE field SET constant = 11", "field 1"),
        ("UPDATE document SET width = 301", "checksum"),
        ("DELETE FROM document", "damaged"),
    ];
    for (damage, place) in damages {
        let scratch = version_1();
        let whole = std::fs::read(scratch.path()).unwrap();
        sql(&scratch).execute_batch(damage).unwrap();
        let before = rows(&scratch);
        let err = Store::open(&scratch.path()).unwrap_err();
        assert!(matches!(err, Error::Damaged { .. }), "{damage}: {err}");
        assert!(err.to_string().contains(place), "{damage}: {err}");
        assert_eq!(scratch.files(), ["terrain.orogeny"], "{damage}");
        assert_eq!(version(&scratch), 1, "{damage}");
        assert!(rows(&scratch) == before, "{damage}: its rows changed");
        std::fs::write(scratch.path(), whole).unwrap();
        assert_eq!(heights_blake3(&upgraded(&scratch)), HEIGHTS_BLAKE3);
    }
}

#[test]
fn a_damaged_page_stays_one_and_is_made_again_from_the_history() {
    for damage in [
        "UPDATE page_data SET bytes = CAST(bytes || x'00' AS BLOB) WHERE id = 2",
        "UPDATE page_data SET bytes = zeroblob(40000000) WHERE id = 2",
        "UPDATE page SET revision = 6 WHERE data = 2",
        "UPDATE page SET checksum = x'00' WHERE data = 2",
        "PRAGMA foreign_keys = OFF; DELETE FROM page_data WHERE id = 2",
    ] {
        let scratch = version_1();
        sql(&scratch).execute_batch(damage).unwrap();
        let saved = scratch.folder().join("saved.orogeny");
        let salvaged = Store::salvage(&scratch.path(), &saved).unwrap();
        assert_eq!((salvaged.num_whole_pages, salvaged.pages_from_history.len()), (1, 1), "{damage}");
        assert_eq!((version(&scratch), scratch.files().len()), (1, 2), "{damage}: the original was changed");
        assert_eq!(heights_blake3(&Store::open_to_read(&saved).unwrap()), HEIGHTS_BLAKE3, "{damage}");

        let store = Store::open(&scratch.path()).unwrap();
        let key = PageKey::full_resolution(store.layers()[0].heights, 1, 0);
        assert!(matches!(store.load_page(&key), Err(Error::DamagedPage { key: named, .. }) if named == key));
        assert!(store.load_page(&PageKey { x: 0, ..key }).unwrap().is_some(), "{damage}");
        store.close().unwrap();
        assert_eq!(Store::repair(&scratch.path()).unwrap().pages_from_history, [key], "{damage}");
        let store = Store::open_to_read(&scratch.path()).unwrap();
        assert_whole(&store);
        assert_eq!(heights_blake3(&store), HEIGHTS_BLAKE3, "{damage}");
    }
}

#[test]
fn a_file_cut_short_is_refused_and_stays_as_it_is() {
    let scratch = version_1();
    let whole = std::fs::read(scratch.path()).unwrap();
    let lengths = (1..whole.len()).step_by(8192).chain([whole.len() - 8192, whole.len() - 1]);
    let mut num_refused = 0;
    for length in lengths {
        std::fs::write(scratch.path(), &whole[..length]).unwrap();
        let err = match Store::open(&scratch.path()) {
            Err(err) => err,
            // What was cut off belonged to pages of the terrain alone.
            Ok(store) => {
                let problems = store.check().unwrap().problems;
                let is_named = problems.iter().any(|problem| matches!(problem, Error::DamagedPage { .. }));
                assert!(is_named, "cut to {length} bytes: {problems:?}");
                continue;
            }
        };
        let is_seen =
            matches!(err, Error::NotATerrain { .. } | Error::Damaged { .. } | Error::DamagedPage { .. });
        assert!(is_seen, "cut to {length} bytes: {err}");
        assert!(
            std::fs::read(scratch.path()).unwrap() == whole[..length],
            "cut to {length} bytes, then changed"
        );
        num_refused += 1;
    }
    assert!(num_refused > 40, "{num_refused}");
}

#[test]
fn a_wrong_height_would_be_seen() {
    let scratch = version_1();
    let mut store = upgraded(&scratch);
    let key = PageKey::full_resolution(store.layers()[0].heights, 1, 0);
    let mut page = store.load_page(&key).unwrap().unwrap().as_ref().clone();
    page.samples_mut()[0] = f32::from_bits(bits(&page)[0] ^ 1);
    let mut transaction = store.begin().unwrap();
    transaction.write_pages(&[(key, page)]).unwrap();
    transaction.commit("{}", "test").unwrap();
    assert_ne!(heights_blake3(&store), HEIGHTS_BLAKE3);
}
