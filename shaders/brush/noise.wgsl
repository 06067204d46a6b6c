// H + A T(X), T any noise. Twin: orogeny_reference::brush::noise.
#include "driver/local.wgsl"
#include "driver/turbulence.wgsl"

override FOLLOWS_STROKE: u32 = 0u;
override HAS_CURVE: u32 = 0u;

// The noise at a sample is the same for all instances with the same frame, which most share.
var<private> known_sample: vec2<i32> = vec2<i32>(-1);
var<private> known_frame: u32;
var<private> known_value: f32;

fn noise_value(frame: u32, sample: vec2<i32>) -> f32 {
    let value = (noise_sum(frame, sample) - noise.offset) * noise.scale;
    if HAS_CURVE == 1u {
        return curve_value(RESULT_CURVE, (value + 1.0) * 127.5).x;
    }
    return value;
}

fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32 {
    if FOLLOWS_STROKE == 1u {
        let near = noise_value(instance.frame, sample);
        let next = noise_value(instance.frame + 1u, sample);
        return height + amount * lerp(near, next, instance.frame_blend);
    }
    if any(known_sample != sample) || known_frame != instance.frame {
        known_value = noise_value(instance.frame, sample);
        known_sample = sample;
        known_frame = instance.frame;
    }
    return height + amount * known_value;
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    update_tile(workgroup, num_workgroups, local);
}
