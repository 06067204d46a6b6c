//! The largest terrain there may be: it costs what is painted of it, not what could be.

use std::path::Path;

use orogeny_engine::{ExportRequest, MapRequest, Quiet, Terrain, TerrainGrid};
use orogeny_store::Store;
use serde_json::json;
use tiff::decoder::{Decoder, DecodingResult};

use crate::support::{GROUND_M, apply, assert_whole, operation, settings};

const RADIUS_M: f64 = 30.0;
const STRENGTH_M: f64 = 80.0;

/// A terrain edited in its four corners and its middle, closed.
struct Edited {
    /// Where the edits are, in metres.
    places_m: Vec<[f64; 2]>,
    size_in_bytes: u64,
    /// At full resolution, and at all levels.
    num_pages: (u64, u64),
    num_levels_above: u8,
}

fn edit(path: &Path, side: u32) -> Edited {
    let grid = TerrainGrid::new(side.into(), side.into(), 1.0).unwrap();
    let mut terrain = Terrain::create(path, grid, GROUND_M, settings()).unwrap();
    let (near, middle, far) = (40.0, f64::from(side / 2), f64::from(side) - 41.0);
    let places_m = vec![[near, near], [far, near], [near, far], [far, far], [middle, middle]];
    let raise = |place_m: &[f64; 2]| {
        let brush = json!({"type": "raise", "radius": RADIUS_M, "strength": STRENGTH_M});
        operation(json!({"op": "stroke", "brush": brush, "points": [place_m]}))
    };
    // Towards the middle of each, noise, which takes space.
    let roughen = |place_m: &[f64; 2]| {
        let brush = json!({"type": "roughen", "radius": RADIUS_M, "strength": STRENGTH_M});
        let beside_m =
            place_m.map(|along_m| if along_m > middle { along_m - 100.0 } else { along_m + 100.0 });
        operation(json!({"op": "stroke", "brush": brush, "points": [beside_m]}))
    };
    apply(&mut terrain, &places_m.iter().map(raise).collect::<Vec<_>>());
    apply(&mut terrain, &places_m.iter().map(roughen).collect::<Vec<_>>());
    let num_levels_above = terrain.describe().unwrap().num_levels_above;
    terrain.close().unwrap();
    let store = Store::open_to_read(path).unwrap();
    let field = store.layers()[0].heights;
    let num_pages = (store.num_pages(field).unwrap(), store.page_keys(field).unwrap().len() as u64);
    let size_in_bytes = std::fs::metadata(path).unwrap().len();
    Edited { places_m, size_in_bytes, num_pages, num_levels_above }
}

/// The heights of a square of samples around a place, by way of an export.
fn exported(terrain: &Terrain, folder: &Path, [x_m, z_m]: [f64; 2], reach: i32) -> Vec<f32> {
    let file = folder.join("region.tif");
    let side = f64::from(2 * reach + 1);
    let region_m = [x_m - f64::from(reach), z_m - f64::from(reach), side, side];
    let request = ExportRequest { region_m: Some(region_m), ..ExportRequest::new(&file) };
    terrain.export(&request, &mut Quiet).unwrap();
    let mut decoder = Decoder::new(std::io::BufReader::new(std::fs::File::open(&file).unwrap())).unwrap();
    assert_eq!(decoder.dimensions().unwrap(), (side as u32, side as u32));
    let DecodingResult::F32(heights) = decoder.read_image().unwrap() else { panic!("not exported as it is") };
    heights
}

#[test]
fn a_million_samples_a_side_cost_what_is_painted() {
    let folder = tempfile::tempdir().unwrap();
    let (small_path, path) = (folder.path().join("small.orogeny"), folder.path().join("vast.orogeny"));
    let (small, vast) = (edit(&small_path, 4096), edit(&path, 1 << 20));
    let describe = |edited: &Edited| {
        let Edited { size_in_bytes, num_pages: (painted, all), num_levels_above, .. } = edited;
        format!("{size_in_bytes} bytes for {painted} pages, {all} with {num_levels_above} levels above")
    };
    println!("4096 a side: {}", describe(&small));
    println!("2^20 a side: {}", describe(&vast));
    assert_eq!(vast.num_pages.0, small.num_pages.0);
    // On each level an edit reaches into four pages at most.
    let most = vast.places_m.len() as u64 * 4 * (u64::from(vast.num_levels_above) + 1);
    assert!(vast.num_pages.1 <= most, "{} pages, not {most}", vast.num_pages.1);
    // The levels that only the vast one has show the edits as a few samples: they take next to nothing.
    assert!(small.size_in_bytes > 300_000, "too little was painted");
    assert!(vast.size_in_bytes * 2 < small.size_in_bytes * 3);

    assert_whole(&path);
    let terrain = Terrain::open(&path, settings()).unwrap();
    let reach = 40;
    for place_m in &vast.places_m {
        let heights = exported(&terrain, folder.path(), *place_m, reach);
        let side = (2 * reach + 1) as usize;
        let at = |x: usize, z: usize| heights[z * side + x];
        let centre = reach as usize;
        assert_eq!(at(centre, centre), GROUND_M + STRENGTH_M as f32, "at {place_m:?}");
        // Down from the middle to the ground, and not a sample further.
        for x in centre..side - 1 {
            let is_ground = (x - centre) as f64 >= RADIUS_M;
            assert!(at(x + 1, centre) <= at(x, centre), "{x} at {place_m:?}");
            assert_eq!(at(x, centre) == GROUND_M, is_ground, "{x} at {place_m:?}");
        }
        // All edits are alike, wherever they are.
        assert_eq!(heights, exported(&terrain, folder.path(), vast.places_m[0], reach), "at {place_m:?}");
    }
    let request = MapRequest::new(folder.path().join("map.png"));
    let map = terrain.draw_map(&request, &mut Quiet).unwrap();
    println!("the map reads level {} and shows heights of {:?} m", map.level, map.range_m);
    assert_eq!((map.width_px, map.height_px, map.samples_per_px, map.level), (1024, 1024, 1024, 9));
    assert!(map.notices.is_empty() && map.range_m[0] == GROUND_M && map.range_m[1] > GROUND_M, "{map:?}");
}
