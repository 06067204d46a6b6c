// A sum of two planes, each times a factor. Twin: orogeny_reference::field::combine.
#include "driver/plane.wgsl"

struct Combine {
    factors: vec2<f32>,
}

@group(1) @binding(6) var<uniform> combine: Combine;

fn update_sample(sample: vec2<i32>) {
    store(0u, sample, combine.factors.x * first_at(sample) + combine.factors.y * second_at(sample));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
