// Where there is another ground, or how much is selected of it. Twin: orogeny_reference::field::cover.
#include "driver/place.wgsl"

override HAS_SELECTION: u32 = 0u;

struct Cover {
    extent: vec2<u32>, // samples of the other ground
}

@group(1) @binding(6) var<uniform> cover: Cover;

fn update_sample(sample: vec2<i32>) {
    let place = place_of(sample);
    let last = vec2<i32>(cover.extent) - 1;
    let is_within = place.cell < last | (place.cell == last & place.fraction == vec2<f32>(0.0));
    var value = select(0.0, 1.0, all(place.cell >= vec2<i32>(0)) && all(is_within));
    if HAS_SELECTION == 1u && value > 0.0 {
        value = first_between(place.cell, place.fraction);
    }
    store(0u, sample, value);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
