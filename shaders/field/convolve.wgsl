// A symmetric filter along one axis, of every `stride`-th sample. Twin: orogeny_reference::field::convolve.
#include "driver/plane.wgsl"

// orogeny_brush::filter::Axis
override AXIS: u32 = 0u;

struct Convolve {
    stride: i32,
    num_weights: u32,
}

@group(1) @binding(6) var<uniform> convolve: Convolve;
@group(1) @binding(7) var<storage, read> weights: array<f32>;

fn update_sample(sample: vec2<i32>) {
    let axis = select(vec2<i32>(1, 0), vec2<i32>(0, 1), AXIS == 1u);
    let place = sample + axis * sample * (convolve.stride - 1);
    let centre = first_at(place);
    var value = centre;
    for (var k = 0u; k < convolve.num_weights; k++) {
        let away = axis * (i32(k) + 1);
        value += weights[k] * ((first_at(place - away) - centre) + (first_at(place + away) - centre));
    }
    store(0u, sample, value);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
