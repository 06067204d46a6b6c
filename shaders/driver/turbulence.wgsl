// Sums of octaves. Sources: see the twin, orogeny_reference::noise::turbulence.
#include "driver/noise.wgsl"

override HAS_ROUGHNESS: u32 = 0u;

// How rough the noise is at a sample, 0..1: octave l weighs the l-th power of it more. A noise has no wash, so its roughness
// lies where one has its heights from before.
fn roughness_at(sample: vec2<i32>) -> f32 {
    if HAS_ROUGHNESS == 1u {
        return textureLoad(before, vec2<u32>(sample - current_tile.page_origin), current_tile.scratch_layer, 0).x;
    }
    return 1.0;
}

fn quilez_sum(octaves: Octaves, rough: f32, frame: u32, sample: vec2<i32>, shift: vec2<f32>) -> f32 {
    var sum = 0.0;
    var slope = vec2<f32>(0.0);
    var power = 1.0;
    for (var l = 0u; l < octaves.count; l++) {
        power = select(power * rough, 1.0, l == 0u);
        let slot = octaves.first + l;
        let found = octave(slot, frame, sample, frequency_of(slot) * shift);
        slope += found.yz;
        sum += weight_of(slot) * power * found.x / (1.0 + (slope.x * slope.x + slope.y * slope.y));
    }
    return sum;
}

fn erosive_sum(octaves: Octaves, rough: f32, frame: u32, sample: vec2<i32>, shift: vec2<f32>) -> f32 {
    var sum = 0.0;
    var slope = vec2<f32>(0.0);
    var weight = 1.0;
    var power = 1.0;
    for (var l = 0u; l < octaves.count; l++) {
        power = select(power * rough, 1.0, l == 0u);
        let slot = octaves.first + l;
        let frequency = frequency_of(slot);
        let found = octave(slot, frame, sample, frequency * shift + frequency * (0.15 * slope));
        sum += weight * power * (1.0 - min(abs(found.x), 1.0));
        slope += -(weight * power * found.x) * found.yz;
        weight = weight * octaves.gain * clamp(1.1 * sum, 0.0, 1.0);
    }
    return sum;
}

// de Carpentier's published parameters: 0.8, 0.4, 0.35, 1, 0.8, 1.
fn jordan_sum(octaves: Octaves, rough: f32, frame: u32, sample: vec2<i32>, shift: vec2<f32>) -> f32 {
    var sum = 0.0;
    var bend = vec2<f32>(0.0);
    var damp = vec2<f32>(0.0);
    var amplitude = 0.8;
    var weight = 1.0;
    var power = 1.0;
    for (var l = 0u; l < octaves.count; l++) {
        power = select(power * rough, 1.0, l == 0u);
        let slot = octaves.first + l;
        let found = octave(slot, frame, sample, frequency_of(slot) * shift + bend);
        sum += weight * power * found.x * found.x;
        if l == 0u {
            bend += 0.4 * found.x * found.yz;
            damp += found.x * found.yz;
            weight = amplitude * octaves.gain;
        } else {
            amplitude = amplitude * octaves.gain;
            bend += 0.35 * found.x * found.yz;
            damp += 0.8 * found.x * found.yz;
            weight = amplitude * (1.0 - 1.0 / (1.0 + (damp.x * damp.x + damp.y * damp.y)));
        }
    }
    return sum;
}

// The turbulences that ask for values alone.
fn plain_sum(turbulence: u32, octaves: Octaves, rough: f32, frame: u32, sample: vec2<i32>, shift: vec2<f32>) -> f32 {
    var sum = select(0.0, 1.0, turbulence == MULTIPLICATIVE);
    var share = 1.0;
    var power = 1.0;
    for (var l = 0u; l < octaves.count; l++) {
        power = select(power * rough, 1.0, l == 0u);
        let slot = octaves.first + l;
        let weight = weight_of(slot) * power;
        let value = octave(slot, frame, sample, frequency_of(slot) * shift).x;
        let folded = min(abs(value), 1.0);
        switch turbulence {
            case BILLOWY: {
                sum += weight * folded;
            }
            case RIDGED: {
                sum += weight * (1.0 - folded);
            }
            case HETEROGENEOUS: {
                sum = select(sum + (value + noise.elevation) * weight * sum, noise.elevation + value, l == 0u);
            }
            case MULTIPLICATIVE: {
                sum = sum * (weight * value + noise.elevation);
            }
            case HYBRID: {
                share = min(share, 1.0) * ((value + noise.elevation) * weight);
                sum += share;
            }
            default: { // FBM
                sum += weight * value;
            }
        }
    }
    return sum;
}

fn turbulence_sum(turbulence: u32, m: u32, frame: u32, sample: vec2<i32>, shift: vec2<f32>) -> f32 {
    let octaves = octaves_of(m);
    var rough = 1.0;
    if m == 0u {
        rough = roughness_at(sample);
    }
    switch turbulence {
        case QUILEZ: {
            return quilez_sum(octaves, rough, frame, sample, shift);
        }
        case EROSIVE: {
            return erosive_sum(octaves, rough, frame, sample, shift);
        }
        case JORDAN: {
            return jordan_sum(octaves, rough, frame, sample, shift);
        }
        default: {
            return plain_sum(turbulence, octaves, rough, frame, sample, shift);
        }
    }
}

// The raw sum at a sample, distorted where it is.
fn noise_sum(frame: u32, sample: vec2<i32>) -> f32 {
    var shift = vec2<f32>(0.0);
    if noise.num_distortion > 0u {
        shift = noise.distortion_weight * vec2<f32>(
            turbulence_sum(DISTORTION_TURBULENCE, 1u, frame, sample, vec2<f32>(0.0)),
            turbulence_sum(DISTORTION_TURBULENCE, 2u, frame, sample, vec2<f32>(0.0)),
        );
    }
    return turbulence_sum(NOISE_TURBULENCE, 0u, frame, sample, shift);
}
