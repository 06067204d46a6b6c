// H + A u(i, j, seed): white noise. Twin: orogeny_reference::brush::roughen.
#include "driver/local.wgsl"
#include "lib/hash.wgsl"

struct Roughen {
    seed: u32,
}

@group(1) @binding(11) var<uniform> roughen: Roughen;

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    return height + amount * signed_uniform(u32(sample.x), u32(sample.y), roughen.seed);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
