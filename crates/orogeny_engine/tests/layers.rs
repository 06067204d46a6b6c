//! Painting on layers: what is seen is what a brush works on, whatever the budget, and masks that a brush makes are kept.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::path::Path;

use orogeny_engine::{
    Adapter, ExportSource, LayerReference, Operation, Quiet, Settings, Terrain, TerrainGrid,
};

fn terrain(path: &Path, page_budget_in_bytes: u64) -> Terrain {
    let settings = Settings { adapter: Adapter::Cpu, page_budget_in_bytes, ..Settings::default() };
    let grid = TerrainGrid::new(700, 600, 2.0).unwrap();
    let mut terrain = Terrain::create(path, grid, 100.0, settings).unwrap();
    apply(
        &mut terrain,
        &[
            r#"{"op": "add_layer", "name": "Hills", "content": {"type": "procedural", "seed": 4,
                "brush": {"type": "noise", "strength": 90, "feature_size": 300}}}"#,
            r#"{"op": "add_layer", "name": "Sculpt"}"#,
        ],
    );
    terrain
}

fn apply(terrain: &mut Terrain, operations: &[&str]) {
    let operations: Vec<_> = operations.iter().map(|text| Operation::from_json_text(text).unwrap()).collect();
    terrain.apply(&operations, &mut Quiet).unwrap();
}

fn composite(terrain: &Terrain) -> Vec<f32> {
    terrain.heights(&ExportSource::Composite, None, 0).unwrap().2
}

const PLATEAU: &str = r#"{"op": "stroke", "layer": "Sculpt", "brush": {"type": "set_height", "height": 150, "radius": 200, "falloff": 40},
    "points": [[500, 500], [900, 700]]}"#;

#[test]
fn what_a_brush_makes_of_what_is_seen_is_seen_and_the_layer_keeps_the_difference() {
    let folder = tempfile::tempdir().unwrap();
    let mut terrain = terrain(&folder.path().join("t.orogeny"), 1 << 30);
    let before = composite(&terrain);
    apply(&mut terrain, &[PLATEAU]);
    assert_eq!(terrain.height_m([700.0, 600.0]).unwrap(), 150.0);
    let after = composite(&terrain);
    let kept =
        terrain.heights(&ExportSource::Layer(LayerReference::Name("Sculpt".to_owned())), None, 0).unwrap().2;
    let mut num_changed = 0;
    for ((before, after), kept) in before.iter().zip(&after).zip(&kept) {
        assert!((after - before - kept).abs() < 1e-4, "{before} {after} {kept}");
        num_changed += usize::from(*kept != 0.0);
    }
    assert!((30_000..120_000).contains(&num_changed), "{num_changed}");
    // What lies below goes on: with less of the hills the plateau has their marks in it.
    apply(&mut terrain, &[r#"{"op": "set_layer", "layer": "Hills", "visible": false}"#]);
    assert_ne!(terrain.height_m([700.0, 600.0]).unwrap(), 150.0);
    // The layer's own heights, where they are asked for.
    apply(
        &mut terrain,
        &[
            r#"{"op": "stroke", "layer": "Sculpt", "target": "heights", "brush": {"type": "set_height", "height": 7, "radius": 20,
            "falloff": 0}, "points": [[200, 1000]]}"#,
        ],
    );
    assert_eq!(terrain.height_m([200.0, 1000.0]).unwrap(), 107.0);
}

#[test]
fn a_faded_layer_keeps_more_of_it_and_comes_to_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let mut terrain = terrain(&folder.path().join("t.orogeny"), 1 << 30);
    apply(&mut terrain, &[r#"{"op": "set_layer", "layer": "Sculpt", "opacity": 0.25}"#, PLATEAU]);
    assert!((terrain.height_m([700.0, 600.0]).unwrap() - 150.0).abs() < 1e-3);
}

#[test]
fn a_hidden_layer_is_painted_on_what_lies_below_it_now() {
    let folder = tempfile::tempdir().unwrap();
    let operations = [
        r#"{"op": "set_mask", "layer": "Sculpt", "terms": [{"gate": {"height": {"min": -5000, "max": 5000}}}]}"#,
        r#"{"op": "set_layer", "layer": "Sculpt", "visible": false}"#,
        PLATEAU,
        r#"{"op": "fill", "layer": "Base", "target": "heights", "brush": {"type": "raise", "strength": 40}}"#,
        r#"{"op": "stroke", "layer": "Sculpt", "brush": {"type": "smooth", "width": 30, "radius": 200, "strength": 1},
            "points": [[700, 600]]}"#,
        r#"{"op": "set_layer", "layer": "Sculpt", "visible": true}"#,
    ];
    let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let [at_once, afresh] = [false, true].map(|is_reopened| {
        let path = folder.path().join(format!("{is_reopened}.orogeny"));
        let mut terrain = terrain(&path, 1 << 30);
        for operation in operations {
            apply(&mut terrain, &[operation]);
            if is_reopened {
                terrain.close().unwrap();
                terrain = Terrain::open(&path, settings.clone()).unwrap();
            }
        }
        composite(&terrain)
    });
    assert!(at_once.iter().zip(&afresh).all(|(a, b)| a.to_bits() == b.to_bits()));
}

#[test]
fn the_budget_changes_no_bit_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let strokes = [
        PLATEAU,
        r#"{"op": "stroke", "layer": "Sculpt", "brush": {"type": "smooth", "width": 30, "radius": 260, "strength": 0.9},
            "points": [[300, 300], [1100, 900]]}"#,
        r#"{"op": "fill", "layer": "Sculpt", "brush": {"type": "terrace", "step": 15, "strength": 0.7}}"#,
    ];
    let [large, small] = [1 << 30, 1 << 20].map(|budget| {
        let mut terrain = terrain(&folder.path().join(format!("{budget}.orogeny")), budget);
        apply(&mut terrain, &strokes);
        composite(&terrain)
    });
    let same = large.iter().zip(&small).all(|(a, b)| a.to_bits() == b.to_bits());
    assert!(same && large.len() == 700 * 600);
}

#[test]
fn a_mask_that_a_brush_makes_is_kept_and_is_stale_when_something_below_changes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.orogeny");
    let mut terrain = terrain(&path, 1 << 30);
    apply(
        &mut terrain,
        &[
            r#"{"op": "add_layer", "name": "Rivers", "height": -3}"#,
            r#"{"op": "set_mask", "layer": "Rivers", "brush": {"brush": {"type": "flow_mask", "strength": 1}}}"#,
        ],
    );
    let mask = |terrain: &Terrain| {
        terrain.heights(&ExportSource::Mask(LayerReference::Name("Rivers".to_owned())), None, 0).unwrap().2
    };
    let is_stale = |terrain: &Terrain| {
        let layers = terrain.describe().unwrap().layers;
        layers.iter().find(|layer| layer.name == "Rivers").unwrap().is_stale
    };
    let made = mask(&terrain);
    assert!(made.iter().any(|value| *value > 0.5) && made.contains(&0.0));
    assert!(!is_stale(&terrain));
    apply(&mut terrain, &[PLATEAU]);
    assert!(is_stale(&terrain));
    assert_eq!(mask(&terrain), made);
    terrain.undo(1).unwrap();
    assert!(!is_stale(&terrain));
    terrain.redo(1).unwrap();
    apply(&mut terrain, &[r#"{"op": "refresh_layer", "layer": "Rivers"}"#]);
    assert!(!is_stale(&terrain));
    let refreshed = mask(&terrain);
    assert_ne!(refreshed, made);
    // Made afresh on the same ground it is the same.
    apply(
        &mut terrain,
        &[
            r#"{"op": "set_mask", "layer": "Rivers", "brush": {"brush": {"type": "flow_mask", "strength": 1}}}"#,
        ],
    );
    assert_eq!(mask(&terrain), refreshed);
    let copy = folder.path().join("again.orogeny");
    let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    terrain.replay(&copy, settings.clone(), &mut Quiet).unwrap();
    let again = Terrain::open_to_read(&copy, settings).unwrap();
    assert_eq!(mask(&again), refreshed);
    let wrong = r#"{"op": "set_mask", "layer": "Rivers", "brush": {"brush": {"type": "raise"}}}"#;
    let refused = terrain.apply(&[Operation::from_json_text(wrong).unwrap()], &mut Quiet).unwrap_err();
    assert!(refused.to_string().contains("raise"), "{refused}");
}
