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
    assert_eq!(heights(&reader), [1.0, 0.0, 0.0], "the reader sees what it was not asked to look for");
    reader.refresh().unwrap();
    assert_eq!(heights(&reader), [1.0, 0.0, 1.0], "the reader does not see what was committed");
    let err = reader.apply(&[dab(30.0)], &mut Quiet).unwrap_err();
    assert!(err.to_string().contains("opened for reading"), "{err}");
    first.close().unwrap();

    // The next writer goes on from there, and knows what the one before did.
    let mut second = open(&path);
    second.undo(1).unwrap();
    second.apply(&[dab(30.0)], &mut Quiet).unwrap();
    assert_eq!(heights(&second), [1.0, 1.0, 0.0]);
    reader.refresh().unwrap();
    assert_eq!(heights(&reader), [1.0, 1.0, 0.0]);
}

/// What a reader shows of a stack: its layers from the bottom, two heights of the composite, how often it was committed.
fn shown(terrain: &Terrain) -> (Vec<String>, [f32; 2], u64) {
    let names = terrain.layers().unwrap().iter().map(|layer| layer.name.clone()).collect();
    let description = terrain.describe().unwrap();
    let described: Vec<_> = description.layers.iter().map(|layer| layer.name.clone()).collect();
    assert_eq!(described, names);
    let range = terrain.height_statistics(&mut Quiet).unwrap();
    let heights = [10.0, 50.0].map(|x_m| terrain.height_m([x_m, 20.0]).unwrap());
    assert!(heights.into_iter().all(|height_m| height_m >= range.min_m && height_m <= range.max_m));
    (names, heights, description.num_commits)
}

#[test]
fn a_reader_shows_the_layers_and_the_pages_of_one_state() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shared.orogeny");
    let settings = || Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let grid = TerrainGrid::new(100, 100, 1.0).unwrap();
    let mut writer = Terrain::create(&path, grid, 0.0, settings()).unwrap();
    writer.apply(&[dab(10.0)], &mut Quiet).unwrap();
    let mut reader = Terrain::open_to_read(&path, settings()).unwrap();
    // The layer counts half and takes away what is below: without it, or with the layers in another order, what was painted
    // comes to something else.
    let steps = [
        vec![r#"{"op": "add_layer", "name": "Top", "blend": "replace", "opacity": 0.5}"#.to_owned()],
        vec![
            r#"{"op": "stroke", "layer": "Top", "brush": {"type": "raise", "radius": 4, "strength": 8}, "points": [[50, 20]]}"#
                .to_owned(),
            r#"{"op": "add_layer", "name": "Smooth", "content": {"type": "effect", "brush": {"type": "smooth", "width": 3}}}"#
                .to_owned(),
        ],
        vec![r#"{"op": "move_layer", "layer": "Top"}"#.to_owned()],
        vec![
            r#"{"op": "stroke", "layer": "Base", "brush": {"type": "raise", "radius": 4, "strength": 8}, "points": [[50, 20]]}"#
                .to_owned(),
            r#"{"op": "remove_layer", "layer": "Top"}"#.to_owned(),
        ],
    ];
    for step in steps {
        let before = shown(&reader);
        let operations: Vec<_> = step.iter().map(|text| Operation::from_json_text(text).unwrap()).collect();
        writer.apply(&operations, &mut Quiet).unwrap();
        assert_eq!(shown(&reader), before, "after {step:?}");
        reader.refresh().unwrap();
        let after = shown(&reader);
        assert_ne!(after, before, "after {step:?}");
        assert_eq!(after, shown(&Terrain::open_to_read(&path, settings()).unwrap()), "after {step:?}");
        assert_eq!(after, shown(&writer), "after {step:?}");
    }
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
