//! One flipped bit in a page: it is named, the others read, and the history brings it back; without the history it is shown
//! coarser and the rest is saved.

use std::path::{Path, PathBuf};

use orogeny_engine::{Error, MapRequest, PageKey, Quiet, Terrain};
use orogeny_store::{Error as StoreError, Store};
use orogeny_tests::Random;
use orogeny_tests::child::is_long;
use rusqlite::{Connection, params};
use serde_json::json;

use crate::support::{
    Heights, apply, assert_same_heights, assert_whole, create, heights, operation, settings, stroke,
};

/// A closed terrain with hills all over it.
fn painted(folder: &Path) -> (PathBuf, Heights) {
    let path = folder.join("t.orogeny");
    let mut terrain = create(&path);
    let hills = operation(json!({
        "op": "stroke",
        "brush": {"type": "raise", "radius": 150, "strength": 40},
        "points": [[100, 100], [600, 150], [300, 450]],
    }));
    apply(&mut terrain, &[hills]);
    apply(&mut terrain, &(1..=12).map(stroke).collect::<Vec<_>>());
    terrain.close().unwrap();
    let before = heights(&path);
    (path, before)
}

/// Flips one bit of a page as it is stored.
fn flip(path: &Path, key: &PageKey, random: &mut Random) {
    let db = Connection::open(path).unwrap();
    let place = params![key.field.0, key.level, key.z, key.x];
    let sql = "SELECT data FROM page WHERE field = ?1 AND level = ?2 AND z = ?3 AND x = ?4";
    let data: i64 = db.query_row(sql, place, |row| row.get(0)).unwrap();
    let sql = "SELECT bytes FROM page_data WHERE id = ?1";
    let mut bytes: Vec<u8> = db.query_row(sql, [data], |row| row.get(0)).unwrap();
    let bit = random.bits() as usize % (bytes.len() * 8);
    bytes[bit / 8] ^= 1 << (bit % 8);
    let num_changed =
        db.execute("UPDATE page_data SET bytes = ?2 WHERE id = ?1", params![data, bytes]).unwrap();
    assert_eq!(num_changed, 1);
    db.close().unwrap();
}

/// The check names the page and no other, and the others read as before.
fn assert_only_this_is_damaged(path: &Path, damaged: &PageKey, before: &Heights) {
    let report = Terrain::check(path).unwrap();
    let [problem @ StoreError::DamagedPage { key, .. }] = report.problems.as_slice() else {
        panic!("{damaged:?}: {:#?}", report.problems);
    };
    assert_eq!(key, damaged);
    let PageKey { field, level, z, x } = key;
    let place = format!("the page at column {x} row {z} of level {level} of field {} is damaged", field.0);
    assert!(problem.to_string().starts_with(&place), "{problem}");
    let store = Store::open_to_read(path).unwrap();
    for (key, bits) in before {
        match store.load_page(key) {
            Ok(page) => assert!(page.unwrap().samples().iter().map(|h| h.to_bits()).eq(bits.iter().copied())),
            Err(StoreError::DamagedPage { key: named, .. }) => assert_eq!((key, &named), (damaged, damaged)),
            Err(err) => panic!("{err}"),
        }
    }
}

#[test]
fn a_flipped_bit_is_named_and_the_history_brings_the_page_back() {
    let folder = tempfile::tempdir().unwrap();
    let (path, before) = painted(folder.path());
    let mut random = Random::new(0x05ee_d004);
    let num_rounds = if is_long() { 10 } else { 1 };
    let (mut num_from_history, mut num_from_below) = (0, 0);
    for key in (0..num_rounds).flat_map(|_| before.keys()) {
        flip(&path, key, &mut random);
        assert_only_this_is_damaged(&path, key, &before);
        let repaired = Terrain::repair(&path).unwrap();
        assert!(repaired.lost_pages.is_empty() && repaired.lost_commits.is_none(), "{repaired:?}");
        if key.level == 0 {
            assert_eq!(repaired.pages_from_history, [*key]);
            num_from_history += 1;
        } else {
            assert!(repaired.pages_from_history.is_empty() && repaired.levels_made_anew, "{repaired:?}");
            num_from_below += 1;
        }
        assert_same_heights(&heights(&path), &before);
        assert_whole(&path);
    }
    println!(
        "{num_from_history} pages brought back from the history, {num_from_below} from those below them"
    );
    assert!(num_from_history >= 6 && num_from_below >= 2);
    // All of the history can still be gone through.
    let mut terrain = Terrain::open(&path, settings()).unwrap();
    assert_eq!(terrain.undo(u32::MAX).unwrap().len(), 13);
    assert_eq!(terrain.redo(13).unwrap().len(), 13);
    terrain.close().unwrap();
    assert_same_heights(&heights(&path), &before);
}

#[test]
fn without_its_history_a_flipped_page_is_shown_coarser_and_the_rest_is_saved() {
    let mut random = Random::new(0x05ee_d005);
    let (mut num_lost, mut num_saved) = (0, 0);
    let folder = tempfile::tempdir().unwrap();
    let (whole, before) = painted(folder.path());
    let mut terrain = Terrain::open(&whole, settings()).unwrap();
    assert_eq!(terrain.set_history_budget(Some(0)).unwrap().entries.len(), 13);
    terrain.close().unwrap();
    let num_pages = before.keys().filter(|key| key.level == 0).count();
    for key in before.keys().filter(|key| key.level == 0) {
        let path = folder.path().join("damaged.orogeny");
        std::fs::copy(&whole, &path).unwrap();
        flip(&path, key, &mut random);
        let repaired = Terrain::repair(&path).unwrap();
        assert_eq!((repaired.lost_pages, repaired.pages_from_history), (vec![*key], Vec::new()));
        assert_only_this_is_damaged(&path, key, &before);
        num_lost += 1;

        // The map is drawn of full resolution, but for that page.
        let terrain = Terrain::open(&path, settings()).unwrap();
        let request = MapRequest::new(folder.path().join("map.png"));
        let map = terrain.draw_map(&request, &mut Quiet).unwrap();
        let notice = format!(
            "the page at column {} row {} of level 0 is damaged; a coarser level is shown, or the bare ground",
            key.x, key.z
        );
        assert_eq!((map.level, map.notices), (0, vec![notice]));
        // What is no picture is not made up.
        let inside_m = [f64::from(key.x) * 256.0 + 4.0, f64::from(key.z) * 256.0 + 4.0];
        let err = terrain.height_m(inside_m).unwrap_err();
        assert!(
            matches!(err, Error::Store(StoreError::DamagedPage { key: named, .. }) if named == *key),
            "{err}"
        );
        terrain.close().unwrap();

        let saved = folder.path().join("saved.orogeny");
        let salvaged = Terrain::salvage(&path, &saved).unwrap();
        assert_eq!(salvaged.num_whole_pages, num_pages as u64 - 1);
        assert_eq!(salvaged.pages_from_coarser_levels, [(*key, 1)]);
        assert!(salvaged.lost_pages.is_empty() && salvaged.problems.is_empty(), "{salvaged:?}");
        assert_whole(&saved);
        let after = heights(&saved);
        for (key, bits) in before.iter().filter(|(other, _)| other.level == 0 && *other != key) {
            assert!(after[key] == *bits, "{key:?}");
        }
        assert_is_near(&after[key], &before[key]);
        num_saved += after.keys().filter(|key| key.level == 0).count();
        std::fs::remove_file(&saved).unwrap();
    }
    println!("{num_lost} pages lost and named, {num_saved} saved, {num_lost} of them coarser");
    assert!(num_lost >= 6 && num_saved == num_lost * num_pages);
}

/// A coarser version is smooth where the ground was rough; on the whole it is the same hills.
fn assert_is_near(found: &[u32], expected: &[u32]) {
    let metres = |bits: &u32| f64::from(f32::from_bits(*bits));
    let off_m = found.iter().zip(expected).map(|(a, b)| (metres(a) - metres(b)).abs()).sum::<f64>();
    let mean_m = off_m / found.len() as f64;
    assert!(mean_m < 1.0, "{mean_m} m off on average");
    assert!(found != expected, "nothing was coarser");
}
