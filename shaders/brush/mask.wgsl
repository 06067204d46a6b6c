// lerp(M, v, A), for masks and selections. Twin: orogeny_reference::brush::mask.
#include "driver/local.wgsl"

struct Mask {
    value: f32,
}

@group(1) @binding(11) var<uniform> mask: Mask;

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    return lerp(height, mask.value, amount);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
