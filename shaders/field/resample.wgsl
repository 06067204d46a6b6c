// Another ground, laid on the terrain. Twin: orogeny_reference::field::resample.
#include "driver/place.wgsl"

struct Resample {
    scale: f32,
    offset_m: f32,
}

@group(1) @binding(6) var<uniform> resample: Resample;

fn update_sample(sample: vec2<i32>) {
    let place = place_of(sample);
    store(0u, sample, first_between(place.cell, place.fraction) * resample.scale + resample.offset_m);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
