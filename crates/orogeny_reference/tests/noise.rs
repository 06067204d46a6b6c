//! Noise against what NumPy makes of the specification (`tests/fixtures/noise/make.py`): in `f64` to the last digits, as rows
//! of `f32` within the tolerance of kernels; and what holds for every noise.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "this is a test: a panic is how it fails"
)]

use orogeny_field::Curve;
use orogeny_field::noise::{
    Basis, Distortion, Gain, Noise, NoiseDirection, NoiseFrame, NoiseKernel, Normalization, Turbulence,
    skewed,
};
use orogeny_reference::noise::basis::{self, Sample};
use orogeny_reference::noise::turbulence::{self, Places};
use orogeny_reference::noise::{LANES, Real, normalization, row};
use serde_json::Value;

fn fixture(name: &str) -> Vec<Value> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/noise").join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|err| panic!("{}: {err}", path.display()));
    let cases: Vec<Value> = serde_json::from_str(&text).unwrap();
    assert!(!cases.is_empty(), "an empty fixture proves nothing");
    cases
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let list = value.as_array().unwrap();
    assert_eq!(list.len(), N);
    std::array::from_fn(|index| list[index].as_f64().unwrap())
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn seed(case: &Value) -> u32 {
    case["seed"].as_u64().unwrap().try_into().unwrap()
}

fn basis_of(case: &Value) -> Basis {
    match case["basis"].as_str().unwrap() {
        "gradient" => Basis::Gradient,
        "value" => Basis::Value,
        "worley" => Basis::Worley,
        "simplex" => Basis::Simplex,
        "simplex_3d" => Basis::Simplex3d,
        "sparse" => Basis::Sparse,
        other => panic!("no basis `{other}`"),
    }
}

fn turbulence_of(value: &Value) -> Turbulence {
    serde_json::from_value(value.clone()).unwrap()
}

fn gain_of(value: &Value) -> Gain {
    value["gain"].as_f64().map_or_else(|| Gain::Hurst(number(&value["hurst"])), Gain::Given)
}

fn noise_of(case: &Value) -> Noise {
    let distortion = &case["distortion"];
    let direction = &case["direction"];
    Noise {
        basis: basis_of(case),
        turbulence: turbulence_of(&case["turbulence"]),
        feature_size_m: case["feature_size"].as_f64().unwrap_or(1.0),
        octaves: number(&case["octaves"]) as u32,
        lacunarity: number(&case["lacunarity"]),
        gain: gain_of(case),
        seed: seed(case),
        normalization: Normalization::Off,
        worley_weights: if case["weights"].is_null() {
            [1.0, 0.0, 0.0, 0.0]
        } else {
            numbers(&case["weights"])
        },
        slice: case["slice"].as_f64().unwrap_or(0.0),
        elevation: number(&case["elevation"]),
        distortion: (!distortion.is_null()).then(|| Distortion {
            turbulence: turbulence_of(&distortion["turbulence"]),
            octaves: number(&distortion["octaves"]) as u32,
            weight: number(&distortion["weight"]),
            lacunarity: number(&distortion["lacunarity"]),
            gain: gain_of(distortion),
        }),
        direction: (!direction.is_null()).then(|| NoiseDirection {
            angle_deg: number(&direction["angle"]),
            follows_stroke: false,
            stretch: number(&direction["stretch"]),
        }),
        offset_m: if case["offset"].is_null() { [0.0; 2] } else { numbers(&case["offset"]) },
        rotation_deg: case["rotation"].as_f64().unwrap_or(0.0),
        ..Noise::default()
    }
}

fn sample<T: Real>(basis: Basis, place: [f64; 3], seed: u32, weights: [f64; 4]) -> Sample<T> {
    let place = skewed(basis, place);
    let cell = place.map(|number| number.floor() as i64 as u32);
    let [fx, fy, fw] = place.map(|number| T::of(number - number.floor()));
    let [x, y, _] = cell;
    match basis {
        Basis::Gradient => basis::gradient([x, y], [fx, fy], seed),
        Basis::Value => basis::value([x, y], [fx, fy], seed),
        Basis::Worley => basis::worley([x, y], [fx, fy], seed, weights.map(T::of)),
        Basis::Simplex => basis::simplex([x, y], [fx, fy], seed),
        Basis::Simplex3d => basis::simplex_3d(cell, [fx, fy, fw], seed),
        Basis::Sparse => basis::sparse([x, y], [fx, fy], seed),
    }
}

#[test]
fn bases_and_their_gradients_match_numpy() {
    let mut num_values = 0;
    for case in fixture("bases.json") {
        let weights = if case["weights"].is_null() { [0.0; 4] } else { numbers(&case["weights"]) };
        let slice = case["slice"].as_f64().unwrap_or(0.0);
        let positions = case["positions"].as_array().unwrap();
        for (index, position) in positions.iter().enumerate() {
            let [x, y] = numbers(position);
            let expected = [
                number(&case["values"][index]),
                number(&case["gradients"][index][0]),
                number(&case["gradients"][index][1]),
            ];
            let found = sample::<f64>(basis_of(&case), [x, y, slice], seed(&case), weights);
            let single = sample::<f32>(basis_of(&case), [x, y, slice], seed(&case), weights);
            let pairs = [(found.value, single.value), (found.dx, single.dx), (found.dy, single.dy)];
            for (expected, (found, single)) in expected.into_iter().zip(pairs) {
                let what = format!("{} at [{x}, {y}], seed {}", case["basis"], seed(&case));
                assert!((found - expected).abs() < 1.0e-8, "{what}: NumPy {expected}, found {found}");
                let single = f64::from(single);
                assert!(
                    (single - expected).abs() < 2.0e-5 * (1.0 + expected.abs()),
                    "{what}: NumPy {expected}, f32 {single}"
                );
            }
            num_values += 1;
        }
    }
    assert_eq!(num_values, 25 * 40 - 28);
}

/// Places in feature sizes, in `f64`.
struct Everywhere<'a> {
    kernel: &'a NoiseKernel,
    seed: u32,
    places: [[f64; 2]; LANES],
}

impl Places<f64> for Everywhere<'_> {
    type Octave = ([[f64; 3]; LANES], u32);

    fn octave(&self, m: u32, l: u32) -> Self::Octave {
        let frequency = self.kernel.scales[self.kernel.slots.index(m, l)].frequency;
        let along = |axis: u32| f64::from(orogeny_field::hash::uniform(l, axis + 16 * m, self.seed));
        let w = frequency * self.kernel.slice + along(0x53);
        let places = self.places.map(|[x, y]| {
            skewed(self.kernel.basis, [frequency * x + along(0x51), frequency * y + along(0x52), w])
        });
        (places, orogeny_field::hash::hash(l, m, self.seed))
    }

    fn origin((_, seed): &Self::Octave) -> ([u32; 3], u32) {
        ([0; 3], *seed)
    }

    fn place((places, _): &Self::Octave, lane: usize) -> [f64; 3] {
        places[lane]
    }
}

/// The place of a world position, in feature sizes, by the formulas as they stand.
fn place(noise: &Noise, [x, z]: [f64; 2]) -> [f64; 2] {
    let [x, z] = [x - noise.offset_m[0], z - noise.offset_m[1]];
    let (sin, cos) = noise.rotation_deg.to_radians().sin_cos();
    let [mut x, mut z] =
        [(cos * x + sin * z) / noise.feature_size_m, (cos * z - sin * x) / noise.feature_size_m];
    if let Some(direction) = noise.direction {
        let (e_z, e_x) = direction.angle_deg.to_radians().sin_cos();
        let along = (x * e_x + z * e_z) * (1.0 - 1.0 / direction.stretch);
        [x, z] = [x - e_x * along, z - e_z * along];
    }
    [x, z]
}

#[test]
fn turbulences_match_numpy() {
    let mut num_values = 0;
    for case in fixture("turbulences.json") {
        let noise = noise_of(&case);
        let kernel = NoiseKernel::in_feature_sizes(&noise);
        let positions: Vec<[f64; 2]> = case["positions"].as_array().unwrap().iter().map(numbers).collect();
        let mut places = [[0.0; 2]; LANES];
        for (place_of_lane, position) in places.iter_mut().zip(&positions) {
            *place_of_lane = place(&noise, *position);
        }
        let found = turbulence::sum(&kernel, &Everywhere { kernel: &kernel, seed: noise.seed, places }, None);
        for (index, position) in positions.iter().enumerate() {
            let expected = number(&case["values"][index]);
            let distance = (found[index] - expected).abs();
            assert!(
                distance < 1.0e-8 * (1.0 + expected.abs()),
                "{noise:?} at {position:?}: NumPy {expected}, found {}",
                found[index]
            );
            num_values += 1;
        }
    }
    assert_eq!(num_values, 2_574);
}

#[test]
fn percentiles_match_numpy() {
    for case in fixture("percentiles.json") {
        let noise = noise_of(&case);
        let (offset, scale) = normalization(&noise);
        assert!((offset - number(&case["normalize_offset"])).abs() < 1.0e-9, "{noise:?}: {offset}");
        assert!((scale - number(&case["normalize_scale"])).abs() < 1.0e-8 * scale, "{noise:?}: {scale}");
    }
}

/// The noise at a sample, in `f64` from the formulas as they stand.
fn truth(noise: &Noise, kernel: &NoiseKernel, spacing_m: f64, samples: [[i32; 2]; LANES]) -> [f64; LANES] {
    let places = samples.map(|sample| place(noise, sample.map(|number| f64::from(number) * spacing_m)));
    turbulence::sum(kernel, &Everywhere { kernel, seed: noise.seed, places }, None)
}

/// How far `f32` may be off, as a share of the amplitude. Erosive and Jordan noise look an octave up where the slopes of those
/// before it lead, and a distorted one where two others do: every octave magnifies their rounding by its frequency.
fn share_of_amplitude(kernel: &NoiseKernel) -> f64 {
    match kernel.turbulence {
        Turbulence::Erosive | Turbulence::Jordan => 5.0e-3,
        _ => 1.0e-4,
    }
}

/// Rows of `f32` against `f64`, at the origin and 10^6 samples from it, over the borders of lattice blocks.
#[test]
fn rows_keep_their_precision_anywhere() {
    let mut worst: f64 = 0.0;
    for basis in Basis::ALL {
        for turbulence in Turbulence::ALL {
            for (kind, first_x, z) in
                [(0, 5, 3), (1, 1_048_540, 1_000_003), (2, 999_990, 31), (3, 250, 1_048_575)]
            {
                let noise = Noise {
                    basis,
                    turbulence,
                    feature_size_m: 613.7,
                    octaves: 6,
                    seed: 77,
                    slice: 1.3,
                    normalization: Normalization::Off,
                    rotation_deg: if kind % 2 == 1 { 33.0 } else { 0.0 },
                    direction: (kind == 2).then_some(NoiseDirection {
                        angle_deg: 50.0,
                        follows_stroke: false,
                        stretch: 4.0,
                    }),
                    distortion: (kind >= 2).then_some(Distortion {
                        turbulence: Turbulence::Billowy,
                        octaves: 3,
                        weight: 0.4,
                        lacunarity: 2.0,
                        gain: Gain::Given(0.5),
                    }),
                    ..Noise::default()
                };
                let kernel = NoiseKernel::new(&noise, 2.0, [0.0; 2]).unwrap();
                let frame = NoiseFrame::new(&kernel, noise.seed, 0, None);
                let mut found = [f32::NAN; LANES];
                row::row(&mut found, first_x, z, &kernel, &frame, None);
                let samples = std::array::from_fn(|lane| [first_x + lane as i32, z]);
                let expected = truth(&noise, &kernel, 2.0, samples);
                let amplitude: f64 = kernel.scales[..6].iter().map(|scale| scale.weight).sum();
                for (found, expected) in found.into_iter().zip(expected) {
                    let tolerance = amplitude * share_of_amplitude(&kernel);
                    let distance = (f64::from(found) - expected).abs();
                    worst = worst.max(distance / tolerance);
                    assert!(distance <= tolerance, "{noise:?} at {first_x}, {z}: {expected}, found {found}");
                }
            }
        }
    }
    println!("worst {worst:.3} of the tolerance");
}

#[test]
fn a_row_is_the_same_however_it_is_cut() {
    let curve = Curve::new("a test", vec![[-1.0, 0.5], [0.2, -1.0], [1.0, 1.0]]).unwrap();
    let noise =
        Noise { transfer: Some(curve.clone()), curve: Some(curve), feature_size_m: 40.0, ..Noise::default() };
    let kernel = NoiseKernel::new(&noise, 1.0, [0.0; 2]).unwrap();
    let frame = NoiseFrame::new(&kernel, 9, 0, None);
    let mut whole = [f32::NAN; 300];
    row::row(&mut whole, 1000, 77, &kernel, &frame, None);
    for (first, end) in [(0, 1), (5, 40), (31, 33), (100, 300), (24, 88)] {
        let mut part = vec![f32::NAN; end - first];
        row::row(&mut part, 1000 + first as i32, 77, &kernel, &frame, None);
        let same = part.iter().zip(&whole[first..end]).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same, "{first}..{end}");
    }
}

/// A roughness weighs octave `l` by its `l`-th power, whatever the turbulence.
#[test]
fn a_roughness_of_one_is_none_and_of_zero_leaves_the_first_octave() {
    for turbulence in Turbulence::ALL {
        let with = |octaves| Noise {
            turbulence,
            octaves,
            feature_size_m: 60.0,
            normalization: Normalization::Off,
            ..Noise::default()
        };
        let of = |noise: &Noise, roughness: Option<&[f32]>| {
            let kernel = NoiseKernel::new(noise, 1.0, [0.0; 2]).unwrap();
            let frame = NoiseFrame::new(&kernel, 3, 0, None);
            let mut values = [f32::NAN; 100];
            row::row(&mut values, 77, 9, &kernel, &frame, roughness);
            values
        };
        let whole = of(&with(4), None);
        assert_eq!(of(&with(4), Some(&[1.0; 100])), whole, "{turbulence:?}");
        assert_ne!(of(&with(4), Some(&[0.5; 100])), whole, "{turbulence:?}");
        // A product has a factor for each octave, however little it weighs.
        if turbulence != Turbulence::Multiplicative {
            assert_eq!(of(&with(4), Some(&[0.0; 100])), of(&with(1), None), "{turbulence:?}");
        }
    }
    // Half as rough is a gain half as large.
    let half = Noise { gain: Gain::Given(0.3), octaves: 4, feature_size_m: 60.0, ..Noise::default() };
    let full = Noise { gain: Gain::Given(0.6), ..half.clone() };
    let of = |noise: &Noise, roughness: Option<&[f32]>| {
        let kernel = NoiseKernel::new(noise, 1.0, [0.0; 2]).unwrap();
        let frame = NoiseFrame::new(&kernel, 3, 0, None);
        let mut values = [f32::NAN; 100];
        row::row(&mut values, 5, 9, &kernel, &frame, roughness);
        values
    };
    for (a, b) in of(&full, Some(&[0.5; 100])).into_iter().zip(of(&half, None)) {
        assert!((a - b).abs() < 1.0e-5, "{a} {b}");
    }
}

/// Values and gradients of a basis at many random places, a new seed for each thousand.
fn many(basis: Basis) -> Vec<Sample<f64>> {
    let mut bits = 1_u32;
    let mut random = || {
        bits = orogeny_field::hash::hash(bits, 7, 11);
        f64::from(bits) / f64::from(u32::MAX)
    };
    (0..200_000_u32)
        .map(|index| {
            let place = [2000.0 * random() - 1000.0, 2000.0 * random() - 1000.0, 50.0 * random()];
            sample(basis, place, index / 1000, [1.0, 0.0, 0.0, 0.0])
        })
        .collect()
}

#[test]
fn every_basis_keeps_to_its_range_and_has_no_side() {
    for (basis, limit, has_zero_mean) in [
        (Basis::Gradient, 1.012, true),
        // Catmull-Rom curves overshoot: at most (1 + 1/4) along each axis.
        (Basis::Value, 1.5625, true),
        (Basis::Worley, 1.0, false),
        (Basis::Simplex, 1.000_001, true),
        (Basis::Simplex3d, 1.000_001, true),
        // Three standard deviations are 1; of bumps of bounded height, two a cell, no sum is much over three times that.
        (Basis::Sparse, 3.0, true),
    ] {
        let samples = many(basis);
        let count = samples.len() as f64;
        let largest = samples.iter().map(|sample| sample.value.abs()).fold(0.0, f64::max);
        assert!(largest <= limit, "{basis:?}: {largest}");
        assert!(largest > 0.8 * limit.min(1.0), "{basis:?} uses its range: {largest}");
        let mean = samples.iter().map(|sample| sample.value).sum::<f64>() / count;
        let variance = samples.iter().map(|sample| (sample.value - mean).powi(2)).sum::<f64>() / count;
        let skewness = samples.iter().map(|sample| (sample.value - mean).powi(3)).sum::<f64>()
            / count
            / variance.powf(1.5);
        if has_zero_mean {
            // Five standard errors of 200,000 places, of which those in one cell are not independent.
            assert!(mean.abs() < 0.02 * variance.sqrt(), "{basis:?}: mean {mean}");
            assert!(skewness.abs() < 0.05, "{basis:?}: skewness {skewness}");
        }
        // As steep along x as along y, and as along the diagonals: the gradient's covariance is that of a circle.
        let of = |of: &dyn Fn(&Sample<f64>) -> f64| samples.iter().map(of).sum::<f64>() / count;
        let (xx, yy, xy) = (of(&|s| s.dx * s.dx), of(&|s| s.dy * s.dy), of(&|s| s.dx * s.dy));
        assert!((xx / yy - 1.0).abs() < 0.03, "{basis:?}: {xx} along x, {yy} along y");
        assert!(xy.abs() < 0.03 * xx, "{basis:?}: {xy} across");
    }
}

/// Between neighbouring cells nothing jumps: neither the value nor, where a basis is smooth, its gradient.
#[test]
fn nothing_jumps_at_the_borders_of_cells() {
    const STEP: f64 = 1.0e-7;
    for basis in Basis::ALL {
        for index in 0..2000_u32 {
            let along = f64::from(orogeny_field::hash::uniform(index, 1, 3)) * 40.0 - 20.0;
            let border = f64::from(index % 41) - 20.0;
            for (x, y) in [(border, along), (along, border)] {
                let at =
                    |dx: f64, dy: f64| sample::<f64>(basis, [x + dx, y + dy, 0.3], 5, [0.0, 1.0, 0.0, 0.0]);
                let (before, after) = (at(-STEP, -STEP), at(STEP, STEP));
                assert!((before.value - after.value).abs() < 1.0e-5, "{basis:?} at {x}, {y}");
                // Distances to points bend where two are equally near.
                if basis != Basis::Worley {
                    let jump = (before.dx - after.dx).abs().max((before.dy - after.dy).abs());
                    assert!(jump < 1.0e-4, "{basis:?} at {x}, {y}: the gradient by {jump}");
                }
            }
        }
    }
}
