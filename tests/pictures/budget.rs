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
fn with_little_memory_a_terrain_of_65536_a_side_flies_through_without_a_hole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.orogeny");
    let grid = TerrainGrid::new(SIDE, SIDE, 1.0).unwrap();
    let cpu = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let mut terrain = Terrain::create(&path, grid, 50.0, cpu).unwrap();
    terrain.apply(&[ridges()], &mut Quiet).unwrap();
    terrain.close().unwrap();

    let keys = r#"[{"eye": [19000, 2500, 33000], "target": [24000, 300, 30000]}, {"eye": [23000, 1500, 31500], "target": [27000, 300, 30000]},
        {"eye": [26000, 8000, 36000], "target": [26000, 0, 30000]}]"#;
    let flight = Flight::from_json(&format!(r#"{{"frames": 5, "keys": {keys}}}"#)).unwrap();
    // Nothing but ground below the horizon: what is no ground there would have the sky's colour, not the ground's.
    let request =
        ViewRequest { mode: orogeny_engine::Mode::Normals, has_shadows: false, ..ViewRequest::default() };
    for (mebibytes, size_px, is_enough) in [(64, [480, 270], true), (16, [1200, 675], false)] {
        let request = ViewRequest { size_px, ..request.clone() };
        let small = Settings {
            adapter: Adapter::Software,
            page_budget_in_bytes: mebibytes << 20,
            ..Settings::default()
        };
        let terrain = Terrain::open_to_read(&path, small).unwrap();
        let mut view = terrain.view(request.size_px).unwrap();
        let (mut most_pages, mut most_missing) = (0, 0);
        for request in flight.frames(&request) {
            let drawn = view.draw(&request, &mut Quiet).unwrap();
            most_pages = most_pages.max(drawn.report.num_pages);
            most_missing = most_missing.max(drawn.report.num_missing);
            // The lower half of every picture lies below the horizon. Normals point upwards: their blue is over a half.
            let lower = &drawn.picture.rgb[drawn.picture.rgb.len() / 2..];
            let num_holes = lower.chunks_exact(3).filter(|pixel| pixel[2] < 186).count();
            assert_eq!(num_holes, 0, "{mebibytes} MiB, {:?}", drawn.eye_m);
        }
        assert!(u64::from(most_pages) <= mebibytes * 4, "{mebibytes} MiB: {most_pages} pages of 256 KiB");
        // What had no room is counted, and its place shows coarser ground.
        assert_eq!(most_missing == 0, is_enough, "{mebibytes} MiB: {most_missing}");
    }
}
