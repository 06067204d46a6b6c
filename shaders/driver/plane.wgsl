// One sample of a plane an invocation, made of those of other planes. A kernel includes this file and defines
//     fn update_sample(sample: vec2<i32>)
// which hands each channel's value to `store`; or, where neighbours read much the same, the four samples from there on to
// `store_four`, of one row or of several (driver/rows.wgsl). Bindings from 6 on are the kernel's own. Twin: orogeny_brush::executor_cpu::steps.
#include "lib/plane.wgsl"

const WORKGROUP_SIDE = 16u;

// A bit for x and one for z of each input, where what it is a part of is mirrored. A constant: a driver that works out both sides of a
// condition would else find for each sample of the others where it would lie.
override MIRRORED_AXES: u32 = 255u;

// Samples that an invocation makes, along each axis: one or four. orogeny_brush::filter::Step::at_once
override AT_ONCE_ALONG_X: u32 = 1u;
override AT_ONCE_ALONG_Z: u32 = 1u;

struct Input {
    plane: Plane,
    periods: vec2<u32>, // samples after which what it is a part of is there again, once forwards and once backwards
    padding: vec2<u32>,
}

struct Step {
    result: Plane,
    inputs: array<Input, 4>,
    size: vec2<u32>,   // of the result
    extent: vec2<u32>, // samples of the terrain
}

@group(1) @binding(0) var<uniform> step_planes: Step;
@group(1) @binding(1) var<storage, read> first_values: array<f32>;
@group(1) @binding(2) var<storage, read> second_values: array<f32>;
@group(1) @binding(3) var<storage, read> third_values: array<f32>;
@group(1) @binding(4) var<storage, read> fourth_values: array<f32>;
@group(1) @binding(5) var<storage, read_write> result_values: array<f32>;

// Where a place, at most 2^23 from the grid, lies once that is mirrored at its ends: as far from 0 as it is from the nearest
// multiple of the period, or from the next one where the quotient's rounding took that for the nearest. Without a division of
// whole numbers, which costs more than most kernels that read by this. Twin: orogeny_field::Mirrors.
fn mirrored(place: i32, samples: u32) -> i32 {
    let period = i32(samples);
    let nearest = i32(round(f32(place) / f32(max(period, 1))));
    let away = abs(place - nearest * period);
    return select(min(away, period - away), 0, period == 0);
}

fn index_of(input: u32, sample: vec2<i32>) -> u32 {
    var place = sample;
    let periods = step_planes.inputs[input].periods;
    if (MIRRORED_AXES & (1u << (2u * input))) != 0u {
        place.x = mirrored(place.x, periods.x);
    }
    if (MIRRORED_AXES & (2u << (2u * input))) != 0u {
        place.y = mirrored(place.y, periods.y);
    }
    return index_in(step_planes.inputs[input].plane, 0u, place);
}

fn first_at(sample: vec2<i32>) -> f32 {
    return first_values[index_of(0u, sample)];
}

fn second_at(sample: vec2<i32>) -> f32 {
    return second_values[index_of(1u, sample)];
}

fn third_at(sample: vec2<i32>) -> f32 {
    return third_values[index_of(2u, sample)];
}

fn fourth_at(sample: vec2<i32>) -> f32 {
    return fourth_values[index_of(3u, sample)];
}

// Of planes that are read on the terrain only.
fn first_channel_at(channel: u32, sample: vec2<i32>) -> f32 {
    return first_values[index_in(step_planes.inputs[0].plane, channel, sample)];
}

fn second_channel_at(channel: u32, sample: vec2<i32>) -> f32 {
    return second_values[index_in(step_planes.inputs[1].plane, channel, sample)];
}

fn is_on_terrain(sample: vec2<i32>) -> bool {
    return all(sample >= vec2<i32>(0)) && all(sample < vec2<i32>(step_planes.extent));
}

fn store(channel: u32, sample: vec2<i32>, value: f32) {
    result_values[index_in(step_planes.result, channel, sample)] = value;
}

fn is_in_result(sample: vec2<i32>) -> bool {
    return all(sample < step_planes.result.origin + vec2<i32>(step_planes.size));
}

// Of four samples one after another those that the plane has.
fn store_four(channel: u32, first: vec2<i32>, along: vec2<i32>, values: vec4<f32>) {
    store(channel, first, values.x);
    if is_in_result(first + along) {
        store(channel, first + along, values.y);
    }
    if is_in_result(first + 2 * along) {
        store(channel, first + 2 * along, values.z);
    }
    if is_in_result(first + 3 * along) {
        store(channel, first + 3 * along, values.w);
    }
}

fn update_plane(invocation: vec3<u32>) {
    let first = invocation.xy * vec2<u32>(AT_ONCE_ALONG_X, AT_ONCE_ALONG_Z);
    if all(first < step_planes.size) {
        update_sample(step_planes.result.origin + vec2<i32>(first));
    }
}
