// The next level of a field: the mean of the 3 x 3 samples around every second one, where the sample on the border counts for what
// lies beyond it. Nothing here is rounded but sums of two, so that every device makes the same bits. Twin:
// orogeny_reference::field::coarsen.
#include "driver/plane.wgsl"
#include "lib/height.wgsl"

// Of the level below, whose extent is the terrain's here.
fn below_at(x: i32, z: i32) -> f32 {
    return first_at(clamp(vec2<i32>(x, z), vec2<i32>(0), vec2<i32>(step_planes.extent) - 1));
}

fn column_at(x: i32, z: i32) -> f32 {
    let centre = below_at(x, z);
    return (below_at(x, z - 1) + below_at(x, z + 1)) + (centre + centre);
}

fn update_sample(sample: vec2<i32>) {
    let x = 2 * sample.x;
    let z = 2 * sample.y;
    let middle = column_at(x, z);
    let sum = (column_at(x - 1, z) + column_at(x + 1, z)) + (middle + middle);
    store(0u, sample, sanitized_height(sum * 0.0625));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
