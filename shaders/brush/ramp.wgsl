// lerp(H, T, A) towards a slope from the instance's centre to its segment's end. Twin: orogeny_reference::brush::ramp.
#include "driver/local.wgsl"

struct Ramp {
    is_smooth: u32,
    level_only: u32, // 0 both ways, 1 cut, 2 fill
}

@group(1) @binding(11) var<uniform> ramp: Ramp;

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    let way = along_segment(offset_of(sample, instance), instance);
    let share = select(way, way * way * (3.0 - 2.0 * way), ramp.is_smooth == 1u);
    let slope = lerp(instance.reference_height_m, instance.end_height_m, share);
    return lerp(height, goal_of(slope, height, ramp.level_only), amount);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
