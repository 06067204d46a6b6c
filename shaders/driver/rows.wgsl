// For kernels that look at what lies around a sample: four samples of a row and their neighbours in it, on the terrain. An invocation
// makes four columns of AT_ONCE_ALONG_Z rows, going south, and so reads a row once for the three rows that look at it. Whoever
// includes it includes driver/plane.wgsl too.
#include "lib/height.wgsl"

const EAST = vec2<i32>(1, 0);
const SOUTH = vec2<i32>(0, 1);

// What four samples of a row have, and their neighbours in it.
struct Row {
    west: vec4<f32>,
    here: vec4<f32>,
    east: vec4<f32>,
}

fn row_of(west: f32, here: vec4<f32>, east: f32) -> Row {
    return Row(vec4<f32>(west, here.xyz), here, vec4<f32>(here.yzw, east));
}

// Of the first input; beyond the terrain another value.
fn first_or(channel: u32, sample: vec2<i32>, beyond: f32) -> f32 {
    if is_on_terrain(sample) {
        return first_channel_at(channel, sample);
    }
    return beyond;
}

fn first_four(channel: u32, first: vec2<i32>, beyond: f32) -> vec4<f32> {
    return vec4<f32>(
        first_or(channel, first, beyond),
        first_or(channel, first + EAST, beyond),
        first_or(channel, first + 2 * EAST, beyond),
        first_or(channel, first + 3 * EAST, beyond),
    );
}

fn first_row(channel: u32, first: vec2<i32>, beyond: f32) -> Row {
    let west = first_or(channel, first - EAST, beyond);
    return row_of(west, first_four(channel, first, beyond), first_or(channel, first + 4 * EAST, beyond));
}

// Of the second input; 0 beyond the terrain.
fn second_or_0(channel: u32, sample: vec2<i32>) -> f32 {
    if is_on_terrain(sample) {
        return second_channel_at(channel, sample);
    }
    return 0.0;
}

fn second_four(channel: u32, first: vec2<i32>) -> vec4<f32> {
    return vec4<f32>(
        second_or_0(channel, first),
        second_or_0(channel, first + EAST),
        second_or_0(channel, first + 2 * EAST),
        second_or_0(channel, first + 3 * EAST),
    );
}

fn second_row(channel: u32, first: vec2<i32>) -> Row {
    let west = second_or_0(channel, first - EAST);
    return row_of(west, second_four(channel, first), second_or_0(channel, first + 4 * EAST));
}

fn sanitized_heights(heights: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(
        sanitized_height(heights.x),
        sanitized_height(heights.y),
        sanitized_height(heights.z),
        sanitized_height(heights.w),
    );
}
