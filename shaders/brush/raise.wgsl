// H + A. Lowering is raising by a negative amount. Twin: orogeny_reference::brush::raise.
#include "driver/local.wgsl"

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    return height + amount;
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
