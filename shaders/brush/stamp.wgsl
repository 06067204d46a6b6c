// A height image pressed into the ground, or laid on it. Twin: orogeny_reference::brush::stamp.
#include "driver/local.wgsl"

// orogeny_field::StampMode
override STAMP_MODE: u32 = 0u;
const STAMP_REPLACE = 0u;
const STAMP_ADD = 1u;
const STAMP_MAX = 2u;
const STAMP_MIN = 3u;

struct Stamp {
    scale_m: f32,
}

@group(1) @binding(11) var<uniform> stamp: Stamp;

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    let thickness_m = alpha_value(offset_of(sample, instance), instance) * stamp.scale_m;
    let goal = instance.reference_height_m + thickness_m;
    switch STAMP_MODE {
        case STAMP_ADD: {
            return height + amount * thickness_m;
        }
        case STAMP_MAX: {
            return lerp(height, max(goal, height), amount);
        }
        case STAMP_MIN: {
            return lerp(height, min(goal, height), amount);
        }
        default: { // STAMP_REPLACE
            return lerp(height, goal, amount);
        }
    }
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
