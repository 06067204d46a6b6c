// The lowest and the highest value of a plane, by runs along its rows. Twin: orogeny_field::HeightBounds.
#include "driver/plane.wgsl"

// As whole numbers in the same order as the heights.
@group(1) @binding(6) var<storage, read_write> bounds: array<atomic<u32>, 2>;

fn ordered(height: f32) -> u32 {
    let bits = bitcast<u32>(height);
    return bits ^ select(0x80000000u, 0xffffffffu, (bits >> 31u) == 1u);
}

fn update_sample(first: vec2<i32>) {
    var lowest = 0xffffffffu;
    var highest = 0u;
    let end = min(first.x + i32(AT_ONCE_ALONG_X), step_planes.result.origin.x + i32(step_planes.size.x));
    for (var x = first.x; x < end; x++) {
        let value = ordered(first_at(vec2<i32>(x, first.y)));
        lowest = min(lowest, value);
        highest = max(highest, value);
    }
    atomicMin(&bounds[0], lowest);
    atomicMax(&bounds[1], highest);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
