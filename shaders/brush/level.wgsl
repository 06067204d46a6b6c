// lerp(H, T, A) towards one target height, both ways or one way only. Twin: orogeny_reference::brush::level.
#include "driver/local.wgsl"

struct Level {
    target_height_m: f32,
    only: u32, // 0 both ways, 1 cut, 2 fill
}

@group(1) @binding(11) var<uniform> level: Level;

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    return lerp(height, goal_of(level.target_height_m, height, level.only), amount);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
