// Where there is another ground, or how much is selected of it. Twin: orogeny_reference::field::cover.
#include "driver/place.wgsl"

override HAS_SELECTION: u32 = 0u;

struct Cover {
    first: vec2<i32>, // sample of the other ground that is copied
    last: vec2<i32>,
    inverse_feather: f32,
    padding: u32,
}

@group(1) @binding(6) var<uniform> cover: Cover;

fn update_sample(sample: vec2<i32>) {
    let place = place_of(sample);
    let from_first = vec2<f32>(place.cell - cover.first) + place.fraction;
    let from_last = vec2<f32>(cover.last - place.cell) - place.fraction;
    let inside = min(min(from_first.x, from_last.x), min(from_first.y, from_last.y));
    if inside < 0.0 {
        store(0u, sample, 0.0);
        return;
    }
    let t = clamp(inside * cover.inverse_feather, 0.0, 1.0);
    var value = select(1.0, t * t * (3.0 - 2.0 * t), cover.inverse_feather > 0.0);
    if HAS_SELECTION == 1u {
        value = value * first_between(place.cell, place.fraction);
    }
    store(0u, sample, value);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
