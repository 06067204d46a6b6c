//! Transactions: what they see, what they refuse, and that a refused one changes nothing.

use orogeny_field::{FieldId, Page, PageKey, PageLayout};
use orogeny_store::{Error, Store};

use crate::support::{Scratch, assert_whole, bits, commit, key, layer, layout, page, painted};

#[test]
fn pages_come_back_bit_for_bit() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let field = store.layers()[0].heights;
    let keys = [(0, 0), (1, 2), (2, 4)].map(|(z, x)| PageKey::full_resolution(field, x, z));
    let pages: Vec<_> = keys.iter().zip(1..).map(|(key, seed)| (*key, page(seed))).collect();
    commit(&mut store, &pages);
    store.close().unwrap();
    let store = Store::open(&scratch.path()).unwrap();
    let expected: Vec<_> = pages.iter().map(|(key, page)| (*key, bits(page))).collect();
    assert_eq!(painted(&store, field), expected);
    assert_eq!(store.load_page(&PageKey { x: 3, ..keys[0] }).unwrap(), None);
    assert_whole(&store);
}

#[test]
fn a_transaction_sees_its_own_writes_and_what_was_before() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let (old, new) = (key(&store, 0, 0), key(&store, 1, 0));
    commit(&mut store, &[(old, page(1))]);
    let mut transaction = store.begin().unwrap();
    assert_eq!(*transaction.load_page_before(&old).unwrap().unwrap(), page(1));
    for seed in [2, 3] {
        transaction.write_pages(&[(old, page(seed)), (new, page(seed + 10))]).unwrap();
        assert_eq!(bits(&transaction.load_page(&old).unwrap().unwrap()), bits(&page(seed)));
        assert_eq!(bits(&transaction.load_page_before(&old).unwrap().unwrap()), bits(&page(1)));
        assert_eq!(bits(&transaction.load_page(&new).unwrap().unwrap()), bits(&page(seed + 10)));
        assert_eq!(transaction.load_page_before(&new).unwrap(), None);
    }
    transaction.commit("{}", "test").unwrap();
    store.undo(1).unwrap();
    assert_eq!(bits(&store.load_page(&old).unwrap().unwrap()), bits(&page(1)));
    assert_eq!(store.load_page(&new).unwrap(), None);
    assert_whole(&store);
}

#[test]
fn a_dropped_transaction_leaves_no_trace() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let key = key(&store, 0, 0);
    let layers = store.layers().to_vec();
    let mut transaction = store.begin().unwrap();
    transaction.write_pages(&[(key, page(1))]).unwrap();
    transaction.add_layer(&layer("Sculpt", 0.0)).unwrap();
    assert_eq!(transaction.layers().len(), 2);
    drop(transaction);
    assert_eq!(store.layers(), layers);
    assert_eq!(store.load_page(&key).unwrap(), None);
    assert!(store.log().unwrap().is_empty());
    assert_whole(&store);
}

#[test]
fn a_page_that_ends_as_it_was_is_not_in_the_history() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let (painted, absent, changed) = (key(&store, 0, 0), key(&store, 1, 0), key(&store, 2, 0));
    let flat = Page::constant(layout(), 100.0);
    commit(&mut store, &[(painted, page(1))]);
    let mut transaction = store.begin().unwrap();
    transaction.write_pages(&[(painted, page(2)), (absent, page(3)), (changed, page(4))]).unwrap();
    transaction.write_pages(&[(painted, page(1)), (absent, flat.clone())]).unwrap();
    assert_eq!(transaction.load_page(&absent).unwrap(), None);
    transaction.commit("{}", "test").unwrap();
    let log = store.log().unwrap();
    assert_eq!(log.iter().map(|entry| entry.num_pages).collect::<Vec<_>>(), [1, 1]);
    assert_eq!(store.undo(1).unwrap()[0].pages, [changed]);
    assert_eq!(bits(&store.load_page(&painted).unwrap().unwrap()), bits(&page(1)));
    // Nothing but the constant, written where there is no page: there is still none.
    commit(&mut store, &[(absent, flat)]);
    assert_eq!(store.load_page(&absent).unwrap(), None);
    // -0 is not +0, and 100 where there is a page is a change.
    commit(&mut store, &[(painted, Page::constant(layout(), 0.0))]);
    commit(&mut store, &[(painted, Page::constant(layout(), -0.0))]);
    assert_eq!(store.log().unwrap().last().unwrap().num_pages, 1);
    commit(&mut store, &[(painted, Page::constant(layout(), 100.0))]);
    assert!(store.load_page(&painted).unwrap().is_some());
    assert_whole(&store);
}

#[test]
fn heights_that_are_none_are_refused_by_their_bits() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let (good, bad) = (key(&store, 0, 0), key(&store, 1, 1));
    let signalling_nan = f32::from_bits(0x7f80_0001);
    for height in
        [f32::NAN, -f32::NAN, signalling_nan, f32::INFINITY, f32::NEG_INFINITY, 1.000_000_1e7, -f32::MAX]
    {
        let mut samples = page(1).samples().to_vec();
        samples[64 * 3 + 5] = height;
        let broken = Page::from_samples(layout(), samples).unwrap();
        let mut transaction = store.begin().unwrap();
        let err = transaction.write_pages(&[(good, page(2)), (bad, broken)]).unwrap_err();
        assert!(matches!(err, Error::Height { key, x: 5, z: 3, .. } if key == bad), "{err}");
        // Nothing was written, so the transaction is still good.
        assert_eq!(transaction.load_page(&good).unwrap(), None);
        transaction.commit("{}", "test").unwrap();
    }
    assert_eq!(store.log().unwrap().iter().map(|entry| entry.num_pages).sum::<u32>(), 0);
}

#[test]
fn pages_that_do_not_fit_are_refused() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let inside = key(&store, 4, 2);
    let mut transaction = store.begin().unwrap();
    let mut refused = |key: PageKey, page: Page| transaction.write_pages(&[(key, page)]).unwrap_err();
    for outside in [
        PageKey { x: 5, ..inside },
        PageKey { z: 3, ..inside },
        PageKey { level: 1, x: 3, z: 0, ..inside },
        PageKey { level: 4, x: 0, z: 0, ..inside },
        PageKey { x: u32::MAX, z: u32::MAX, level: 255, ..inside },
    ] {
        let err = refused(outside, page(1));
        assert!(matches!(err, Error::PageOutside { key, .. } if key == outside), "{err}");
    }
    let unknown = PageKey { field: FieldId(99), ..inside };
    assert!(matches!(refused(unknown, page(1)), Error::UnknownField { field: FieldId(99) }));
    let coarse = PageKey { level: 1, x: 0, z: 0, ..inside };
    assert!(matches!(refused(coarse, page(1)), Error::DerivedPage { key } if key == coarse));
    let large = Page::constant(PageLayout::new(128).unwrap(), 0.0);
    assert!(matches!(refused(inside, large), Error::PageSize { expected: 64, actual: 128 }));
    let err = transaction.write_pages(&[(inside, page(1)), (inside, page(2))]).unwrap_err();
    assert!(matches!(err, Error::PageTwice { key } if key == inside), "{err}");
    assert!(matches!(transaction.add_layer(&layer("", 0.0)), Err(Error::LayerName { .. })));
    // The last page is one.
    transaction.write_pages(&[(inside, page(1))]).unwrap();
    transaction.commit("{}", "test").unwrap();
    assert_whole(&store);
}

#[test]
fn an_operation_must_be_json() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let key = key(&store, 0, 0);
    for operation in ["", "{", "{} {}", "\u{0}", &format!("{}1", "[".repeat(10_000))] {
        let mut transaction = store.begin().unwrap();
        transaction.write_pages(&[(key, page(1))]).unwrap();
        assert!(matches!(transaction.commit(operation, "test"), Err(Error::Operation { .. })));
    }
    assert!(store.log().unwrap().is_empty());
    assert_eq!(store.load_page(&key).unwrap(), None);
    let operation = "{\"op\": \"fill\", \"text\": \"日本\"}";
    store.begin().unwrap().commit(operation, "Ünal").unwrap();
    let log = store.log().unwrap();
    assert_eq!((log[0].operation_json.as_str(), log[0].author.as_str()), (operation, "Ünal"));
    assert!(log[0].time_unix_ms > 1_700_000_000_000);
}

#[test]
fn more_pages_than_a_batch_are_one_operation() {
    let scratch = Scratch::new();
    let grid = orogeny_field::TerrainGrid::new(64 * 40, 64 * 40, 1.0).unwrap();
    let new = orogeny_store::NewTerrain { grid, layout: layout(), layers: vec![layer("Base", 0.0)] };
    let mut store = Store::create(&scratch.path(), &new).unwrap();
    let pages: Vec<_> = (0..1600).map(|i| (key(&store, i % 40, i / 40), page(i))).collect();
    let mut keys: Vec<_> = pages.iter().map(|(key, _)| *key).collect();
    keys.sort();
    commit(&mut store, &pages);
    let undone = store.undo(1).unwrap();
    assert_eq!(undone[0].pages, keys);
    assert!(store.page_keys(keys[0].field).unwrap().is_empty());
    store.redo(1).unwrap();
    for (key, page) in &pages {
        assert_eq!(bits(&store.load_page(key).unwrap().unwrap()), bits(page));
    }
    // 40 pages a side, then 20, 10, 5, 3, 2, 1 above them.
    let num_pages = 1600 + 400 + 100 + 25 + 9 + 4 + 1;
    let report = store.check().unwrap();
    assert_eq!((report.num_pages, report.num_deltas, report.problems.len()), (num_pages, 1600, 0));
}
