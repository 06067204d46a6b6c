// One sample of a plane an invocation, made of those of other planes. A kernel includes this file and defines
//     fn update_sample(sample: vec2<i32>)
// which hands each channel's value to `store`. Bindings from 4 on are the kernel's own. Twin: orogeny_brush::executor_cpu::planes.
#include "lib/plane.wgsl"

const WORKGROUP_SIDE = 16u;

struct Step {
    result: Plane,
    first: Plane,
    second: Plane,
    size: vec2<u32>,   // of the result
    extent: vec2<u32>, // samples of the terrain
    is_mirrored: u32,  // whether `first` is mirrored at the terrain's border
    phase: u32,        // which part of an iteration it is, of a simulation
}

@group(1) @binding(0) var<uniform> step_planes: Step;
@group(1) @binding(1) var<storage, read> first_values: array<f32>;
@group(1) @binding(2) var<storage, read> second_values: array<f32>;
@group(1) @binding(3) var<storage, read_write> result_values: array<f32>;

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

fn first_at(sample: vec2<i32>) -> f32 {
    var place = sample;
    if step_planes.is_mirrored == 1u {
        place = vec2<i32>(mirrored(place.x, step_planes.extent.x), mirrored(place.y, step_planes.extent.y));
    }
    return first_values[index_in(step_planes.first, 0u, place)];
}

fn first_channel_at(channel: u32, sample: vec2<i32>) -> f32 {
    return first_values[index_in(step_planes.first, channel, sample)];
}

fn second_channel_at(channel: u32, sample: vec2<i32>) -> f32 {
    return second_values[index_in(step_planes.second, channel, sample)];
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
