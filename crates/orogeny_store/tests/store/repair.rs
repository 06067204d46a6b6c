//! What is left of a damaged terrain: made whole from the history, shown from a coarser level, or saved into a new one.

use std::collections::BTreeMap;

use orogeny_field::{Page, PageKey, TerrainGrid};
use orogeny_store::{Error, Field, FieldKind, NewTerrain, Repaired, Store};
use rusqlite::Connection;

use crate::support::{Scratch, assert_whole, bits, commit, contents, key, layer, layout, page};

/// A closed terrain with every page painted, one of them three times, one undone and one left behind.
fn painted(scratch: &Scratch) -> (PageKey, Vec<(PageKey, Vec<u32>)>) {
    let mut store = scratch.create();
    for (z, x) in (0..3).flat_map(|z| (0..5).map(move |x| (z, x))) {
        let at = key(&store, x, z);
        commit(&mut store, &[(at, page(10 * z + x))]);
    }
    let at = key(&store, 2, 1);
    commit(&mut store, &[(at, page(70))]);
    commit(&mut store, &[(at, page(71))]);
    store.undo(1).unwrap();
    commit(&mut store, &[(at, page(72))]);
    commit(&mut store, &[(at, page(73))]);
    store.undo(1).unwrap();
    let shown = contents(&store, at.field);
    store.close().unwrap();
    (at, shown)
}

fn sql(scratch: &Scratch, sql: &str) {
    Connection::open(scratch.path()).unwrap().execute_batch(sql).unwrap();
}

fn damage(scratch: &Scratch, key: &PageKey) {
    let PageKey { field, level, z, x } = key;
    let place = format!("field = {} AND level = {level} AND z = {z} AND x = {x}", field.0);
    sql(
        scratch,
        &format!(
            "UPDATE page_data SET bytes = CAST(substr(bytes, 1, 60) || x'5a5b' || substr(bytes, 63) AS BLOB)
             WHERE id = (SELECT data FROM page WHERE {place})"
        ),
    );
}

#[test]
fn a_damaged_page_is_made_again_from_the_history() {
    let scratch = Scratch::new();
    let (at, shown) = painted(&scratch);
    damage(&scratch, &at);
    assert_eq!(Store::check_file(&scratch.path()).unwrap().problems.len(), 1);
    let repaired = Store::repair(&scratch.path()).unwrap();
    assert_eq!(repaired, Repaired { pages_from_history: vec![at], ..Repaired::default() });
    let mut store = Store::open(&scratch.path()).unwrap();
    assert_eq!(contents(&store, at.field), shown);
    assert_whole(&store);
    assert_eq!(store.undo(u32::MAX).unwrap().len(), 17);
    assert!(contents(&store, at.field).is_empty());
    // There is nothing to do twice.
    store.close().unwrap();
    assert_eq!(Store::repair(&scratch.path()).unwrap(), Repaired::default());
}

#[test]
fn damaged_coarser_levels_are_made_again_from_what_is_below() {
    let scratch = Scratch::new();
    let (at, shown) = painted(&scratch);
    for above in [at.parent(), at.parent().parent(), at.parent().parent().parent()] {
        damage(&scratch, &above);
    }
    let store = Store::open(&scratch.path()).unwrap();
    // What they are made of is not concerned.
    assert!(store.load_page(&at).is_ok());
    assert!(matches!(store.load_page(&at.parent()), Err(Error::DamagedPage { .. })));
    drop(store);
    let repaired = Store::repair(&scratch.path()).unwrap();
    assert_eq!(repaired, Repaired { levels_made_anew: true, ..Repaired::default() });
    let store = Store::open(&scratch.path()).unwrap();
    assert_eq!(contents(&store, at.field), shown);
    assert_whole(&store);
}

#[test]
fn painting_beside_damage_and_above_it_goes_on() {
    let scratch = Scratch::new();
    let (at, _) = painted(&scratch);
    damage(&scratch, &at);
    damage(&scratch, &at.parent());
    let mut store = Store::open(&scratch.path()).unwrap();
    let beside = PageKey { x: at.x + 1, ..at };
    commit(&mut store, &[(beside, page(90))]);
    assert_eq!(bits(&store.load_page(&beside).unwrap().unwrap()), bits(&page(90)));
    // The damaged page itself is refused.
    let mut transaction = store.begin().unwrap();
    let err = transaction.write_pages(&[(at, page(91))]).unwrap_err();
    assert!(matches!(err, Error::DamagedPage { key, .. } if key == at), "{err}");
    drop(transaction);
    store.close().unwrap();
    let repaired = Store::repair(&scratch.path()).unwrap();
    assert_eq!(repaired.pages_from_history, [at]);
    assert_whole(&Store::open(&scratch.path()).unwrap());
}

#[test]
fn without_its_history_a_page_is_lost_and_shown_from_afar() {
    let scratch = Scratch::new();
    let (at, shown) = painted(&scratch);
    let mut store = Store::open(&scratch.path()).unwrap();
    store.set_history_budget(Some(0)).unwrap();
    let coarse = store.load_page(&at.parent()).unwrap().unwrap();
    store.close().unwrap();
    damage(&scratch, &at);
    let repaired = Store::repair(&scratch.path()).unwrap();
    assert_eq!(repaired, Repaired { lost_pages: vec![at], ..Repaired::default() });
    let store = Store::open_to_read(&scratch.path()).unwrap();
    let (shown_page, level) = store.load_page_or_coarser(&at).unwrap();
    let shown_page = shown_page.unwrap();
    assert_eq!(level, 1);
    // Column 128 row 64 of the terrain lies on column 64 row 32 of the next level, in its second page.
    let coarse_origin = (at.x % 2 * 32, at.z % 2 * 32);
    for (z, x) in [(0, 0), (2, 0), (0, 2), (10, 20), (62, 62)] {
        let expected =
            coarse.row(coarse_origin.1 + z / 2, coarse_origin.0 + x / 2, coarse_origin.0 + x / 2 + 1);
        assert_eq!(shown_page.row(z, x, x + 1), expected, "({x}, {z})");
    }
    // Whole pages are what they are.
    let (other, expected) = &shown[0];
    let (page, level) = store.load_page_or_coarser(other).unwrap();
    assert_eq!((bits(&page.unwrap()), level), (expected.clone(), 0));

    let to = scratch.folder().join("saved.orogeny");
    let salvaged = Store::salvage(&scratch.path(), &to).unwrap();
    assert_eq!((salvaged.num_whole_pages, salvaged.lost_pages.len()), (14, 0));
    assert_eq!(salvaged.pages_from_coarser_levels, [(at, 1)]);
    let saved = Store::open(&to).unwrap();
    let found: BTreeMap<_, _> =
        contents(&saved, at.field).into_iter().filter(|(key, _)| key.level == 0).collect();
    for (key, expected) in shown.iter().filter(|(key, _)| key.level == 0 && *key != at) {
        assert_eq!(&found[key], expected);
    }
    assert_eq!(found[&at], bits(&shown_page));
    assert_whole(&saved);
}

/// A lost page under a damaged one: what is left of both is two levels up, and stays there.
#[test]
fn repair_never_takes_what_is_left_of_a_lost_page() {
    let scratch = Scratch::new();
    let (at, _) = painted(&scratch);
    let mut store = Store::open(&scratch.path()).unwrap();
    store.set_history_budget(Some(0)).unwrap();
    store.close().unwrap();
    damage(&scratch, &at);
    damage(&scratch, &at.parent());
    let store = Store::open_to_read(&scratch.path()).unwrap();
    let (shown, level) = store.load_page_or_coarser(&at).unwrap();
    let shown = shown.unwrap();
    assert_eq!(level, 2);
    drop(store);
    for round in 0..2 {
        let repaired = Store::repair(&scratch.path()).unwrap();
        assert_eq!(repaired, Repaired { lost_pages: vec![at], ..Repaired::default() });
        // Painting beside it takes nothing either.
        let mut store = Store::open(&scratch.path()).unwrap();
        let beside = PageKey { z: at.z - 1, ..at };
        commit(&mut store, &[(beside, page(90 + round))]);
        let (still_shown, level) = store.load_page_or_coarser(&at).unwrap();
        assert_eq!(level, 2);
        // Two rows of it are made of what was painted beside it.
        let interior = |page: &Page| page.row(32, 8, 56).unwrap().to_vec();
        assert_eq!(interior(&still_shown.unwrap()), interior(&shown));
        let damaged: Vec<_> = store
            .check()
            .unwrap()
            .problems
            .into_iter()
            .map(|problem| match problem {
                Error::DamagedPage { key, .. } => key,
                other => panic!("{other}"),
            })
            .collect();
        assert_eq!(damaged, [at, at.parent()]);
        store.close().unwrap();
    }
}

/// From afar, ground that was painted beside damage is seen as painted, or as damaged: never as bare.
#[test]
fn fresh_ground_beside_damage_is_not_shown_as_bare_from_afar() {
    for reaches_beyond_its_edge in [false, true] {
        let scratch = Scratch::new();
        let mut store = scratch.create();
        let (damaged, fresh) = (key(&store, 1, 0), key(&store, 2, 0));
        let mut ground = Page::constant(layout(), 100.0);
        ground.samples_mut()[20] = 300.0;
        // The page above the fresh one is there already, or not.
        ground.samples_mut()[63] = if reaches_beyond_its_edge { 500.0 } else { 100.0 };
        commit(&mut store, &[(damaged, ground)]);
        store.close().unwrap();
        damage(&scratch, &damaged);
        let mut store = Store::open(&scratch.path()).unwrap();
        commit(&mut store, &[(fresh, page(2))]);
        assert_eq!(bits(&store.load_page(&fresh).unwrap().unwrap()), bits(&page(2)));
        // Its first column reads the damaged page.
        let above = fresh.parent();
        let shown = store.load_page(&above);
        if reaches_beyond_its_edge {
            let row = shown.unwrap().unwrap().row(10, 0, 32).unwrap().to_vec();
            assert!(row.iter().skip(1).all(|height_m| *height_m != 100.0), "{row:?}");
        } else {
            assert!(matches!(shown, Err(Error::DamagedPage { key, .. }) if key == above));
        }
        store.close().unwrap();
        let repaired = Store::repair(&scratch.path()).unwrap();
        assert_eq!(repaired.pages_from_history, [damaged]);
        let store = Store::open(&scratch.path()).unwrap();
        assert!(store.load_page(&above).unwrap().is_some());
        assert_whole(&store);
    }
}

#[test]
fn a_wrong_sum_of_the_history_is_put_right() {
    let scratch = Scratch::new();
    painted(&scratch);
    sql(&scratch, "DELETE FROM delta WHERE entry = 17");
    assert!(!Store::check_file(&scratch.path()).unwrap().problems.is_empty());
    Store::repair(&scratch.path()).unwrap();
    // The delta is gone for good, and named; the sum fits again.
    let problems = Store::check_file(&scratch.path()).unwrap().problems;
    assert!(
        !problems.is_empty() && problems.iter().all(|p| !p.to_string().contains("its history takes")),
        "{problems:?}"
    );
}

#[test]
fn what_is_left_of_a_badly_damaged_terrain_is_saved_layer_by_layer() {
    let scratch = Scratch::new();
    let grid = TerrainGrid::new(300, 150, 2.0).unwrap();
    let new = NewTerrain { grid, layout: layout(), layers: vec![layer("Base", 100.0), layer("Top", -3.0)] };
    let mut store = Store::create(&scratch.path(), &new).unwrap();
    let mut transaction = store.begin().unwrap();
    let mask = transaction.add_field(Field { kind: FieldKind::Mask, constant: 1.0 }).unwrap();
    let mut top = transaction.layers()[1].clone();
    (top.mask, top.opacity, top.visible) = (Some(mask), 0.25, false);
    transaction.set_layer(&top).unwrap();
    let keys = [top.heights, mask].map(|field| PageKey::full_resolution(field, 1, 1));
    transaction.write_pages(&[(keys[0], page(1)), (keys[1], Page::constant(layout(), 0.5))]).unwrap();
    transaction.commit("{}", "test").unwrap();
    store.close().unwrap();
    sql(
        &scratch,
        "UPDATE document SET last_layer = 77; UPDATE field SET constant = 101 WHERE constant = 100;
         UPDATE layer SET state = replace(state, 'Base', 'Bass'); DELETE FROM delta; DELETE FROM entry WHERE id > 5;",
    );
    assert!(Store::open_to_read(&scratch.path()).is_err());
    let to = scratch.folder().join("saved.orogeny");
    let salvaged = Store::salvage(&scratch.path(), &to).unwrap();
    assert_eq!((salvaged.num_whole_pages, salvaged.problems.len()), (2, 3), "{:?}", salvaged.problems);
    let saved = Store::open(&to).unwrap();
    assert_eq!((saved.grid(), saved.layout()), (grid, layout()));
    let [base, saved_top] = saved.layers() else { panic!("{:?}", saved.layers()) };
    assert_eq!((base.name.as_str(), base.constant_m), ("Bass", 101.0));
    assert_eq!((saved_top.name.as_str(), saved_top.opacity, saved_top.visible), ("Top", 0.25, false));
    assert_eq!(
        bits(&saved.load_page(&PageKey::full_resolution(saved_top.heights, 1, 1)).unwrap().unwrap()),
        bits(&page(1))
    );
    let saved_mask = PageKey::full_resolution(saved_top.mask.unwrap(), 1, 1);
    assert_eq!(saved.load_page(&saved_mask).unwrap().as_deref(), Some(&Page::constant(layout(), 0.5)));
    assert_whole(&saved);
    // Never over something that is there.
    assert!(matches!(Store::salvage(&scratch.path(), &to), Err(Error::Exists { .. })));
}

#[test]
fn layers_are_changed_and_changed_back() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let before = store.layers().to_vec();
    let mut changed = before[0].clone();
    (changed.name, changed.opacity) = ("Ground".to_owned(), 0.5);
    let mut transaction = store.begin().unwrap();
    transaction.set_layer(&changed).unwrap();
    changed.visible = false;
    transaction.set_layer(&changed).unwrap();
    let mask = transaction.add_field(Field { kind: FieldKind::Selection, constant: 0.0 }).unwrap();
    let masked = orogeny_store::Layer { mask: Some(mask), ..changed.clone() };
    assert!(matches!(transaction.set_layer(&masked), Err(Error::UnknownField { .. })));
    let unknown = orogeny_store::Layer { id: 99, ..changed.clone() };
    assert!(matches!(transaction.set_layer(&unknown), Err(Error::UnknownLayer { layer: 99 })));
    transaction.commit("{}", "test").unwrap();
    assert_eq!(store.layers(), [changed.clone()]);
    assert_whole(&store);
    assert!(store.undo(1).unwrap()[0].layers_changed);
    assert_eq!(store.layers(), before);
    store.redo(1).unwrap();
    store.close().unwrap();
    let store = Store::open(&scratch.path()).unwrap();
    assert_eq!((store.layers(), store.fields().len()), ([changed].as_slice(), 2));
    assert_whole(&store);
}
