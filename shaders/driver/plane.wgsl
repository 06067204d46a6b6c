// One sample of a plane an invocation, made of those of other planes. A kernel includes this file and defines
//     fn update_sample(sample: vec2<i32>)
// which hands each channel's value to `store`. Bindings from 6 on are the kernel's own. Twin: orogeny_brush::executor_cpu::steps.
#include "lib/plane.wgsl"

const WORKGROUP_SIDE = 16u;

struct Input {
    plane: Plane,
    extent: vec2<u32>, // samples of the ground that it is a part of, where that is mirrored at its border; else 0
    padding: vec2<u32>,
}

struct Step {
    result: Plane,
    inputs: array<Input, 4>,
    size: vec2<u32>,   // of the result
    extent: vec2<u32>, // samples of the terrain
    phase: u32,        // which part of an iteration it is, of a simulation
    padding: u32,
}

@group(1) @binding(0) var<uniform> step_planes: Step;
@group(1) @binding(1) var<storage, read> first_values: array<f32>;
@group(1) @binding(2) var<storage, read> second_values: array<f32>;
@group(1) @binding(3) var<storage, read> third_values: array<f32>;
@group(1) @binding(4) var<storage, read> fourth_values: array<f32>;
@group(1) @binding(5) var<storage, read_write> result_values: array<f32>;

// Where a place lies once a grid is mirrored at its ends. Twin: orogeny_field::mirrored.
fn mirrored(place: i32, num_samples: u32) -> i32 {
    let last = i32(num_samples) - 1;
    if last == 0 {
        return 0;
    }
    let period = 2 * last;
    let within = (place % period + period) % period;
    return min(within, period - within);
}

fn index_of(input: u32, channel: u32, sample: vec2<i32>) -> u32 {
    let extent = step_planes.inputs[input].extent;
    var place = sample;
    if extent.x > 0u {
        place = vec2<i32>(mirrored(place.x, extent.x), mirrored(place.y, extent.y));
    }
    return index_in(step_planes.inputs[input].plane, channel, place);
}

fn first_at(sample: vec2<i32>) -> f32 {
    return first_values[index_of(0u, 0u, sample)];
}

fn second_at(sample: vec2<i32>) -> f32 {
    return second_values[index_of(1u, 0u, sample)];
}

fn third_at(sample: vec2<i32>) -> f32 {
    return third_values[index_of(2u, 0u, sample)];
}

fn fourth_at(sample: vec2<i32>) -> f32 {
    return fourth_values[index_of(3u, 0u, sample)];
}

fn first_channel_at(channel: u32, sample: vec2<i32>) -> f32 {
    return first_values[index_of(0u, channel, sample)];
}

fn second_channel_at(channel: u32, sample: vec2<i32>) -> f32 {
    return second_values[index_of(1u, channel, sample)];
}

fn is_on_terrain(sample: vec2<i32>) -> bool {
    return all(sample >= vec2<i32>(0)) && all(sample < vec2<i32>(step_planes.extent));
}

fn store(channel: u32, sample: vec2<i32>, value: f32) {
    result_values[index_in(step_planes.result, channel, sample)] = value;
}

fn update_plane(invocation: vec3<u32>) {
    if all(invocation.xy < step_planes.size) {
        update_sample(step_planes.result.origin + vec2<i32>(invocation.xy));
    }
}
