//! Several programs on one terrain: one writes, others read what it committed, and what was only tried leaves nothing.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::path::Path;

use orogeny_engine::{Adapter, Operation, Quiet, Settings, Terrain, TerrainGrid};

fn open(path: &Path) -> Terrain {
    Terrain::open(path, Settings { adapter: Adapter::Cpu, ..Settings::default() }).unwrap()
}

fn dab(x_m: f64) -> Operation {
    let text = format!(
        r#"{{"op": "stroke", "brush": {{"type": "raise", "radius": 4, "strength": 1}}, "points": [[{x_m}, 20]]}}"#
    );
    Operation::from_json_text(&text).unwrap()
}

#[test]
fn a_terrain_has_one_writer_at_a_time_and_readers_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shared.orogeny");
    let settings = || Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let grid = TerrainGrid::new(100, 100, 1.0).unwrap();
    let mut first = Terrain::create(&path, grid, 0.0, settings()).unwrap();
    first.apply(&[dab(10.0)], &mut Quiet).unwrap();

    let err = Terrain::open(&path, settings()).unwrap_err();
    assert!(err.to_string().contains(&format!("process {}", std::process::id())), "{err}");
    let mut reader = Terrain::open_to_read(&path, settings()).unwrap();
    first.apply(&[dab(50.0)], &mut Quiet).unwrap();
    let heights = |terrain: &Terrain| [10.0, 30.0, 50.0].map(|x_m| terrain.height_m([x_m, 20.0]).unwrap());
    assert_eq!(heights(&reader), [1.0, 0.0, 1.0], "the reader does not see what was committed");
    let err = reader.apply(&[dab(30.0)], &mut Quiet).unwrap_err();
    assert!(err.to_string().contains("opened for reading"), "{err}");
    first.close().unwrap();

    // The next writer goes on from there, and knows what the one before did.
    let mut second = open(&path);
    second.undo(1).unwrap();
    second.apply(&[dab(30.0)], &mut Quiet).unwrap();
    assert_eq!(heights(&second), [1.0, 1.0, 0.0]);
    assert_eq!(heights(&reader), [1.0, 1.0, 0.0]);
}

#[test]
fn what_was_only_tried_leaves_nothing_in_memory_or_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tried.orogeny");
    let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let grid = TerrainGrid::new(100, 100, 1.0).unwrap();
    let mut terrain = Terrain::create(&path, grid, 0.0, settings).unwrap();
    terrain.apply(&[dab(10.0)], &mut Quiet).unwrap();
    assert_eq!(terrain.try_out(&[dab(10.0), dab(10.0)], &mut Quiet).unwrap().len(), 2);
    terrain.apply(&[dab(10.0)], &mut Quiet).unwrap();
    assert_eq!(terrain.height_m([10.0, 20.0]).unwrap(), 2.0);
    assert_eq!(terrain.log().unwrap().len(), 2);
}
