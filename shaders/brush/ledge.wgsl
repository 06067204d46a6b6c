// A step: raising fades out one radius above the reference height, lowering one radius below it.
// Twin: orogeny_reference::brush::ledge.
#include "driver/local.wgsl"

struct Ledge {
    direction: f32, // 1 raises, -1 lowers
}

@group(1) @binding(11) var<uniform> ledge: Ledge;

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    let beyond = ledge.direction * (height - instance.reference_height_m);
    return height + amount * (1.0 - clamp(beyond * instance.inverse_radius_m, 0.0, 1.0));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
