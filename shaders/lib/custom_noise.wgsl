// Gradient noise (Perlin 2002), about -1..1, and its sums over octaves, for users' brushes.
#include "lib/hash.wgsl"
#include "lib/noise_gradient.wgsl"

const MAX_OCTAVES = 16u;
const PARTS_PER_SAMPLE = 1024;

// At a place 0..1 in a cell of the lattice.
fn lattice_noise(cell: vec2<u32>, f: vec2<f32>, seed: u32) -> f32 {
    return gradient_noise(cell, f, seed).x;
}

// Octaves share no lattice point: one that did would show it as a spot where all of them are 0.
fn octave_offset(octave: u32, seed: u32) -> vec2<f32> {
    let bits = vec2<u32>(hash(octave, 0x51u, seed), hash(octave, 0x52u, seed));
    return vec2<f32>(bits >> vec2<u32>(8u)) * 5.9604645e-8;
}

// `place` in features, exact to its own f32: 2^-24 of its distance from 0.
fn noise(place: vec2<f32>, seed: u32) -> f32 {
    let cell = floor(place);
    return lattice_noise(vec2<u32>(vec2<i32>(cell)), place - cell, seed);
}

fn fbm(place: vec2<f32>, octaves: u32, lacunarity: f32, gain: f32, seed: u32) -> f32 {
    var sum = 0.0;
    var scale = 1.0;
    var weight = 1.0;
    for (var octave = 0u; octave < MAX_OCTAVES; octave++) {
        if octave >= octaves {
            break;
        }
        sum += weight * noise(scale * place + octave_offset(octave, seed), hash(octave, 0u, seed));
        scale *= lacunarity;
        weight *= gain;
    }
    return sum;
}

// In parts of a sample, so that the cell is an exact quotient of integers, for samples within +-2^21.
fn feature_parts(feature_samples: f32) -> i32 {
    return i32(clamp(feature_samples, 2.0, 1048576.0) * f32(PARTS_PER_SAMPLE) + 0.5);
}

// The place in a cell errs by 2^-22, wherever the sample is.
fn noise_of_parts(sample: vec2<i32>, feature: i32, offset: vec2<f32>, seed: u32) -> f32 {
    let parts = sample * PARTS_PER_SAMPLE;
    let is_below = parts % feature < vec2<i32>(0);
    let cell = parts / feature - select(vec2<i32>(0), vec2<i32>(1), is_below);
    let rest = parts % feature + select(vec2<i32>(0), vec2<i32>(feature), is_below);
    let place = vec2<f32>(rest) / f32(feature) + offset;
    let carry = floor(place);
    return lattice_noise(vec2<u32>(cell + vec2<i32>(carry)), place - carry, seed);
}

// The feature's size is rounded to 1/1024 of a sample, and 2 samples at least.
fn noise_at(sample: vec2<i32>, feature_samples: f32, seed: u32) -> f32 {
    return noise_of_parts(sample, feature_parts(feature_samples), vec2<f32>(0.0), seed);
}

// Each octave's features are half as large, exactly: a lacunarity of 2. Those under 2 samples are left out.
fn fbm_at(sample: vec2<i32>, feature_samples: f32, octaves: u32, gain: f32, seed: u32) -> f32 {
    var sum = 0.0;
    var feature = feature_parts(feature_samples);
    var weight = 1.0;
    for (var octave = 0u; octave < MAX_OCTAVES; octave++) {
        if octave >= octaves || feature < 2 * PARTS_PER_SAMPLE {
            break;
        }
        sum += weight * noise_of_parts(sample, feature, octave_offset(octave, seed), hash(octave, 0u, seed));
        feature = feature >> 1u;
        weight *= gain;
    }
    return sum;
}
