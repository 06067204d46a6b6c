// Octaves of noise at a sample of a tile, and their sums (section 7 of the kernel specification). A kernel includes this beside
// `driver/local.wgsl`. Twin: orogeny_reference::noise::turbulence.
#include "driver/local.wgsl"
#include "lib/noise.wgsl"

// orogeny_field::noise::Turbulence
override NOISE_TURBULENCE: u32 = 0u;
override DISTORTION_TURBULENCE: u32 = 0u;
override HAS_TRANSFER: u32 = 0u;
const FBM = 0u;
const BILLOWY = 1u;
const RIDGED = 2u;
const QUILEZ = 3u;
const EROSIVE = 4u;
const JORDAN = 5u;
const HETEROGENEOUS = 6u;
const MULTIPLICATIVE = 7u;
const HYBRID = 8u;

struct Noise {
    worley_weights: vec4<f32>,
    num_main: u32,       // octaves of the main turbulence
    num_distortion: u32, // of each of the two that distort it; 0 for none
    distortion_weight: f32,
    main_gain: f32,
    distortion_gain: f32,
    elevation: f32,
    offset: f32,
    scale: f32,
}

// orogeny_field::noise::LatticePoint
struct LatticePoint {
    cell: vec3<u32>,
    unused0: u32,
    fraction: vec3<f32>,
    unused1: u32,
}

// orogeny_field::noise::LatticeStep
struct LatticeStep {
    x: vec3<f32>,
    frequency: f32,
    z: vec3<f32>,
    weight: f32,
}

// orogeny_field::noise::FrameOctave
struct FrameOctave {
    cell: vec3<u32>,
    seed: u32,
    fraction: vec3<f32>,
    direction: u32,
}

@group(1) @binding(11) var<uniform> noise: Noise;
@group(1) @binding(12) var<storage, read> frames: array<FrameOctave>;
@group(1) @binding(14) var<storage, read> lattice: array<LatticePoint>;
@group(1) @binding(13) var<storage, read> lattice_steps: array<LatticeStep>;

// Which octaves a turbulence has: 0 the main one, 1 and 2 those that distort it.
struct Octaves {
    first: u32,
    count: u32,
    gain: f32,
}

fn octaves_of(m: u32) -> Octaves {
    if m == 0u {
        return Octaves(0u, noise.num_main, noise.main_gain);
    }
    return Octaves(noise.num_main + (m - 1u) * noise.num_distortion, noise.num_distortion, noise.distortion_gain);
}

fn num_slots() -> u32 {
    return noise.num_main + 2u * noise.num_distortion;
}

fn frequency_of(slot: u32) -> f32 {
    return lattice_steps[slot].frequency;
}

fn weight_of(slot: u32) -> f32 {
    return lattice_steps[slot].weight;
}

// Value and gradient of one octave, looked up `bend` cells away.
fn octave(slot: u32, frame: u32, sample: vec2<i32>, bend: vec2<f32>) -> vec3<f32> {
    let own = frames[frame * num_slots() + slot];
    let row = own.direction * num_slots() + slot;
    let origin = lattice[current_tile.first_lattice + row];
    let step = lattice_steps[row];
    let within = vec2<f32>(sample & vec2<i32>(31));
    let place = (origin.fraction + own.fraction) + (within.x * step.x + within.y * step.z) + skewed_way(bend);
    let corner = floor(place);
    let cell = origin.cell + own.cell + bitcast<vec3<u32>>(vec3<i32>(corner));
    var found = noise_basis(cell, place - corner, own.seed, noise.worley_weights);
    if HAS_TRANSFER == 1u {
        let transferred = curve_value(TRANSFER_CURVE, (found.x + 1.0) * 127.5);
        found = vec3<f32>(transferred.x, transferred.y * 127.5 * found.yz);
    }
    return found;
}
