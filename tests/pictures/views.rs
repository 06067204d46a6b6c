//! Terrains and pictures of them, by way of the engine.

use std::path::Path;

use orogeny_engine::{
    Adapter, Drawn, HeightAt, ImportOptions, ImportRequest, Operation, Place, Quiet, Settings, Terrain,
    TerrainGrid, ViewRequest,
};
use orogeny_tests::repository;
use serde_json::json;

pub fn settings() -> Settings {
    Settings { adapter: Adapter::Software, ..Settings::default() }
}

/// The bundled real terrain, 1024 x 1024 samples 28 m apart.
pub fn frazier(folder: &Path) -> Terrain {
    imported(folder, &repository().join("assets/terrain/frazier_1024_int16.tif"))
}

pub fn imported(folder: &Path, file: &Path) -> Terrain {
    let options = ImportOptions { spacing_m: Some(28.0), ..ImportOptions::default() };
    let request = ImportRequest { file: file.to_owned(), options, layer: None, at_m: [0.0, 0.0] };
    let path = folder.join("real.orogeny");
    let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let (terrain, _) = Terrain::from_raster(&path, &request, settings, &mut Quiet).unwrap();
    terrain.close().unwrap();
    Terrain::open_to_read(&path, self::settings()).unwrap()
}

pub fn place(x_m: f64, height: HeightAt, z_m: f64) -> Option<Place> {
    Some(Place { x_m, height, z_m })
}

pub fn draw(terrain: &Terrain, request: &ViewRequest) -> Drawn {
    terrain.view(request.size_px).unwrap().draw(request, &mut Quiet).unwrap()
}

/// The mean and the largest difference of two pictures' channels, 0..=255.
pub fn difference(a: &[u8], b: &[u8]) -> (f64, u8) {
    assert_eq!(a.len(), b.len());
    let apart = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    let (sum, largest) = apart.fold((0_u64, 0), |(sum, max), apart| (sum + u64::from(apart), max.max(apart)));
    (sum as f64 / a.len().max(1) as f64, largest)
}

#[test]
fn far_from_the_origin_a_place_looks_as_near_it() {
    let folder = tempfile::tempdir().unwrap();
    // A whole number of coarsest tiles away, so that levels fall alike.
    let away = 1_u32 << 19;
    let mound = |at: u32| {
        let at = f64::from(at) + 300.3;
        let brush = json!({"type": "raise", "radius": 150, "strength": 60, "profile": "smooth"});
        Operation::from_json(
            json!({"op": "stroke", "brush": brush, "points": [[at, at], [at + 90.0, at + 20.0]]}),
        )
        .unwrap()
    };
    let seen_from = |at: u32| {
        let at = f64::from(at);
        ViewRequest {
            size_px: [160, 90],
            eye: place(at + 120.25, HeightAt::Absolute(45.0), at + 520.5),
            target: place(at + 330.0, HeightAt::Absolute(40.0), at + 300.0),
            ..ViewRequest::default()
        }
    };
    let picture = |name: &str, side: u64, at: u32| {
        let grid = TerrainGrid::new(side, side, 1.0).unwrap();
        let mut terrain = Terrain::create(&folder.path().join(name), grid, 10.0, settings_cpu()).unwrap();
        terrain.apply(&[mound(at)], &mut Quiet).unwrap();
        terrain.close().unwrap();
        let terrain = Terrain::open_to_read(&folder.path().join(name), settings()).unwrap();
        let request = ViewRequest { range_m: Some([10.0, 70.0]), ..seen_from(at) };
        draw(&terrain, &request).picture
    };
    let near = picture("near.orogeny", (1 << 19) + 4096, 1024);
    let far = picture("far.orogeny", 1 << 20, away + 1024);
    let (mean, _) = difference(&near.rgb, &far.rgb);
    // What noise of materials makes of a place is its own at every place; light and shape are not.
    assert!(mean < 8.0, "{mean}");
    let shaded = |name: &str, at: u32| {
        let terrain = Terrain::open_to_read(&folder.path().join(name), settings()).unwrap();
        let request = ViewRequest {
            mode: orogeny_engine::Mode::Shaded,
            // Texels of shadow maps are as large as the terrain's end is far.
            has_shadows: false,
            ..seen_from(at)
        };
        draw(&terrain, &request).picture
    };
    // Below the horizon, which lies where the terrain ends.
    let lower = |picture: &orogeny_engine::Picture| picture.rgb[picture.rgb.len() * 11 / 20..].to_vec();
    let (near, far) = (shaded("near.orogeny", 1024), shaded("far.orogeny", away + 1024));
    let (mean, _) = difference(&lower(&near), &lower(&far));
    assert!(mean < 0.25, "{mean}");
}

fn settings_cpu() -> Settings {
    Settings { adapter: Adapter::Cpu, ..Settings::default() }
}

#[test]
fn a_terrain_of_one_sample_and_one_of_a_row_can_be_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for (name, width, depth) in [("one", 1, 1), ("row", 300, 1), ("small", 2, 3)] {
        let path = folder.path().join(format!("{name}.orogeny"));
        let grid = TerrainGrid::new(width, depth, 1.0).unwrap();
        Terrain::create(&path, grid, 5.0, settings_cpu()).unwrap().close().unwrap();
        let terrain = Terrain::open_to_read(&path, settings()).unwrap();
        let request = ViewRequest { size_px: [40, 30], ..ViewRequest::default() };
        let drawn = draw(&terrain, &request);
        assert_eq!(drawn.picture.rgb.len(), 40 * 30 * 3, "{name}");
        // Sky, if nothing else: not what a texture holds that was never drawn to.
        assert!(drawn.picture.rgb.iter().any(|channel| *channel > 20), "{name}");
    }
}
