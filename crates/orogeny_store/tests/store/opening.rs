//! Making, opening and closing; what is refused is not touched.

use std::path::Path;

use orogeny_field::{PageLayout, TerrainGrid};
use orogeny_store::{Error, NewTerrain, Store, format};

use crate::support::{Scratch, assert_whole, commit, key, layer, layout, page};

#[test]
fn a_new_terrain_is_what_was_asked_for() {
    let scratch = Scratch::new();
    let grid = TerrainGrid::new(1 << 20, 1 << 20, 0.5).unwrap();
    let layers = vec![layer("Base", -0.0), layer("Détail", -12.5)];
    let created =
        Store::create(&scratch.path(), &NewTerrain { grid, layout: PageLayout::default(), layers }).unwrap();
    let as_created = created.layers().to_vec();
    created.close().unwrap();
    let store = Store::open(&scratch.path()).unwrap();
    assert_eq!((store.grid(), store.layout()), (grid, PageLayout::default()));
    assert_eq!(store.layers(), as_created);
    let [base, detail] = store.layers() else { panic!("{:?}", store.layers()) };
    assert_eq!((base.name.as_str(), base.position, base.constant_m.to_bits()), ("Base", 0, 0));
    assert_eq!((detail.name.as_str(), detail.position, detail.constant_m), ("Détail", 1, -12.5));
    assert_ne!(base.heights, detail.heights);
    assert!(store.log().unwrap().is_empty());
    assert!(store.page_keys(base.heights).unwrap().is_empty());
    assert!(store.file_size_in_bytes().unwrap() < 256 << 10);
    assert_whole(&store);
}

#[test]
fn a_closed_terrain_is_one_file() {
    let scratch = Scratch::new();
    let mut store = scratch.create();
    let key = key(&store, 0, 0);
    commit(&mut store, &[(key, page(1))]);
    assert!(scratch.files().len() > 1, "the log of an open terrain lies beside it");
    store.close().unwrap();
    assert_eq!(scratch.files(), ["terrain.orogeny"]);
    // Dropping does the same.
    let mut store = Store::open(&scratch.path()).unwrap();
    commit(&mut store, &[(key, page(2))]);
    drop(store);
    assert_eq!(scratch.files(), ["terrain.orogeny"]);
}

#[test]
fn create_never_replaces_a_file() {
    let scratch = Scratch::new();
    std::fs::write(scratch.path(), b"precious").unwrap();
    let grid = TerrainGrid::new(64, 64, 1.0).unwrap();
    let new = NewTerrain { grid, layout: layout(), layers: Vec::new() };
    assert!(matches!(Store::create(&scratch.path(), &new), Err(Error::Exists { .. })));
    assert_eq!(std::fs::read(scratch.path()).unwrap(), b"precious");
    assert!(matches!(Store::create(scratch.folder(), &new), Err(Error::Directory { .. })));
    assert!(matches!(Store::create(Path::new(""), &new), Err(Error::EmptyPath)));
}

#[test]
fn a_failed_create_leaves_nothing() {
    let scratch = Scratch::new();
    let grid = TerrainGrid::new(64, 64, 1.0).unwrap();
    let bad = [layer("", 0.0), layer(&"x".repeat(256), 0.0), layer("NaN", f32::NAN), layer("high", 1.1e7)];
    for layer in bad {
        let new = NewTerrain { grid, layout: layout(), layers: vec![layer] };
        let err = Store::create(&scratch.path(), &new).unwrap_err();
        assert!(matches!(err, Error::LayerName { .. } | Error::Value(_)), "{err}");
    }
    let new = NewTerrain { grid, layout: layout(), layers: Vec::new() };
    let err = Store::create(&scratch.folder().join("absent/terrain.orogeny"), &new).unwrap_err();
    assert!(err.to_string().contains("folder does not exist"), "{err}");
    assert!(scratch.files().is_empty());
}

#[test]
fn what_is_no_terrain_is_refused_and_not_touched() {
    let scratch = Scratch::new();
    assert!(matches!(Store::open(Path::new("")), Err(Error::EmptyPath)));
    assert!(matches!(Store::open(&scratch.path()), Err(Error::Missing { .. })));
    assert!(matches!(Store::open(scratch.folder()), Err(Error::Directory { .. })));
    let other = scratch.folder().join("other.db");
    rusqlite::Connection::open(&other)
        .unwrap()
        .execute_batch("CREATE TABLE t (a); INSERT INTO t VALUES (1)")
        .unwrap();
    let foreign = [
        Vec::new(),
        b"P5 2 2 255 abcd".to_vec(),
        vec![0; 100_000],
        vec![0xff; 8192],
        b"SQLite format 3\0".to_vec(),
        std::fs::read(&other).unwrap(),
    ];
    for bytes in foreign {
        std::fs::write(scratch.path(), &bytes).unwrap();
        let err = Store::open(&scratch.path()).unwrap_err();
        assert!(matches!(err, Error::NotATerrain { .. }), "{err}");
        assert_eq!(std::fs::read(scratch.path()).unwrap(), bytes);
    }
}

#[test]
fn a_newer_version_is_refused_and_not_touched() {
    let scratch = Scratch::new();
    scratch.create().close().unwrap();
    let set_version = |version: i32| {
        let conn = rusqlite::Connection::open(scratch.path()).unwrap();
        conn.pragma_update(None, "user_version", version).unwrap();
    };
    set_version(format::FORMAT_VERSION + 1);
    let bytes = std::fs::read(scratch.path()).unwrap();
    let err = Store::open(&scratch.path()).unwrap_err();
    let newer = format::FORMAT_VERSION + 1;
    assert!(
        matches!(err, Error::NewerVersion { version, supported: format::FORMAT_VERSION, .. } if version == newer),
        "{err}"
    );
    assert_eq!(std::fs::read(scratch.path()).unwrap(), bytes);
    assert_eq!(scratch.files(), ["terrain.orogeny"]);
    set_version(0);
    assert!(matches!(Store::open(&scratch.path()), Err(Error::Damaged { .. })));
}

#[test]
fn the_log_of_a_newer_version_is_not_touched_either() {
    let scratch = Scratch::new();
    scratch.create().close().unwrap();
    // A connection that changes the version and is gone without a checkpoint: version and log are beside the file.
    let copy = scratch.folder().join("copy.orogeny");
    let conn = rusqlite::Connection::open(scratch.path()).unwrap();
    conn.pragma_update(None, "user_version", 7).unwrap();
    std::fs::copy(scratch.path(), &copy).unwrap();
    std::fs::copy(scratch.path().with_extension("orogeny-wal"), copy.with_extension("orogeny-wal")).unwrap();
    drop(conn);
    let bytes = std::fs::read(&copy).unwrap();
    assert!(matches!(Store::open(&copy), Err(Error::NewerVersion { version: 7, .. })));
    assert_eq!(std::fs::read(&copy).unwrap(), bytes);
    assert!(copy.with_extension("orogeny-wal").exists());
}
