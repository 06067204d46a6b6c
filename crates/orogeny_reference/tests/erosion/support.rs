//! Grounds to erode, regions and rows to cut them into, and what the fixtures hold.

use orogeny_field::hash::{signed_uniform, uniform};
use orogeny_field::{Plane, SampleRect};
use serde_json::Value;

/// What is in a row before it is written: no height, and no part of one.
pub const SENTINEL: f32 = f32::NAN;
/// How a row is cut when it is: shorter, as long and longer than what is worked on at once.
const CUTS: [usize; 6] = [1, 63, 64, 5, 130, 2];

/// What is cut into windows.
pub const REGION: SampleRect = SampleRect { x0: -3, z0: 5, x1: 147, z1: 68 };

pub fn plane(rect: SampleRect, of: impl Fn(i32, i32) -> f32) -> Plane {
    let places = (rect.z0..rect.z1).flat_map(|z| (rect.x0..rect.x1).map(move |x| (x, z)));
    Plane::from_samples(rect, 1, places.map(|(x, z)| of(x, z)).collect()).unwrap()
}

/// A part of a plane.
pub fn part(whole: &Plane, rect: SampleRect) -> Plane {
    let mut samples = Vec::new();
    for channel in 0..whole.num_channels() {
        for z in rect.z0..rect.z1 {
            let row = whole.channel_row(channel, z).unwrap();
            let first = (rect.x0 - whole.rect().x0) as usize;
            samples.extend_from_slice(&row[first..first + rect.width() as usize]);
        }
    }
    Plane::from_samples(rect, whole.num_channels(), samples).unwrap()
}

pub fn bits(plane: &Plane) -> Vec<u32> {
    plane.samples().iter().map(|value| value.to_bits()).collect()
}

pub fn total(plane: &Plane) -> f64 {
    plane.samples().iter().map(|value| f64::from(*value)).sum()
}

pub fn lowest(plane: &Plane) -> f32 {
    plane.samples().iter().copied().fold(f32::INFINITY, f32::min)
}

pub fn highest(plane: &Plane) -> f32 {
    plane.samples().iter().copied().fold(f32::NEG_INFINITY, f32::max)
}

/// White noise: as rough as ground can be.
pub fn rough(rect: SampleRect, seed: u32, relief_m: f32) -> Plane {
    plane(rect, |x, z| 700.0 + relief_m * uniform(x as u32, z as u32, seed))
}

/// Single samples far above and below a plain.
pub fn spiky(rect: SampleRect, seed: u32) -> Plane {
    plane(rect, |x, z| {
        let chance = uniform(x as u32, z as u32, seed);
        50.0 + if chance > 0.95 {
            900.0
        } else if chance < 0.05 {
            -300.0
        } else {
            chance
        }
    })
}

/// Hills of every size, as in real ground: half as high at half the width.
pub fn hilly(rect: SampleRect, seed: u32, relief_m: f32) -> Plane {
    plane(rect, |x, z| {
        let mut height_m = 900.0;
        for octave in 0..6 {
            let cell = 64 >> octave;
            let at = |i: i32, j: i32| signed_uniform(i as u32, j as u32, seed + octave);
            let (i, j) = (x.div_euclid(cell), z.div_euclid(cell));
            let (u, v) = (x.rem_euclid(cell) as f32 / cell as f32, z.rem_euclid(cell) as f32 / cell as f32);
            let north = at(i, j) + u * (at(i + 1, j) - at(i, j));
            let south = at(i, j + 1) + u * (at(i + 1, j + 1) - at(i, j + 1));
            height_m += (north + v * (south - north)) * relief_m * 0.5_f32.powi(octave as i32);
        }
        height_m
    })
}

pub fn hardness_of(rect: SampleRect) -> Plane {
    plane(rect, |x, z| uniform(x as u32, z as u32, 77))
}

pub fn fixture(name: &str) -> (SampleRect, u32, Vec<Value>) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/field").join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|err| panic!("{}: {err}", path.display()));
    let file: Value = serde_json::from_str(&text).unwrap();
    let cases = file["cases"].as_array().unwrap().clone();
    assert!(!cases.is_empty(), "an empty fixture proves nothing");
    let rect = SampleRect::new(0, 0, number(&file["width"]) as i32, number(&file["depth"]) as i32);
    (rect, number(&file["iterations"]) as u32, cases)
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The ground of the fixtures.
pub fn fixture_ground(rect: SampleRect) -> Plane {
    plane(rect, |x, z| {
        let (x, z) = (i64::from(x), i64::from(z));
        let mixed = (x * 7919 + z * 104_729 + x * z * 31) % 65_536;
        (((x - 9).pow(2) + 2 * (z - 12).pow(2)) as f64 * 0.25 + mixed as f64 / 4096.0 + 100.0) as f32
    })
}

pub fn fixture_hardness(rect: SampleRect, case: &Value) -> Option<Plane> {
    case["hard"].as_bool().unwrap().then(|| plane(rect, |x, z| ((x + 2 * z) % 5) as f32 / 4.0))
}

pub fn assert_near(found: &Plane, expected: &Value, tolerance_m: f64, what: &str) {
    let expected = expected.as_array().unwrap();
    assert_eq!(expected.len(), found.samples().len());
    let mut worst: f64 = 0.0;
    for (found, expected) in found.samples().iter().zip(expected) {
        worst = worst.max((f64::from(*found) - number(expected)).abs());
        assert!(found.is_finite());
    }
    assert!(worst <= tolerance_m, "{what}: {worst} m");
}

/// Rows, cut or whole.
pub fn pieces(width: usize, is_cut: bool) -> Vec<(usize, usize)> {
    let mut lengths = CUTS.iter().cycle();
    let mut pieces = Vec::new();
    let mut first = 0;
    while first < width {
        let length = if is_cut { *lengths.next().unwrap() } else { width };
        pieces.push((first, width.min(first + length)));
        first += length;
    }
    pieces
}

/// Windows of a region: within, at a side, in a corner.
pub fn windows() -> [SampleRect; 3] {
    [SampleRect::new(30, 20, 101, 40), SampleRect::new(-3, 31, 5, 48), SampleRect::new(90, 40, 147, 68)]
}
