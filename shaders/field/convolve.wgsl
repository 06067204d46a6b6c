// A symmetric filter along one axis, of every `stride`-th sample. Twin: orogeny_reference::field::convolve.
#include "driver/plane.wgsl"

// orogeny_brush::filter::Axis
override AXIS: u32 = 0u;

// Neighbours on each side; a constant, so that drivers can do without a loop.
override NUM_WEIGHTS: u32 = 0u;

struct Convolve {
    stride: i32,
}

@group(1) @binding(6) var<uniform> convolve: Convolve;
@group(1) @binding(7) var<storage, read> weights: array<f32>;

// The input along the axis through a sample: what is the same for all that are read of it is worked out once.
struct Line {
    first: u32,  // where in the buffer the place 0 of the plane lies
    step: u32,   // from place to place
    origin: i32, // the plane's first place
    extent: u32, // of the ground, where it is mirrored
}

fn line_through(sample: vec2<i32>) -> Line {
    let input = step_planes.inputs[0];
    var across = sample;
    if (MIRRORED_INPUTS & 1u) != 0u {
        across = vec2<i32>(mirrored(sample.x, input.extent.x), mirrored(sample.y, input.extent.y));
    }
    if AXIS == 1u {
        let column = vec2<i32>(across.x, input.plane.origin.y);
        return Line(index_in(input.plane, 0u, column), input.plane.stride, input.plane.origin.y, input.extent.y);
    }
    let row = vec2<i32>(input.plane.origin.x, across.y);
    return Line(index_in(input.plane, 0u, row), 1u, input.plane.origin.x, input.extent.x);
}

fn value_at(line: Line, place: i32) -> f32 {
    var there = place;
    if (MIRRORED_INPUTS & 1u) != 0u {
        there = mirrored(place, line.extent);
    }
    return first_values[line.first + u32(there - line.origin) * line.step];
}

fn update_sample(sample: vec2<i32>) {
    let line = line_through(sample);
    let place = select(sample.x, sample.y, AXIS == 1u) * convolve.stride;
    let centre = value_at(line, place);
    var value = centre;
    for (var k = 0u; k < NUM_WEIGHTS; k++) {
        let away = i32(k) + 1;
        value += weights[k] * ((value_at(line, place - away) - centre) + (value_at(line, place + away) - centre));
    }
    store(0u, sample, value);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
