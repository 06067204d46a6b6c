//! Filled pits and drained areas: against programs that others wrote (`tests/fixtures/field/make_drainage.py`), against
//! formulas, and what holds for every field.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "this is a test: a panic is how it fails"
)]

use orogeny_field::{FillPits, FlowMask, FlowRouting, Plane, SampleRect, is_storable_height};
use orogeny_reference::field::fill_pits::fill_pits;
use orogeny_reference::field::flow::{flow, flow_mask};
use serde_json::Value;

const ROUTINGS: [FlowRouting; 4] = [
    FlowRouting::Steepest,
    FlowRouting::shared(),
    FlowRouting::Shared { exponent: 0.0 },
    FlowRouting::Shared { exponent: 60.0 },
];

fn plane(width: usize, depth: usize, height: impl Fn(usize, usize) -> f32) -> Plane {
    let rect = SampleRect::new(-3, 7, width as i32 - 3, depth as i32 + 7);
    let samples = (0..width * depth).map(|place| height(place % width, place / width)).collect();
    Plane::from_samples(rect, 1, samples).unwrap()
}

/// 0..1, white.
fn random(x: usize, z: usize, seed: u32) -> f32 {
    let mut mixed = (x as u32).wrapping_mul(0x9e37_79b1) ^ (z as u32).wrapping_mul(0x85eb_ca77) ^ seed;
    for multiplier in [0x2c1b_3c6d_u32, 0x297a_2d39] {
        mixed = (mixed ^ (mixed >> 15)).wrapping_mul(multiplier);
    }
    ((mixed ^ (mixed >> 15)) >> 8) as f32 / 16_777_216.0
}

/// Random values every `size` samples, and straight lines between.
fn smooth(x: usize, z: usize, size: usize, seed: u32) -> f32 {
    let (fx, fz) = ((x % size) as f32 / size as f32, (z % size) as f32 / size as f32);
    let corner = |dx: usize, dz: usize| random(x / size + dx, z / size + dz, seed);
    let row = |dz: usize| corner(0, dz) + (corner(1, dz) - corner(0, dz)) * fx;
    row(0) + (row(1) - row(0)) * fz
}

/// Grounds of many kinds, all with pits: white, smooth, level in parts, below and about 0, thin, high.
fn grounds() -> Vec<(&'static str, Plane)> {
    let hills = |x, z| smooth(x, z, 16, 1) * 90.0 + smooth(x, z, 5, 2) * 30.0 + smooth(x, z, 2, 3) * 4.0;
    vec![
        ("white", plane(83, 71, |x, z| random(x, z, 5) * 100.0)),
        ("steps", plane(64, 90, |x, z| (random(x, z, 6) * 4.0).floor() - 2.0)),
        ("hills", plane(150, 131, hills)),
        ("terraces", plane(131, 150, |x, z| (hills(x, z) / 7.0).floor() * 7.0 - 60.0)),
        ("both zeros", plane(40, 40, |x, z| [0.0, -0.0, 1.0, -1.0][(random(x, z, 7) * 4.0) as usize])),
        ("high", plane(50, 60, |x, z| 8.0e6 + hills(x, z))),
        ("three rows", plane(200, 3, |x, z| random(x, z, 8))),
        ("three columns", plane(3, 200, |x, z| random(x, z, 9) - 10.0)),
        ("two rows", plane(20, 2, |x, z| random(x, z, 9))),
        (
            "first corner",
            plane(12, 9, |x, z| if (x == 0) == (z == 0) && x < 11 && z < 8 { 1.0 } else { 9.0 }),
        ),
        ("last corner", plane(12, 9, |x, z| if (x == 11) == (z == 8) && x.min(z) > 0 { 1.0 } else { 9.0 })),
        ("level", plane(41, 33, |_, _| 12.5)),
        ("one", plane(1, 1, |_, _| -4.0)),
        ("none", plane(0, 0, |_, _| 0.0)),
    ]
}

fn sides(plane: &Plane) -> [usize; 2] {
    [plane.rect().width() as usize, plane.rect().depth() as usize]
}

fn is_border([width, depth]: [usize; 2], place: usize) -> bool {
    let (x, z) = (place % width, place / width);
    x == 0 || z == 0 || x == width - 1 || z == depth - 1
}

fn around([width, depth]: [usize; 2], place: usize) -> impl Iterator<Item = (usize, f64)> {
    let (x, z) = ((place % width) as isize, (place / width) as isize);
    let steps = (0..9_isize).filter(|step| *step != 4).map(|step| (step % 3 - 1, step / 3 - 1));
    steps
        .map(move |(dx, dz)| (x + dx, z + dz, ((dx * dx + dz * dz) as f64).sqrt()))
        .filter(move |(x, z, _)| (0..width as isize).contains(x) && (0..depth as isize).contains(z))
        .map(move |(x, z, distance)| (z as usize * width + x as usize, distance))
}

fn filled(ground: &Plane, options: &FillPits) -> Plane {
    let mut heights = ground.clone();
    fill_pits(&mut heights, options);
    heights
}

/// The plainest way to the same heights: all that is not fixed starts at infinity and sinks as far as its neighbours let it,
/// until nothing changes.
fn relaxed(ground: &Plane, slope_m: f32, is_fixed: impl Fn(usize) -> bool) -> Vec<f32> {
    let (sides, ground) = (sides(ground), ground.samples());
    let above = |height: f32| {
        let mut above = (f64::from(height) + f64::from(slope_m)) as f32;
        while f64::from(above) - f64::from(height) < f64::from(slope_m) {
            above = above.next_up();
        }
        if slope_m > 0.0 && above <= height { height.next_up() } else { above }
    };
    let mut heights: Vec<f32> =
        (0..ground.len()).map(|place| if is_fixed(place) { ground[place] } else { f32::INFINITY }).collect();
    loop {
        let mut has_changed = false;
        let mut relax = |place: usize| {
            for (neighbour, _) in around(sides, place) {
                let way = heights[neighbour];
                let height = if way < ground[place] { ground[place] } else { above(way) };
                if height < heights[place] {
                    heights[place] = height;
                    has_changed = true;
                }
            }
        };
        (0..ground.len()).for_each(&mut relax);
        (0..ground.len()).rev().for_each(&mut relax);
        if !has_changed {
            return heights;
        }
    }
}

/// The lakes of a filled ground: for each sample the depth of the one that it is in, 0 outside.
fn lake_depths(ground: &Plane, filled: &Plane) -> Vec<f32> {
    let (sides, ground, filled) = (sides(ground), ground.samples(), filled.samples());
    let mut depths = vec![0.0; ground.len()];
    for first in 0..ground.len() {
        if filled[first] > ground[first] && depths[first] == 0.0 {
            let mut lake = vec![first];
            depths[first] = -1.0;
            let mut num_seen = 0;
            while num_seen < lake.len() {
                for (neighbour, _) in around(sides, lake[num_seen]) {
                    if filled[neighbour] > ground[neighbour] && depths[neighbour] == 0.0 {
                        depths[neighbour] = -1.0;
                        lake.push(neighbour);
                    }
                }
                num_seen += 1;
            }
            let depth = lake.iter().map(|place| filled[*place] - ground[*place]).fold(0.0, f32::max);
            for place in lake {
                depths[place] = depth;
            }
        }
    }
    depths
}

fn fixture(kind: &str) -> Vec<Value> {
    let path =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/field/drainage.json");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|err| panic!("{}: {err}", path.display()));
    let mut cases: Value = serde_json::from_str(&text).unwrap();
    let cases = cases[kind].as_array_mut().unwrap().split_off(0);
    assert!(!cases.is_empty(), "an empty fixture proves nothing");
    cases
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn ground_of(case: &Value) -> Plane {
    let side = |name: &str| case[name].as_u64().unwrap() as usize;
    let (width, heights) = (side("width"), numbers(&case["heights"]));
    plane(width, side("depth"), |x, z| (heights[z * width + x] / 64.0) as f32)
}

#[test]
fn pits_are_filled_as_by_morphological_reconstruction() {
    for case in fixture("fill") {
        let ground = ground_of(&case);
        let expected: Vec<f32> =
            numbers(&case["filled"]).into_iter().map(|height| (height / 64.0) as f32).collect();
        assert_ne!(ground.samples(), expected);
        assert_eq!(filled(&ground, &FillPits::default()).samples(), expected);
    }
}

#[test]
fn pits_are_filled_as_by_plain_relaxation() {
    for (name, ground) in grounds() {
        let sides = sides(&ground);
        for slope_m in [0.0, 1.0e-6, 0.01, 0.5, 20.0] {
            let expected = relaxed(&ground, slope_m, |place| is_border(sides, place));
            let found = filled(&ground, &FillPits { slope_m, ..FillPits::default() });
            assert_eq!(found.samples(), expected, "{name}, slope {slope_m}");
        }
    }
}

#[test]
fn filling_lowers_nothing_and_leaves_the_bits_of_what_is_in_no_pit() {
    for (name, ground) in grounds() {
        let sides = sides(&ground);
        let level = filled(&ground, &FillPits::default());
        assert_eq!(filled(&level, &FillPits::default()), level, "{name}");
        for slope_m in [0.0, 0.01] {
            let found = filled(&ground, &FillPits { slope_m, ..FillPits::default() });
            for (place, (before, after)) in ground.samples().iter().zip(found.samples()).enumerate() {
                assert!(after >= before && is_storable_height(*after), "{name}: {before} to {after}");
                let stays = is_border(sides, place) || (slope_m == 0.0 && after == before);
                assert!(!stays || after.to_bits() == before.to_bits(), "{name}: {before} to {after}");
                let lowest =
                    around(sides, place).map(|(at, _)| found.samples()[at]).fold(f32::INFINITY, f32::min);
                let has_way = if slope_m == 0.0 { lowest <= *after } else { lowest < *after };
                assert!(is_border(sides, place) || has_way, "{name}: {after} has no way out");
                let is_steep = f64::from(*after) - f64::from(lowest) >= f64::from(slope_m);
                assert!(after == before || is_steep, "{name}: {after} over {lowest}");
            }
        }
    }
}

#[test]
fn pits_deeper_than_wanted_are_left() {
    let mut num_kept = 0;
    for (name, ground) in grounds() {
        let sides = sides(&ground);
        let level = filled(&ground, &FillPits::default());
        let depths = lake_depths(&ground, &level);
        let deepest = depths.iter().fold(0.0_f32, |deepest, depth| deepest.max(*depth));
        for max_depth_m in [0.0, deepest * 0.3, deepest * 0.999, deepest] {
            let is_kept = |place: usize| depths[place] > max_depth_m;
            let heights = [ground.samples(), level.samples()];
            let expected: Vec<f32> =
                (0..depths.len()).map(|place| heights[usize::from(!is_kept(place))][place]).collect();
            let options = FillPits { max_depth_m: Some(max_depth_m), ..FillPits::default() };
            assert_eq!(filled(&ground, &options).samples(), expected, "{name}, {max_depth_m}");
            num_kept += (0..depths.len()).filter(|place| is_kept(*place)).count();
            // With a slope, what is not in a lake that stays drains over the border or into one.
            for slope_m in [0.001, 0.5] {
                let expected = relaxed(&ground, slope_m, |place| is_border(sides, place) || is_kept(place));
                let found = filled(&ground, &FillPits { slope_m, ..options });
                assert_eq!(found.samples(), expected, "{name}, {max_depth_m}, slope {slope_m}");
            }
        }
    }
    assert!(num_kept > 1000, "{num_kept}");
}

#[test]
fn a_pit_is_filled_to_its_lowest_rim() {
    // A funnel whose rim is lowest at (28, 12), where a gorge leads out of it.
    let ground = plane(41, 25, |x, z| {
        let from_centre = ((x as f32 - 20.0).powi(2) + (z as f32 - 12.0).powi(2)).sqrt();
        let cone = if from_centre <= 10.0 { from_centre } else { 20.0 - from_centre };
        if z == 12 && x >= 28 { 7.25 - (x - 28) as f32 * 0.5 } else { cone }
    });
    let found = filled(&ground, &FillPits::default());
    for (x, z, expected) in [(20, 12, 7.25), (25, 12, 7.25), (13, 12, 7.25), (20, 4, 8.0), (28, 12, 7.25)] {
        assert_eq!(found.at(x - 3, z + 7), Some(expected), "({x}, {z})");
    }
    let tilted = filled(&ground, &FillPits { slope_m: 0.125, ..FillPits::default() });
    // As many steps from the gorge as there are columns between: neighbours may be diagonal.
    for (x, z, expected) in [(27, 12, 7.375), (20, 12, 8.25), (25, 9, 7.625), (28, 12, 7.25)] {
        assert_eq!(tilted.at(x - 3, z + 7), Some(expected), "({x}, {z})");
    }
}

#[test]
fn what_is_no_height_goes_neither_in_nor_out() {
    let ground = plane(30, 30, |x, z| match (x * 7 + z * 3) % 11 {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => f32::NEG_INFINITY,
        _ => random(x, z, 3),
    });
    for slope_m in [0.0, 0.1, f32::NAN, f32::INFINITY, -1.0] {
        for max_depth_m in [None, Some(f32::NAN), Some(-1.0), Some(0.5)] {
            let found = filled(&ground, &FillPits { slope_m, max_depth_m });
            assert!(found.samples().iter().all(|height| is_storable_height(*height)), "{slope_m}");
        }
    }
    for routing in ROUTINGS.into_iter().chain([f32::NAN, f32::INFINITY, -2.0].map(shared_by)) {
        let areas = flow(&ground, routing);
        assert!(areas.samples().iter().all(|area| (1.0..=900.0).contains(area)), "{routing:?}");
    }
}

const fn shared_by(exponent: f32) -> FlowRouting {
    FlowRouting::Shared { exponent }
}

#[test]
fn only_the_first_channel_is_filled() {
    let rect = SampleRect::new(0, 0, 5, 5);
    let mut heights = Plane::with_channels(rect, 2, 3.0);
    for row in [2, 7] {
        heights.samples_mut()[row * 5 + 2] = -1.0;
    }
    fill_pits(&mut heights, &FillPits::default());
    assert_eq!((heights.at(2, 2), heights.channel_row(1, 2).unwrap()[2]), (Some(3.0), -1.0));
    assert_eq!(flow(&heights, FlowRouting::Steepest).num_channels(), 1);
}

#[test]
fn areas_match_those_of_pysheds() {
    for case in fixture("flow") {
        let ground = ground_of(&case);
        let steepest: Vec<f32> = numbers(&case["steepest"]).into_iter().map(|area| area as f32).collect();
        assert_eq!(flow(&ground, FlowRouting::Steepest).samples(), steepest);
        for shared in case["shared"].as_array().unwrap() {
            let exponent = shared["exponent"].as_f64().unwrap() as f32;
            let found = flow(&ground, FlowRouting::Shared { exponent });
            for (expected, found) in numbers(&shared["areas"]).into_iter().zip(found.samples()) {
                let error = (f64::from(*found) - expected).abs() / expected;
                let tolerance = 1.0e-5 + f64::from(exponent * exponent) / 32768.0;
                assert!(error < tolerance, "exponent {exponent}: pysheds {expected}, found {found}");
            }
        }
    }
}

#[test]
fn no_water_stays_inside() {
    for (name, ground) in grounds() {
        let sides = sides(&ground);
        for routing in ROUTINGS {
            let areas = flow(&ground, routing);
            assert_eq!(areas.rect(), ground.rect());
            let area = ground.rect().area() as f64;
            assert!(areas.samples().iter().all(|own| (1.0..=area as f32).contains(own)), "{name}");
            let out: f64 = (0..areas.samples().len())
                .filter(|place| is_border(sides, *place))
                .map(|place| f64::from(areas.samples()[place]))
                .sum();
            let tolerance = if routing == FlowRouting::Steepest { 0.0 } else { 1.0e-7 * area };
            assert!((out - area).abs() <= tolerance, "{name}, {routing:?}: {out} of {area}");
            assert_eq!(flow(&ground, routing), areas, "{name}, {routing:?}");
        }
    }
}

#[test]
fn areas_grow_down_the_steepest_way() {
    for (name, ground) in grounds() {
        let sides = sides(&ground);
        let surface = filled(&ground, &FillPits::default());
        let surface = surface.samples();
        let areas = flow(&ground, FlowRouting::Steepest);
        let areas = areas.samples();
        for place in (0..areas.len()).filter(|place| !is_border(sides, *place)) {
            let slope = |(at, distance): (usize, f64)| {
                (f64::from(surface[place]) - f64::from(surface[at])) / distance
            };
            let steepest = around(sides, place).map(slope).fold(f64::NEG_INFINITY, f64::max);
            let largest = around(sides, place)
                .filter(|neighbour| slope(*neighbour) >= steepest * (1.0 - 1.0e-6))
                .map(|(at, _)| areas[at])
                .fold(0.0, f32::max);
            assert!(steepest >= 0.0 && largest > areas[place], "{name}: {} to {largest}", areas[place]);
        }
    }
}

#[test]
fn a_tilted_plane_drains_along_its_rows() {
    let (width, depth) = (30, 20);
    let areas = flow(&plane(width, depth, |x, z| x as f32 * 2.0 + z as f32 * 0.5), FlowRouting::Steepest);
    for (place, area) in areas.samples().iter().enumerate() {
        let (x, z) = (place % width, place / width);
        let inside = (1..depth - 1).contains(&z) && x < width - 1;
        let expected = if inside { (width - 1 - x).min(width - 1) as f32 } else { 1.0 };
        assert_eq!(*area, expected, "({x}, {z})");
    }
}

#[test]
fn a_valley_gathers_both_sides() {
    let (width, depth, middle) = (31, 40, 12);
    let ground = plane(width, depth, |x, z| x.abs_diff(middle) as f32 + z as f32 * 0.125);
    let areas = flow(&ground, FlowRouting::Steepest);
    for z in 0..depth - 1 {
        let expected = ((depth - 1 - z).min(depth - 2) * (width - 2) + usize::from(z == 0)) as f32;
        assert_eq!(areas.samples()[z * width + middle], expected, "row {z}");
    }
    // Shared, the valley gets as much but for what runs out at the sides.
    let shared = flow(&ground, FlowRouting::shared());
    let mouth: f32 = shared.samples()[..width].iter().sum();
    assert!(mouth > 0.9 * areas.samples()[middle], "{mouth}");
}

#[test]
fn a_cone_sheds_water_evenly() {
    let side = 161;
    let ground = plane(side, side, |x, z| 1000.0 - (x as f32 - 80.0).hypot(z as f32 - 80.0));
    let areas = flow(&ground, FlowRouting::shared());
    let area = |x: usize, z: usize| areas.samples()[z * side + x];
    for z in 1..80 {
        for x in 1..80 {
            let radius = (x as f32 - 80.0).hypot(z as f32 - 80.0);
            let same = [area(160 - x, z), area(x, 160 - z), area(160 - x, 160 - z), area(z, x)];
            for other in same {
                assert!((other - area(x, z)).abs() < 1.0e-4 * other, "({x}, {z})");
            }
            // The circle of a radius drains pi r^2 over 2 pi r.
            let ratio = area(x, z) / (radius / 2.0);
            assert!(!(8.0..79.0).contains(&radius) || (0.75..1.35).contains(&ratio), "({x}, {z}): {ratio}");
        }
    }
}

#[test]
fn a_lake_has_one_outlet() {
    let (width, depth) = (40, 30);
    let basin = plane(width, depth, |x, z| match (x, z) {
        (17, 0) => 50.0,
        _ if x == 0 || z == 0 || x == width - 1 || z == depth - 1 => 100.0,
        _ => 20.0 + random(x, z, 4),
    });
    for routing in ROUTINGS {
        let areas = flow(&basin, routing);
        assert_eq!(areas.samples()[17], ((width - 2) * (depth - 2) + 1) as f32, "{routing:?}");
    }
}

#[test]
fn a_river_crosses_a_lake_along_its_bed() {
    // A winding trench from end to end, dammed at one: a lake with a bed that a river has to follow.
    let (width, depth) = (60, 21);
    let middle = |x: usize| 10.0 + 5.0 * (x as f32 * 0.2).sin();
    let ground = plane(width, depth, |x, z| {
        let bed = (z as f32 - middle(x)).abs() * 3.0 + x as f32 * 0.01;
        if x < 4 { bed.max(12.0) } else { bed }
    });
    let areas = flow(&ground, FlowRouting::Steepest);
    for x in 8..width - 6 {
        let column: Vec<f32> = (1..depth - 1).map(|z| areas.samples()[z * width + x]).collect();
        let largest = (0..column.len()).max_by(|a, b| column[*a].total_cmp(&column[*b])).unwrap();
        assert!(((largest + 1) as f32 - middle(x)).abs() < 1.6, "column {x}: row {}", largest + 1);
    }
}

#[test]
fn masks_are_logarithms_of_areas_within_bounds() {
    let areas = [0.0, 1.0, 25.0, 250.0, 2500.0, 25_000.0, 250_000.0, 1.0e12, f32::INFINITY, f32::NAN];
    let areas = Plane::from_samples(SampleRect::new(0, 0, 10, 1), 1, areas.to_vec()).unwrap();
    // Samples of 4 m²: 25 of them are 100 m², 250,000 are 1 km².
    let mask = flow_mask(&areas, 2.0, &FlowMask { from_m2: 100.0, to_m2: 1.0e6 });
    let expected = [0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0, 0.0];
    for (found, expected) in mask.samples().iter().zip(expected) {
        let is_bound = expected == 0.0 || expected == 1.0;
        assert!((found - expected).abs() <= if is_bound { 0.0 } else { 1.0e-6 }, "{found}, not {expected}");
    }
    // Bounds that are none make a step.
    for (from_m2, to_m2) in [(1.0e4, 1.0e4), (1.0e4, 10.0), (1.0e4, f32::NAN), (f32::NAN, 1.0)] {
        let mask = flow_mask(&areas, 2.0, &FlowMask { from_m2, to_m2 });
        assert!(mask.samples().iter().all(|value| (0.0..=1.0).contains(value)), "{from_m2}, {to_m2}");
    }
    let rising: Vec<f32> = (1..5000).map(|area| area as f32).collect();
    let rising = Plane::from_samples(SampleRect::new(0, 0, 4999, 1), 1, rising).unwrap();
    let mask = flow_mask(&rising, 1.0, &FlowMask { from_m2: 10.0, to_m2: 4000.0 });
    assert!(mask.samples().windows(2).all(|pair| pair[0] <= pair[1]));
}
