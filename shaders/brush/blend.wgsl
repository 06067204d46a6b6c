// lerp(H, G, A) towards a goal of each sample's own: what a filter made of the ground. Twin: orogeny_reference::brush::blend.
#include "driver/local.wgsl"
#include "lib/plane.wgsl"

@group(1) @binding(11) var<uniform> goal_plane: Plane;
@group(1) @binding(12) var<storage, read> goals: array<f32>;

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    let goal = goals[index_in(goal_plane, 0u, sample)];
    return pulled(height, goal, amount);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
