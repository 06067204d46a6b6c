//! Noise: every basis and turbulence, every seeding, what bends and stretches it, gates, on both back ends.

use orogeny_brush::{CpuExecutor, resolved};
use orogeny_field::noise::{
    Basis, Distortion, Gain, Noise, NoiseDirection, Normalization, Seeding, Turbulence,
};
use orogeny_field::{
    AspectGate, Band, Brush, BrushType, Curve, DataSource, Gate, GateImage, NoiseGate, PageLayout,
    PointerSample, SampleRect, Stroke,
};
use orogeny_tests::{Feed, Operation, Plane, compare, paint};

use crate::agreement::back_ends_agree;

/// A noise whose features are seen on any of the terrains that the agreement is tried on.
fn noise(basis: Basis, turbulence: Turbulence) -> Noise {
    Noise {
        basis,
        turbulence,
        feature_size_m: 130.0,
        octaves: 5,
        seed: 3,
        slice: 0.6,
        normalization: Normalization::Given { offset: 0.25, scale: 1.1 },
        ..Noise::default()
    }
}

fn with(noise: Noise) -> Brush {
    Brush { noise, ..Brush::new(BrushType::Noise, 1.0, 1.0) }
}

fn distortion(turbulence: Turbulence) -> Option<Distortion> {
    Some(Distortion { turbulence, octaves: 2, weight: 0.4, lacunarity: 2.1, gain: Gain::Given(0.5) })
}

fn along(angle_deg: f64, follows_stroke: bool) -> Option<NoiseDirection> {
    Some(NoiseDirection { angle_deg, follows_stroke, stretch: 3.0 })
}

/// Every turbulence with every basis in turn, and each of the other choices.
fn brushes() -> Vec<(&'static str, Brush)> {
    let mut brushes = Vec::new();
    for (index, turbulence) in Turbulence::ALL.into_iter().enumerate() {
        let basis = Basis::ALL[index % Basis::ALL.len()];
        let seedings = [Seeding::World, Seeding::Instance, Seeding::Stroke, Seeding::Random];
        let plain = noise(basis, turbulence);
        let varied = Noise {
            seeding: seedings[index % 4],
            distortion: if index % 3 == 1 { distortion(Turbulence::ALL[8 - index]) } else { None },
            direction: if index % 3 == 2 { along(25.0, index % 2 == 0) } else { None },
            rotation_deg: 31.0,
            offset_m: [12.0, -7.0],
            ..plain
        };
        brushes.push(("noise", with(varied)));
    }
    let curve = Curve::new("a test", vec![[-1.0, 0.8], [-0.2, -0.5], [1.0, 1.0]]).unwrap();
    let base = noise(Basis::Gradient, Turbulence::Fbm);
    brushes.push((
        "noise, curves",
        with(Noise { transfer: Some(curve.clone()), curve: Some(curve), ..base.clone() }),
    ));
    let image =
        GateImage { source: DataSource::File("a map".to_owned()), region_m: [20.0, -30.0, 3000.0, 900.0] };
    let roughness = Gate { image: Some(image), is_inverted: true, noise: None, ..gate() };
    let rough = Noise { roughness: Some(Box::new(roughness)), ..noise(Basis::Simplex, Turbulence::Ridged) };
    brushes.push(("noise, rough by the ground and a picture", with(rough)));
    brushes.push(("noise, gated", Brush { gate: Some(Box::new(gate())), ..with(base) }));
    brushes
}

fn gate() -> Gate {
    let band = |min, max, feather| Some(Band { min, max, feather });
    Gate {
        slope_deg: band(5.0, 80.0, 20.0),
        height_m: band(-5.0e5, 5.0e5, 100.0),
        aspect: Some(AspectGate { angle_deg: 40.0, width_deg: 100.0, feather_deg: 60.0 }),
        curvature_per_km: band(-1.0e6, 1.0e6, 1.0),
        noise: Some(NoiseGate {
            noise: noise(Basis::Simplex, Turbulence::Fbm),
            band: Band { min: -0.5, max: 9.0, feather: 0.5 },
        }),
        selection: false,
        image: None,
        is_inverted: false,
    }
}

back_ends_agree!(brushes, OneEach);

/// Combinations of basis, turbulence, distortion and direction, one dab each over a corner of four pages, at the origin and a
/// million samples from it. Each is a pipeline of its own, which takes a software driver about a second: the long run tries
/// all, the suite every seventeenth, among which each choice of each kind is several times.
#[test]
fn combinations_agree_anywhere() {
    let stride = if std::env::var_os("OROGENY_TEST_LONG").is_some() { 1 } else { 53 };
    let (mut num_cases, mut num_tried) = (0, 0);
    let mut worst: f64 = 0.0;
    let mut back_ends = crate::agreement::Dabs::new();
    for basis in Basis::ALL {
        for turbulence in Turbulence::ALL {
            for bent in std::iter::once(None).chain(Turbulence::ALL.map(distortion)) {
                for direction in [None, along(70.0, false), along(10.0, true)] {
                    num_cases += 1;
                    if num_cases % stride != 0 {
                        continue;
                    }
                    num_tried += 1;
                    if num_tried % 100 == 0 {
                        println!(
                            "{num_tried} tried, {num_cases} passed by: worst {worst:.3} of the tolerance"
                        );
                    }
                    let far = num_tried % 2 == 1;
                    let noise = Noise { distortion: bent, direction, ..noise(basis, turbulence) };
                    worst = worst.max(back_ends.compare(&with(noise), far).unwrap_or_else(|err| {
                        panic!("{basis:?} {turbulence:?}, distorted by {bent:?}, along {direction:?}, far {far}: {err}")
                    }));
                }
            }
        }
    }
    assert_eq!(num_cases, 6 * 9 * 10 * 3);
    println!("{num_tried} of {num_cases} combinations: worst {worst:.3} of the tolerance");
}

fn filled(brush: &Brush, size: u32) -> Plane {
    let layout = PageLayout::new(64).unwrap();
    let fill = Operation::Fill {
        brush: brush.clone(),
        seed: 4,
        region: SampleRect::new(0, 0, size as i32, size as i32),
    };
    let mut cpu = CpuExecutor::new(layout, 1 << 26, None).unwrap();
    let flat = Plane::from_fn(size, size, |_, _| 0.0);
    paint(&flat, 1.0, &[fill], &mut cpu, layout, Feed::WHOLE).unwrap().plane
}

fn correlation(a: &Plane, b: &Plane) -> f64 {
    let pairs: Vec<_> =
        a.samples().iter().zip(b.samples()).map(|(a, b)| (f64::from(*a), f64::from(*b))).collect();
    let count = pairs.len() as f64;
    let (mean_a, mean_b) = pairs.iter().fold((0.0, 0.0), |(sa, sb), (a, b)| (sa + a / count, sb + b / count));
    let covariance: f64 = pairs.iter().map(|(a, b)| (a - mean_a) * (b - mean_b)).sum();
    let variance = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(|pair| of(pair).powi(2)).sum::<f64>();
    covariance / (variance(&|(a, _)| a - mean_a) * variance(&|(_, b)| b - mean_b)).sqrt()
}

#[test]
fn neighbouring_seeds_and_octaves_are_uncorrelated() {
    for basis in Basis::ALL {
        let of = |seed, feature_size_m| {
            let noise = Noise {
                octaves: 1,
                seed,
                feature_size_m,
                basis,
                normalization: Normalization::Off,
                ..Noise::default()
            };
            filled(&with(noise), 512)
        };
        // 64 cells a side: 4,096 of them, whose chance correlation has a standard deviation of under 0.016.
        let (first, second) = (of(7, 8.0), of(8, 8.0));
        let r = correlation(&first, &second);
        assert!(r.abs() < 0.05, "{basis:?}, seeds: {r}");
        // One seed is not another one zoomed: the second octave of a noise against its first, looked at twice as closely.
        let octaves = |octaves| Noise {
            octaves,
            seed: 7,
            basis,
            lacunarity: 2.0,
            feature_size_m: 16.0,
            gain: Gain::Given(1.0),
            normalization: Normalization::Off,
            ..Noise::default()
        };
        let (one, two) = (filled(&with(octaves(1)), 512), filled(&with(octaves(2)), 512));
        let second_octave = Plane::from_fn(512, 512, |x, z| two.at(x, z) - one.at(x, z));
        for (what, other) in [("the first octave", &one), ("the seed at half its size", &first)] {
            let r = correlation(&second_octave, other);
            assert!(r.abs() < 0.07, "{basis:?}, the second octave and {what}: {r}");
        }
        assert_ne!(first.at(0, 0), second.at(0, 0), "{basis:?}");
    }
}

/// Along a line the power of fBm falls as `f^-(2 Hu + 1)`.
#[test]
fn the_spectrum_of_fbm_has_its_slope() {
    for hurst in [0.25, 0.5, 0.85] {
        let noise = Noise {
            octaves: 9,
            lacunarity: 2.0,
            gain: Gain::Hurst(hurst),
            feature_size_m: 512.0,
            normalization: Normalization::Off,
            ..Noise::default()
        };
        let plane = filled(&with(noise), 2048);
        let slope = spectral_slope(&plane);
        let expected = -(2.0 * hurst + 1.0);
        assert!((slope - expected).abs() < 0.2, "Hurst {hurst}: {slope}, expected {expected}");
    }
}

/// The slope of the mean power spectrum of rows, Hann window, over the octaves from 1/256 to 1/8 cycles a sample: from the
/// second to the second-last of those that the noise has.
fn spectral_slope(plane: &Plane) -> f64 {
    let size = plane.width() as usize;
    let first_bin = size / 256;
    let mut bands = [0.0_f64; 5];
    for z in (0..size as u32).step_by(16) {
        let row: Vec<f64> = (0..size as u32)
            .map(|x| {
                let window = 0.5 - 0.5 * (std::f64::consts::TAU * f64::from(x) / size as f64).cos();
                window * f64::from(plane.at(x, z))
            })
            .collect();
        for (octave, band) in bands.iter_mut().enumerate() {
            // Eight bins spread over each octave.
            for part in 0..8 {
                let bin = (first_bin << octave) * (8 + part) / 8;
                let (mut re, mut im) = (0.0, 0.0);
                let (step_im, step_re) = (-std::f64::consts::TAU * bin as f64 / size as f64).sin_cos();
                let (mut turn_re, mut turn_im) = (1.0, 0.0);
                for value in &row {
                    re += value * turn_re;
                    im += value * turn_im;
                    (turn_re, turn_im) =
                        (turn_re * step_re - turn_im * step_im, turn_re * step_im + turn_im * step_re);
                }
                *band += re * re + im * im;
            }
        }
    }
    // Least squares of log2 power over the octave.
    let logs = bands.map(f64::log2);
    let mean = logs.iter().sum::<f64>() / 5.0;
    logs.iter().enumerate().map(|(octave, log)| (octave as f64 - 2.0) * (log - mean)).sum::<f64>() / 10.0
}

#[test]
fn normalised_noise_reaches_one_and_rarely_goes_beyond() {
    for turbulence in Turbulence::ALL {
        let noise = Noise { turbulence, feature_size_m: 16.0, octaves: 4, seed: 5, ..Noise::default() };
        let plane = filled(&Brush { strength: 1.0, ..with(noise) }, 1024);
        let beyond = plane.samples().iter().filter(|value| **value > 1.0).count() as f64 / (1024.0 * 1024.0);
        assert!((0.005..0.05).contains(&beyond), "{turbulence:?}: {beyond}");
        if !turbulence.is_signed() {
            let below =
                plane.samples().iter().filter(|value| **value < 0.0).count() as f64 / (1024.0 * 1024.0);
            assert!(below < 0.03, "{turbulence:?}: {below}");
        }
    }
}

#[test]
fn seedings_say_where_the_pattern_stays() {
    let layout = PageLayout::new(64).unwrap();
    let mut cpu = CpuExecutor::new(layout, 1 << 24, Some(1)).unwrap();
    let mut dab = |seeding, seed, x: f64| {
        let noise = Noise {
            seeding,
            feature_size_m: 20.0,
            octaves: 3,
            normalization: Normalization::Off,
            ..Noise::default()
        };
        let brush = Brush { falloff_m: 0.0, radius_m: 30.0, strength: 1.0, ..with(noise) };
        let stroke = Stroke { brush, seed, points: vec![PointerSample::at(x, 60.0)] };
        let flat = Plane::from_fn(200, 120, |_, _| 0.0);
        paint(&flat, 1.0, &[Operation::Stroke(stroke)], &mut cpu, layout, Feed::WHOLE).unwrap().plane
    };
    let same = |a: &Plane, b: &Plane, shift: u32| {
        (0..20).all(|k| (a.at(60 + k, 50 + k) - b.at(60 + k + shift, 50 + k)).abs() < 1.0e-3)
    };
    let world = dab(Seeding::World, 1, 70.0);
    assert!(same(&world, &dab(Seeding::World, 2, 78.0), 0), "fixed to the ground");
    assert!(!same(&world, &dab(Seeding::World, 2, 78.0), 8));
    let instance = dab(Seeding::Instance, 1, 70.0);
    assert!(same(&instance, &dab(Seeding::Instance, 2, 78.0), 8), "goes with the brush");
    let stroke = dab(Seeding::Stroke, 1, 70.0);
    assert!(
        same(&stroke, &dab(Seeding::Stroke, 1, 78.0), 0) && !same(&stroke, &dab(Seeding::Stroke, 2, 70.0), 0)
    );
    let random = dab(Seeding::Random, 1, 70.0);
    assert!(
        same(&random, &dab(Seeding::Random, 1, 70.0), 0) && !same(&random, &dab(Seeding::Random, 2, 70.0), 0)
    );
}

/// What the history records of a stroke, with the numbers that it was normalised by, gives the same bits again.
#[test]
fn a_resolved_brush_gives_the_same_bits() {
    let brush = with(Noise { turbulence: Turbulence::Ridged, feature_size_m: 30.0, ..Noise::default() });
    let again = Brush::from_json(&resolved(&brush).to_json()).unwrap();
    assert_ne!(again.noise.normalization, Normalization::Wanted);
    compare::bit_equal(&filled(&brush, 128), &filled(&again, 128)).unwrap();
}
