// A coarse grid turned into a finer one, along one axis. Twin: orogeny_reference::field::interpolate.
#include "driver/plane.wgsl"

// orogeny_brush::filter::Axis
override AXIS: u32 = 0u;

struct Interpolate {
    num_phases: i32,
}

// Weights of three of the four coarse samples around a value; the second has what is left to 1.
struct PhaseWeights {
    before: f32,
    next: f32,
    after_next: f32,
}

@group(1) @binding(6) var<uniform> interpolate: Interpolate;
@group(1) @binding(7) var<storage, read> phases: array<PhaseWeights>;

fn update_sample(sample: vec2<i32>) {
    let axis = select(vec2<i32>(1, 0), vec2<i32>(0, 1), AXIS == 1u);
    let place = select(sample.x, sample.y, AXIS == 1u);
    let phase = (place % interpolate.num_phases + interpolate.num_phases) % interpolate.num_phases;
    let coarse = sample + axis * ((place - phase) / interpolate.num_phases - place);
    let weights = phases[phase];
    let here = first_at(coarse);
    store(0u, sample, here
        + weights.before * (first_at(coarse - axis) - here)
        + weights.next * (first_at(coarse + axis) - here)
        + weights.after_next * (first_at(coarse + 2 * axis) - here));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
