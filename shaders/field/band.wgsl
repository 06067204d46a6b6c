// A level of a Laplacian pyramid, weighted, laid on what the coarser ones came to. Twin: orogeny_reference::field::band.
#include "driver/plane.wgsl"

override IS_COARSEST: u32 = 0u;

struct Band {
    factor: f32,
}

@group(1) @binding(6) var<uniform> band: Band;

fn update_sample(sample: vec2<i32>) {
    let mask = band.factor * first_at(sample);
    if IS_COARSEST == 1u {
        store(0u, sample, mask * second_at(sample));
        return;
    }
    store(0u, sample, fourth_at(sample) + mask * (second_at(sample) - third_at(sample)));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
