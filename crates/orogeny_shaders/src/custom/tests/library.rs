//! What the library and the kernel around a brush compute, run on the CPU and compared with the formulas in `f64`.

use std::collections::HashMap;

use super::evaluate::{Machine, Value};
use super::{brush, compiled};
use crate::shader::Shader;

fn parsed(shader: &Shader) -> naga::Module {
    naga::front::wgsl::parse_str(&shader.wgsl).unwrap()
}

fn call(module: &naga::Module, name: &str, arguments: Vec<Value>) -> f32 {
    match (Machine { module, named: HashMap::new() }).call(name, arguments) {
        Value::F32(value) => value[0],
        other => panic!("{other:?}"),
    }
}

/// PCG-3D, as `orogeny_reference::hash` has it.
fn hash(x: u32, y: u32, seed: u32) -> u32 {
    let mut v = [x, y, seed].map(|v| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
    v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
    v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    v = v.map(|v| v ^ (v >> 16));
    v[0].wrapping_add(v[1].wrapping_mul(v[2]))
}

/// Gradient noise with 8 gradients, at a place in features.
fn expected_noise([x, y]: [f64; 2], seed: u32) -> f64 {
    let slope = |dx: f64, dy: f64| {
        let (i, j) = (x.floor() + dx, y.floor() + dy);
        let k = f64::from(hash(i as i64 as u32, j as i64 as u32, seed) >> 29);
        let angle = (1.0 + 2.0 * k) * std::f64::consts::FRAC_PI_8;
        angle.cos() * (x - i) + angle.sin() * (y - j)
    };
    let fade = |t: f64| ((6.0 * t - 15.0) * t + 10.0) * t * t * t;
    let (u, v) = (fade(x - x.floor()), fade(y - y.floor()));
    let [a, b, c, d] = [slope(0.0, 0.0), slope(1.0, 0.0), slope(0.0, 1.0), slope(1.0, 1.0)];
    let scale = 2.0 / (std::f64::consts::FRAC_PI_8.cos() + std::f64::consts::FRAC_PI_8.sin());
    scale * (a + u * (b - a) + v * (c - a) + u * v * (a - b - c + d))
}

/// The sum of octaves, the features of each `lacunarity` times as fine.
fn expected_fbm(place: [f64; 2], octaves: u32, lacunarity: f64, gain: f64, seed: u32) -> f64 {
    let uniform = |octave, salt| f64::from(hash(octave, salt, seed) >> 8) / f64::from(1 << 24);
    let octave_of = |octave: u32| {
        let scale = lacunarity.powi(octave as i32);
        let place = [place[0] * scale + uniform(octave, 0x51), place[1] * scale + uniform(octave, 0x52)];
        gain.powi(octave as i32) * expected_noise(place, hash(octave, 0, seed))
    };
    (0..octaves).map(octave_of).sum()
}

fn numbers(count: u32) -> impl Iterator<Item = [f64; 2]> {
    (0..count).map(|k| [hash(k, 1, 9), hash(k, 2, 9)].map(|bits| f64::from(bits) / f64::from(u32::MAX)))
}

#[test]
fn noise_is_gradient_noise_in_all_quadrants() {
    let module = parsed(crate::shader("custom/brush").unwrap());
    let mut largest = 0.0_f32;
    for (k, [x, y]) in numbers(2000).enumerate() {
        let place = [x, y].map(|x| ((x - 0.5) * 60.0) as f32);
        let seed = k as u32 & 7;
        let noise = call(&module, "noise", vec![Value::F32(place.to_vec()), Value::U32(vec![seed])]);
        let expected = expected_noise(place.map(f64::from), seed);
        assert!((f64::from(noise) - expected).abs() < 1e-5, "{place:?}: {noise}, not {expected}");
        largest = largest.max(noise.abs());
    }
    assert!(largest > 0.7 && largest <= 1.012, "{largest}");
}

#[test]
fn fbm_is_its_sum_and_takes_16_octaves_at_most() {
    let module = parsed(crate::shader("custom/brush").unwrap());
    for [x, y] in numbers(100) {
        let place = [x, y].map(|x| ((x - 0.5) * 20.0) as f32);
        for (octaves, at_most) in [(0, 0), (1, 1), (5, 5)] {
            let arguments = vec![
                Value::F32(place.to_vec()),
                Value::U32(vec![octaves]),
                Value::F32(vec![1.92]),
                Value::F32(vec![0.5]),
                Value::U32(vec![3]),
            ];
            let expected = expected_fbm(place.map(f64::from), at_most, f64::from(1.92_f32), 0.5, 3);
            assert!(
                (f64::from(call(&module, "fbm", arguments)) - expected).abs() < 1e-4,
                "{place:?}, {octaves}"
            );
        }
    }
    let of = |octaves: u32| {
        let [lacunarity, gain] = [1.0, 0.9].map(|value| Value::F32(vec![value]));
        let (place, seed) = (Value::F32(vec![0.3, 0.7]), Value::U32(vec![1]));
        call(&module, "fbm", vec![place, Value::U32(vec![octaves]), lacunarity, gain, seed])
    };
    assert!(of(15) != of(16) && of(16) == of(17) && of(16) == of(u32::MAX));
}

/// Neither the last sample of the largest terrain nor one before the first loses precision.
#[test]
fn noise_at_is_as_precise_anywhere() {
    let module = parsed(crate::shader("custom/brush").unwrap());
    let far = [0, -1_000_000, 1_000_000, (1 << 20) - 500, (1 << 21) - 500, -(1 << 21)];
    for (k, [x, z]) in numbers(400).enumerate() {
        let start = far[k % far.len()];
        let sample = [x, z].map(|x| start + (x * 500.0) as i32);
        for feature in [2.0, 7.25, 40.0, 333.5, 5000.0, 1_048_576.0_f32] {
            let place = sample.map(|x| f64::from(x) / f64::from(feature));
            let arguments = [Value::I32(sample.to_vec()), Value::F32(vec![feature]), Value::U32(vec![5])];
            let noise = call(&module, "noise_at", arguments.to_vec());
            assert!((f64::from(noise) - expected_noise(place, 5)).abs() < 3e-6, "{sample:?}, {feature}");

            let arguments = [
                Value::I32(sample.to_vec()),
                Value::F32(vec![feature]),
                Value::U32(vec![2]),
                Value::F32(vec![0.5]),
                Value::U32(vec![5]),
            ];
            let octaves = if feature < 4.0 { 1 } else { 2 };
            let expected = expected_fbm(place, octaves, 2.0, 0.5, 5);
            let fbm = call(&module, "fbm_at", arguments.to_vec());
            assert!((f64::from(fbm) - expected).abs() < 6e-6, "{sample:?}, {feature}: {fbm}, not {expected}");
        }
    }
}

/// A struct of the kernel, which has these members in this order.
#[track_caller]
fn structure(module: &naga::Module, name: &str, members: Vec<(&str, Value)>) -> Value {
    let mut types = module.types.iter().map(|(_, ty)| ty);
    let ty = types.find(|ty| ty.name.as_deref() == Some(name)).unwrap();
    let naga::TypeInner::Struct { members: declared, .. } = &ty.inner else { panic!("{ty:?}") };
    let declared: Vec<_> = declared.iter().map(|member| member.name.as_deref().unwrap()).collect();
    assert_eq!(declared, members.iter().map(|(name, _)| *name).collect::<Vec<_>>(), "{name}");
    Value::Struct(members.into_iter().map(|(_, value)| value).collect())
}

/// The height that the kernel makes of one, with the brush's input as it was.
fn new_height(result: &str, weight_mode: u32, amount: f32, inverse_radius: f32) -> f32 {
    let module = parsed(&compiled(&brush("", result)).shader);
    let f32s = |values: &[f32]| Value::F32(values.to_vec());
    let custom =
        vec![("spacing_m", f32s(&[0.5])), ("radius_m", f32s(&[80.0])), ("seed", Value::U32(vec![77]))];
    let named = HashMap::from([
        ("WEIGHT_MODE", Value::U32(vec![weight_mode])),
        ("custom", structure(&module, "Custom", custom)),
        ("parameters", structure(&module, "Parameters", vec![("unused", f32s(&[0.0]))])),
    ]);
    let members = vec![
        ("cell", Value::I32(vec![1_000_000, 10])),
        ("fraction", f32s(&[0.25, 0.75])),
        ("inverse_radius", f32s(&[inverse_radius])),
        ("amplitude", f32s(&[1.0])),
        ("reference_height_m", f32s(&[0.0])),
        ("inverse_radius_m", f32s(&[0.125])),
        ("axis", f32s(&[0.6, 0.8])),
        ("mirror", f32s(&[-1.0])),
        ("flow", f32s(&[0.25])),
        ("segment", f32s(&[3.0, -4.0])),
        ("inverse_segment_squared", f32s(&[0.04])),
        ("end_height_m", f32s(&[30.0])),
        ("frame", Value::U32(vec![5])),
        ("frame_blend", f32s(&[0.375])),
    ];
    let instance = structure(&module, "Instance", members);
    let sample = Value::I32(vec![1_000_004, 20]);
    let machine = Machine { module: &module, named };
    match machine.call("new_height", vec![f32s(&[100.0]), f32s(&[amount]), sample, instance]) {
        Value::F32(height) => height[0],
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_brush_is_told_what_is_there() {
    for (result, expected) in [
        ("at.weight", 3.0),
        ("at.place_m.x", 0.5 * 3.75),
        ("at.place_m.y", 0.5 * 9.25),
        ("at.sample.x - 1000000", 4.0),
        ("at.sample.y", 20.0),
        ("at.radius_m", 8.0),
        ("at.spacing_m", 0.5),
        ("at.seed", 77.0),
    ] {
        assert_eq!(new_height(result, 0, 3.0, 0.0625), 100.0 + expected, "{result}");
        assert_eq!(new_height(result, 1, 3.0, 0.0625), 100.0 + expected, "{result}");
    }
}

/// In a wash the instance is any of a tile's, and a fill's covers everything: nothing of it is told.
#[test]
fn washes_and_fills_have_no_centre() {
    for (weight_mode, inverse_radius) in [(2, 0.0625), (0, 0.0)] {
        assert_eq!(new_height("at.place_m.x - 500000.0", weight_mode, 3.0, inverse_radius), 102.0);
        assert_eq!(new_height("at.place_m.y", weight_mode, 3.0, inverse_radius), 110.0);
        assert_eq!(new_height("at.radius_m", weight_mode, 3.0, inverse_radius), 180.0);
    }
}

#[test]
fn what_is_no_number_changes_nothing() {
    for result in [
        "bitcast<f32>(0x7fc00000u | at.seed)",
        "bitcast<f32>(0xff800001u | at.seed)",
        "bitcast<f32>(0x7f800000u * (at.seed & 1u))",
        "bitcast<f32>(0xff800000u * (at.seed & 1u))",
        "3e38 * at.radius_m",
    ] {
        assert_eq!(new_height(result, 0, 1.0, 0.0625), 100.0, "{result}");
    }
    assert_eq!(new_height("1.0", 0, 1.0, 0.0625), 101.0);
}

#[test]
fn nothing_changes_without_a_weight() {
    for weight_mode in [0, 1, 2] {
        assert_eq!(new_height("7.0", weight_mode, 0.0, 0.0625), 100.0);
        assert_eq!(new_height("7.0", weight_mode, -0.0, 0.0625), 100.0);
        assert_eq!(new_height("7.0", weight_mode, -1e-30, 0.0625), 107.0);
    }
}
