// lerp(H, step(H), A): steps of equal height, level or on a tilted plane. Twin: orogeny_reference::brush::terrace.
#include "driver/local.wgsl"

struct Terrace {
    anchor: vec2<i32>,             // the sample at which the plane has height 0
    plane_m_per_sample: vec2<f32>,
    step_m: f32,
    inverse_step: f32,
    steepness: f32,
    unused: u32,                   // the size is a multiple of 8
}

@group(1) @binding(11) var<uniform> terrace: Terrace;

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    let way = vec2<f32>(sample - terrace.anchor);
    let plane_m = way.x * terrace.plane_m_per_sample.x + way.y * terrace.plane_m_per_sample.y;
    let level = (height - plane_m) * terrace.inverse_step;
    let number = floor(level);
    let within = clamp((level - number - 0.5) * terrace.steepness + 0.5, 0.0, 1.0);
    return lerp(height, terrace.step_m * (number + within) + plane_m, amount);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
