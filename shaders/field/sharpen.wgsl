// Heights pushed away from their smoothed ones. Twin: orogeny_reference::field::sharpen.
#include "driver/plane.wgsl"

struct Sharpen {
    gain: f32,
}

@group(1) @binding(6) var<uniform> sharpen: Sharpen;

fn update_sample(sample: vec2<i32>) {
    let height = first_at(sample);
    store(0u, sample, height + sharpen.gain * (height - second_at(sample)));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
