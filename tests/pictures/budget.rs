//! A large terrain with little memory: no hole, and no more pages than there is room for.

use orogeny_engine::{Adapter, Flight, Operation, Quiet, Settings, Terrain, TerrainGrid, ViewRequest};
use serde_json::json;

const SIDE: u64 = 65_536;

/// Ridges along the way of the flight, of which there are more pages than there is room for.
fn ridges() -> Operation {
    let points: Vec<_> = (0..8).map(|k| json!([21_000 + 800 * k, 30_000 + 900 * (k % 3)])).collect();
    let brush = json!({"type": "noise", "radius": 900, "strength": 600, "octaves": 5, "feature_size": 1500});
    Operation::from_json(json!({"op": "stroke", "seed": 3, "brush": brush, "points": points})).unwrap()
}

#[test]
fn with_64_mebibytes_a_terrain_of_65536_a_side_flies_through_without_a_hole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.orogeny");
    let grid = TerrainGrid::new(SIDE, SIDE, 1.0).unwrap();
    let cpu = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let mut terrain = Terrain::create(&path, grid, 50.0, cpu).unwrap();
    terrain.apply(&[ridges()], &mut Quiet).unwrap();
    terrain.close().unwrap();

    let small =
        Settings { adapter: Adapter::Software, page_budget_in_bytes: 64 << 20, ..Settings::default() };
    let terrain = Terrain::open_to_read(&path, small).unwrap();
    let keys = r#"[{"eye": [19000, 2500, 33000], "target": [24000, 300, 30000]}, {"eye": [23000, 1500, 31500], "target": [27000, 300, 30000]},
        {"eye": [26000, 8000, 36000], "target": [26000, 0, 30000]}]"#;
    let flight = Flight::from_json(&format!(r#"{{"frames": 8, "keys": {keys}}}"#)).unwrap();
    // Nothing but ground below the horizon: what is no ground there would have the sky's colour, not the ground's.
    let request =
        ViewRequest { size_px: [480, 270], mode: orogeny_engine::Mode::Normals, ..ViewRequest::default() };
    let mut view = terrain.view(request.size_px).unwrap();
    let mut most_pages = 0;
    for request in flight.frames(&request) {
        let drawn = view.draw(&request, &mut Quiet).unwrap();
        most_pages = most_pages.max(drawn.report.num_pages);
        assert!(drawn.report.num_pages <= 256, "{:?}", drawn.report);
        // The lower half of every picture lies below the horizon. Normals point upwards: their blue is over a half.
        let lower = &drawn.picture.rgb[drawn.picture.rgb.len() / 2..];
        let num_holes = lower.chunks_exact(3).filter(|pixel| pixel[2] < 186).count();
        assert_eq!(num_holes, 0, "{:?}", drawn.eye_m);
    }
    assert!(most_pages > 40, "{most_pages}");
}
