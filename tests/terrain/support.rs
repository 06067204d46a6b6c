//! Terrains, strokes and comparisons of the tests.

use std::collections::BTreeMap;
use std::path::Path;

use orogeny_engine::{Adapter, Entry, EntryState, Operation, PageKey, Quiet, Settings, Terrain, TerrainGrid};
use orogeny_store::Store;
use orogeny_tests::Random;
use serde_json::{Value, json};

/// Samples a side of the terrain that most tests paint on, odd so that pages hang over its edge.
pub const SIDES: [u64; 2] = [701, 523];

/// Height of the ground before any stroke.
pub const GROUND_M: f32 = 100.0;

pub fn settings() -> Settings {
    Settings { adapter: Adapter::Cpu, author: "test".to_owned(), ..Settings::default() }
}

pub fn create(path: &Path) -> Terrain {
    let grid = TerrainGrid::new(SIDES[0], SIDES[1], 1.0).unwrap();
    Terrain::create(path, grid, GROUND_M, settings()).unwrap()
}

pub fn operation(json: Value) -> Operation {
    Operation::from_json(json).unwrap()
}

/// A stroke of a small brush somewhere on the terrain or across its edge: a function of the number alone.
pub fn stroke(number: u32) -> Operation {
    let mut random = Random::new(0x05ee_d000 + u64::from(number));
    let brush_type = random.one_of(&["raise", "lower", "ledge", "roughen", "level"]);
    let mut brush = json!({"type": brush_type, "radius": random.within(8.0, 40.0)});
    brush["strength"] = match brush_type {
        "level" => json!(random.within(0.2, 1.0)),
        _ => json!(random.within(0.5, 20.0)),
    };
    brush["profile"] = random.one_of(&["smooth", "linear", "sphere", "gauss"]).into();
    let num_points = random.one_of(&[1, 2, 3]);
    let mut at = [random.within(-10.0, 710.0), random.within(-10.0, 530.0)];
    let mut points = Vec::new();
    for _ in 0..num_points {
        points.push(json!([at[0], at[1], random.within(0.3, 1.0)]));
        at = at.map(|place| place + random.within(-60.0, 60.0));
    }
    operation(json!({"op": "stroke", "seed": number, "brush": brush, "points": points}))
}

/// Paints operations and waits for each.
pub fn apply(terrain: &mut Terrain, operations: &[Operation]) {
    for operation in operations {
        terrain.apply(std::slice::from_ref(operation), &mut Quiet).unwrap();
    }
}

/// The bits of every page of every level of every field.
pub type Heights = BTreeMap<PageKey, Vec<u32>>;

/// The heights of a closed or open terrain as they are on disk.
pub fn heights(path: &Path) -> Heights {
    let store = Store::open_to_read(path).unwrap();
    let keys = store.fields().keys().flat_map(|field| store.page_keys(*field).unwrap());
    let bits = |key: &PageKey| {
        let page = store.load_page(key).unwrap_or_else(|err| panic!("{err}")).unwrap();
        page.samples().iter().map(|height| height.to_bits()).collect()
    };
    keys.map(|key| (key, bits(&key))).collect()
}

/// Fails with the pages that differ rather than with all of their samples.
pub fn assert_same_heights(found: &Heights, expected: &Heights) {
    assert!(found.keys().eq(expected.keys()), "{:?}, not {:?}", found.keys(), expected.keys());
    let differing: Vec<_> = found.iter().filter(|(key, bits)| expected[*key] != **bits).collect();
    let keys: Vec<_> = differing.iter().map(|(key, _)| key).collect();
    assert!(keys.is_empty(), "{keys:?} differ");
}

pub fn assert_whole(path: &Path) {
    let report = Terrain::check(path).unwrap();
    assert!(report.problems.is_empty(), "{:#?}", report.problems);
}

/// The heights are those of a new terrain on which is done again what the history says. Gives the operations done.
pub fn assert_is_replay(terrain: &Terrain, path: &Path) -> u64 {
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("replay.orogeny");
    let replayed = terrain.replay(&copy, settings(), &mut Quiet).unwrap();
    let num_applied = ids(&terrain.log().unwrap(), |entry| entry.state == EntryState::Applied).len();
    assert_eq!(replayed.num_operations, num_applied as u64);
    assert_same_heights(&heights(path), &heights(&copy));
    replayed.num_operations
}

/// The numbers of some entries.
pub fn ids(log: &[Entry], is_wanted: impl Fn(&Entry) -> bool) -> Vec<u32> {
    log.iter().filter(|entry| is_wanted(entry)).map(|entry| entry.id.0).collect()
}

/// The last entry that shows; 0 for none.
pub fn head(log: &[Entry]) -> u32 {
    ids(log, |entry| entry.state == EntryState::Applied).last().copied().unwrap_or(0)
}
