// A symmetric filter along one axis, of every `STRIDE`-th sample, for four values one after another, which read much the same. Twin:
// orogeny_reference::field::convolve.
#include "driver/plane.wgsl"

// orogeny_brush::filter::Axis
override AXIS: u32 = 0u;

// Neighbours on each side, and samples from centre to centre; constants, so that drivers can do without a loop.
override NUM_WEIGHTS: u32 = 0u;
override STRIDE: i32 = 1;

@group(1) @binding(6) var<storage, read> weights: array<f32>;

// The input along the axis through a sample: what is the same for all that are read of it is worked out once.
struct Line {
    first: u32,  // where in the buffer the place 0 of the plane lies
    step: u32,   // from place to place
    origin: i32, // the plane's first place
    period: u32, // after which it is there again, where it is mirrored
}

fn line_through(sample: vec2<i32>) -> Line {
    let input = step_planes.inputs[0];
    var across = sample;
    if (MIRRORED_AXES & (2u >> AXIS)) != 0u {
        across = vec2<i32>(mirrored(sample.x, input.periods.x), mirrored(sample.y, input.periods.y));
    }
    if AXIS == 1u {
        let column = vec2<i32>(across.x, input.plane.origin.y);
        return Line(index_in(input.plane, 0u, column), input.plane.stride, input.plane.origin.y, input.periods.y);
    }
    let row = vec2<i32>(input.plane.origin.x, across.y);
    return Line(index_in(input.plane, 0u, row), 1u, input.plane.origin.x, input.periods.x);
}

fn value_at(line: Line, place: i32) -> f32 {
    var there = place;
    if (MIRRORED_AXES & (1u << AXIS)) != 0u {
        there = mirrored(place, line.period);
    }
    return first_values[line.first + u32(there - line.origin) * line.step];
}

// What lies at a place and so far from the next three centres.
fn values_at(line: Line, place: i32) -> vec4<f32> {
    return vec4<f32>(
        value_at(line, place),
        value_at(line, place + STRIDE),
        value_at(line, place + 2 * STRIDE),
        value_at(line, place + 3 * STRIDE),
    );
}

fn update_sample(sample: vec2<i32>) {
    let line = line_through(sample);
    let place = select(sample.x, sample.y, AXIS == 1u) * STRIDE;
    let centre = values_at(line, place);
    var value = centre;
    // What lies one step nearer on each side, and two: that which lies a stride nearer has three of the next four.
    var before = centre;
    var after = centre;
    var before_last = centre;
    var after_last = centre;
    if STRIDE == 2 {
        before_last = values_at(line, place + 1);
        after_last = vec4<f32>(value_at(line, place - 1), before_last.xyz);
    }
    for (var k = 0u; k < NUM_WEIGHTS; k++) {
        let away = i32(k) + 1;
        var next_before: vec4<f32>;
        var next_after: vec4<f32>;
        if STRIDE <= 2 {
            next_before = vec4<f32>(value_at(line, place - away), select(before, before_last, STRIDE == 2).xyz);
            next_after = vec4<f32>(select(after, after_last, STRIDE == 2).yzw, value_at(line, place + 3 * STRIDE + away));
        } else {
            next_before = values_at(line, place - away);
            next_after = values_at(line, place + away);
        }
        value += weights[k] * ((next_before - centre) + (next_after - centre));
        before_last = before;
        after_last = after;
        before = next_before;
        after = next_after;
    }
    store_four(0u, sample, select(vec2<i32>(1, 0), vec2<i32>(0, 1), AXIS == 1u), value);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
