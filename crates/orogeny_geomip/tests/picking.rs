//! Picking beside a plain march along the ray, far from the origin.

#![expect(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "helpers of tests, which clippy does not take for tests"
)]

use glam::DVec3;
use orogeny_field::{HeightBounds, TerrainGrid, hash};
use orogeny_geomip::{Ground, Ray, Tile, pick};
use proptest::prelude::*;

/// Rough ground over 2^20 samples a side, which no one could keep.
struct Vast {
    grid: TerrainGrid,
    relief_m: f32,
}

impl Ground for Vast {
    fn bounds(&self, _: Tile) -> HeightBounds {
        HeightBounds { min_m: -self.relief_m, max_m: 2.0 * self.relief_m }
    }

    fn height_m(&self, [x, z]: [u32; 2]) -> f32 {
        let wave = ((x % 1000) as f32 / 20.0).sin() * ((z % 1000) as f32 / 17.0).cos();
        self.relief_m * (wave + hash::uniform(x, z, 9))
    }
}

/// Hills, a plain and a cliff whose tiles have their very bounds.
struct Small {
    grid: TerrainGrid,
    heights: Vec<f32>,
}

impl Small {
    fn new(spacing_m: f64) -> Self {
        let (width, depth) = (200, 150);
        let height = |x: u32, z: u32| {
            let hills = 12.0 * (x as f32 / 9.0).sin() * (z as f32 / 7.0).cos() + 3.0 * hash::uniform(x, z, 1);
            if x < 70 {
                hills
            } else if z < 60 {
                5.0
            } else {
                60.0
            }
        };
        let heights =
            (0..depth).flat_map(|z| (0..width).map(move |x| (x, z))).map(|(x, z)| height(x, z)).collect();
        Self { grid: TerrainGrid::new(width.into(), depth.into(), spacing_m).unwrap(), heights }
    }
}

impl Ground for Small {
    fn bounds(&self, tile: Tile) -> HeightBounds {
        let [first, last] = tile.samples(&self.grid).unwrap();
        let samples = (first[1]..=last[1]).flat_map(|z| (first[0]..=last[0]).map(move |x| [x, z]));
        samples.map(|sample| HeightBounds::of(self.height_m(sample))).reduce(HeightBounds::with).unwrap()
    }

    fn height_m(&self, [x, z]: [u32; 2]) -> f32 {
        self.heights[(z * self.grid.width() + x) as usize]
    }
}

/// The bilinear ground at a place, metres; a billionth of a sample beyond the border too.
fn height_at(grid: &TerrainGrid, ground: &impl Ground, [x_m, z_m]: [f64; 2]) -> Option<f64> {
    let places = [(x_m, grid.width()), (z_m, grid.depth())].map(|(place, num)| {
        let (place, last) = (place / grid.spacing_m(), f64::from(num - 1));
        (-1.0e-9..=last + 1.0e-9).contains(&place).then(|| place.clamp(0.0, last))
    });
    let [Some(x), Some(z)] = places else { return None };
    let cell = [(x, grid.width()), (z, grid.depth())].map(|(place, num)| (place.floor() as u32).min(num - 2));
    let (fx, fz) = (x - f64::from(cell[0]), z - f64::from(cell[1]));
    let height = |dx: u32, dz: u32| f64::from(ground.height_m([cell[0] + dx, cell[1] + dz]));
    let north = height(0, 0) * (1.0 - fx) + height(1, 0) * fx;
    let south = height(0, 1) * (1.0 - fx) + height(1, 1) * fx;
    Some(north * (1.0 - fz) + south * fz)
}

/// How far a point of a ray is above the ground.
fn above(grid: &TerrainGrid, ground: &impl Ground, ray: &Ray, distance_m: f64) -> Option<f64> {
    let point = ray.origin_m + ray.direction * distance_m;
    Some(point.y - height_at(grid, ground, [point.x, point.z])?)
}

/// The first change of sign, step by step.
fn march(grid: &TerrainGrid, ground: &impl Ground, ray: &Ray, [length_m, step_m]: [f64; 2]) -> Option<f64> {
    let above = |distance_m| above(grid, ground, ray, distance_m);
    let mut before: Option<f64> = None;
    for step in 0..(length_m / step_m) as u32 {
        let mut last = f64::from(step) * step_m;
        let now = above(last);
        if let (Some(first), Some(now)) = (before, now)
            && (first > 0.0) != (now > 0.0)
        {
            let mut from = last - step_m;
            for _ in 0..50 {
                let middle = f64::midpoint(from, last);
                if (above(middle)? > 0.0) == (first > 0.0) { from = middle } else { last = middle }
            }
            return Some(last);
        }
        before = now;
    }
    None
}

/// Checks that what is picked is the first point of the ground that a march finds, or one that it steps over.
fn check(
    grid: &TerrainGrid,
    ground: &impl Ground,
    ray: &Ray,
    march_m: [f64; 2],
) -> Result<(), TestCaseError> {
    let found = pick(ray, grid, ground);
    let marched = march(grid, ground, ray, march_m);
    if let Some(marched) = marched {
        prop_assert!(found.is_some_and(|found| found <= marched + 1.0e-3), "{found:?} and {marched}");
    }
    if let Some(found) = found {
        let off = above(grid, ground, ray, found);
        prop_assert!(off.is_some_and(|off| off.abs() < 1.0e-3), "{off:?} above the ground at {found}");
        let [length_m, step_m] = march_m;
        if found < length_m - step_m && marched.is_none_or(|marched| found < marched - 1.0e-3) {
            // Between two steps it goes through twice, or at the border it begins or ends within the ground.
            let around = [found - step_m, found + step_m].map(|at| above(grid, ground, ray, at));
            if let [Some(before), Some(after)] = around {
                prop_assert!(before * after >= 0.0, "{around:?}: it goes through at {found}, {marched:?}");
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_million_metres_away_the_first_point_of_the_ground_is_found_to_a_millimetre(
        (x, z) in (0.9e6..1.04e6_f64, 0.9e6..1.04e6_f64), relief_m in 0.5..40.0_f32, height_m in 0.0..60.0_f64,
        direction in (-1.0..1.0_f64, -1.0..0.3_f64, -1.0..1.0_f64),
    ) {
        let ground = Vast { grid: TerrainGrid::new(1 << 20, 1 << 20, 1.0).unwrap(), relief_m };
        let start = height_at(&ground.grid, &ground, [x, z]).unwrap();
        let direction = DVec3::new(direction.0, direction.1, direction.2);
        prop_assume!(direction.length() > 0.1);
        let ray = Ray { origin_m: DVec3::new(x, start + height_m + 0.1, z), direction: direction.normalize() };
        check(&ground.grid, &ground, &ray, [300.0, 0.01])?;
    }

    #[test]
    fn from_anywhere_to_anywhere_on_ground_of_any_spacing(
        spacing_m in prop_oneof![Just(0.37), Just(1.0), Just(30.0)],
        from in (-0.5..1.5_f64, -30.0..90.0_f64, -0.5..1.5_f64), to in (0.0..1.0_f64, -20.0..70.0_f64, 0.0..1.0_f64),
    ) {
        let ground = Small::new(spacing_m);
        let extent = [199.0 * spacing_m, 149.0 * spacing_m];
        let place = |(x, y, z): (f64, f64, f64)| DVec3::new(x * extent[0], y, z * extent[1]);
        let (from, to) = (place(from), place(to));
        prop_assume!(from.distance(to) > 1.0);
        let ray = Ray { origin_m: from, direction: (to - from).normalize() };
        let length_m = 3.0 * extent[0].hypot(extent[1]) + 200.0;
        check(&ground.grid, &ground, &ray, [length_m, length_m / 40_000.0])?;
    }
}

#[test]
fn along_a_line_of_samples_a_border_and_a_plain() {
    let ground = Small::new(2.0);
    for (from, towards) in [
        (DVec3::new(300.0, 30.0, 20.0), DVec3::new(0.0, -1.0, 0.2)),
        (DVec3::new(128.0, 40.0, 0.0), DVec3::new(0.0, -0.3, 1.0)),
        (DVec3::new(128.0, 40.0, 128.0), DVec3::new(-1.0, -0.4, 0.0)),
        (DVec3::new(0.0, 50.0, 10.0), DVec3::new(0.0, -0.5, 1.0)),
        (DVec3::new(-500.0, 300.0, 298.0), DVec3::new(1.0, -0.4, 0.0)),
        (DVec3::new(390.0, 5.0, 10.0), DVec3::new(-1.0, 0.0, 0.0)),
    ] {
        let ray = Ray { origin_m: from, direction: towards.normalize() };
        assert!(pick(&ray, &ground.grid, &ground).is_some(), "{ray:?}");
        check(&ground.grid, &ground, &ray, [1500.0, 0.01]).unwrap();
    }
}

#[test]
fn a_ray_of_no_numbers_or_no_direction_meets_nothing() {
    let ground = Small::new(2.0);
    for (origin_m, direction) in [
        (DVec3::NAN, DVec3::NEG_Y),
        (DVec3::new(f64::INFINITY, 0.0, 0.0), DVec3::NEG_X),
        (DVec3::new(10.0, 100.0, 10.0), DVec3::NAN),
        (DVec3::new(10.0, 100.0, 10.0), DVec3::ZERO),
    ] {
        assert_eq!(pick(&Ray { origin_m, direction }, &ground.grid, &ground), None);
    }
}

#[test]
fn straight_down_on_a_sample_a_line_and_a_corner_of_the_terrain() {
    let ground = Vast { grid: TerrainGrid::new(1 << 20, 1 << 20, 1.0).unwrap(), relief_m: 10.0 };
    let last = f64::from((1 << 20) - 1);
    for (x, z) in [(0.0, 0.0), (64.0, 64.0), (1000.5, 64.0), (last, last), (last, 3.25)] {
        let ray = Ray { origin_m: DVec3::new(x, 500.0, z), direction: DVec3::NEG_Y };
        let height = height_at(&ground.grid, &ground, [x, z]).unwrap();
        let found = pick(&ray, &ground.grid, &ground).expect("it is there");
        assert!((500.0 - found - height).abs() < 1.0e-6, "{x}, {z}: {found} and {height}");
    }
    let beside = Ray { origin_m: DVec3::new(-0.5, 500.0, 3.0), direction: DVec3::NEG_Y };
    assert_eq!(pick(&beside, &ground.grid, &ground), None);
    let upwards = Ray { origin_m: DVec3::new(5.0, 500.0, 3.0), direction: DVec3::Y };
    assert_eq!(pick(&upwards, &ground.grid, &ground), None);
}
