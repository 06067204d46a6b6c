// Heights moved by a distance that is the same everywhere, bilinear between samples. Twin: orogeny_reference::field::shift.
#include "driver/plane.wgsl"

struct Shift {
    cell: vec2<i32>,
    fraction: vec2<f32>,
}

@group(1) @binding(6) var<uniform> shift: Shift;

fn update_sample(sample: vec2<i32>) {
    let place = sample + shift.cell;
    let north_west = first_at(place);
    let south_west = first_at(place + vec2<i32>(0, 1));
    let north = north_west + shift.fraction.x * (first_at(place + vec2<i32>(1, 0)) - north_west);
    let south = south_west + shift.fraction.x * (first_at(place + vec2<i32>(1, 1)) - south_west);
    store(0u, sample, north + shift.fraction.y * (south - north));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
