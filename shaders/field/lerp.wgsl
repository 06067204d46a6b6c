// One plane pulled to another by a mask. Twin: orogeny_reference::field::lerp.
#include "driver/plane.wgsl"
#include "lib/height.wgsl"

fn update_sample(sample: vec2<i32>) {
    store(0u, sample, pulled(first_at(sample), second_at(sample), third_at(sample)));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
