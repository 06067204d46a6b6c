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
    // A division of whole numbers would cost more than all else here; the quotient's rounding may lead to the coarse sample beside.
    var coarse_place = i32(floor(f32(place) / f32(interpolate.num_phases)));
    let rest = place - coarse_place * interpolate.num_phases;
    coarse_place += select(0, 1, rest >= interpolate.num_phases) - select(0, 1, rest < 0);
    let coarse = sample + axis * (coarse_place - place);
    let weights = phases[place - coarse_place * interpolate.num_phases];
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
