// A part of an iteration of erosion by running water: columns of water joined by pipes, sediment in flux form. What passes between
// two samples both work out alike. Twin: orogeny_reference::field::pipes, which has the formulas and their source.
#include "driver/plane.wgsl"
#include "lib/height.wgsl"

// orogeny_brush::filter::PipesPhase
const BEGIN = 0u;
const FIRST_FLUX = 1u;
const FLUX = 2u;
const GROUND = 3u;

// Constants, so that a kernel holds the code of its own part only.
override PHASE: u32 = 0u;
// Whether the third plane of the ground is the hardness.
override HAS_HARDNESS: u32 = 0u;

// Channels of ground, water and sediment, and of flows.
const TERRAIN = 0u;
const WATER = 1u;
const SEDIMENT = 2u;
const WEST = 0u;
const EAST = 1u;
const NORTH = 2u;
const SOUTH = 3u;

const LEAST_M = 1.0e-20;
const WALL_M = 1.0e30;
// What leaves a sample is less than all of its water by this share.
const KEPT = 0.99999905;

struct Pipes {
    rain_m: f32,
    staying: f32,
    flowing: f32,
    acceleration: f32,
    capacity: f32,
    min_slope: f32,
    dissolving: f32,
    deposition: f32,
    slope_scale: f32,
}

@group(1) @binding(6) var<uniform> pipes: Pipes;

fn enough(value: f32) -> f32 {
    return select(0.0, value, value >= LEAST_M);
}

fn ground_or(sample: vec2<i32>, beyond: f32) -> f32 {
    if is_on_terrain(sample) {
        return first_channel_at(TERRAIN, sample);
    }
    return beyond;
}

fn water_at(sample: vec2<i32>) -> f32 {
    if is_on_terrain(sample) {
        return first_channel_at(WATER, sample);
    }
    return 0.0;
}

fn flow_at(direction: u32, sample: vec2<i32>) -> f32 {
    if is_on_terrain(sample) {
        return second_channel_at(direction, sample);
    }
    return 0.0;
}

fn begin(sample: vec2<i32>) {
    store(TERRAIN, sample, first_channel_at(0u, sample));
    store(WATER, sample, 0.0);
    store(SEDIMENT, sample, 0.0);
}

fn new_flow(direction: u32, sample: vec2<i32>, neighbour: vec2<i32>) -> f32 {
    var old = 0.0;
    if PHASE == FLUX {
        old = second_channel_at(direction, sample);
    }
    let drop = (first_channel_at(TERRAIN, sample) - ground_or(neighbour, WALL_M))
        + (first_channel_at(WATER, sample) - water_at(neighbour));
    return max(old * pipes.flowing + pipes.acceleration * drop, 0.0);
}

fn update_flux(sample: vec2<i32>) {
    let w = new_flow(WEST, sample, sample + vec2<i32>(-1, 0));
    let e = new_flow(EAST, sample, sample + vec2<i32>(1, 0));
    let n = new_flow(NORTH, sample, sample + vec2<i32>(0, -1));
    let s = new_flow(SOUTH, sample, sample + vec2<i32>(0, 1));
    let total = (w + e) + (n + s);
    let scale = min(1.0, ((first_channel_at(WATER, sample) + pipes.rain_m) * KEPT) / max(total, LEAST_M));
    store(WEST, sample, enough(w * scale));
    store(EAST, sample, enough(e * scale));
    store(NORTH, sample, enough(n * scale));
    store(SOUTH, sample, enough(s * scale));
}

// The sediment that a flow out of a sample takes along.
fn carried(sample: vec2<i32>, flow: f32) -> f32 {
    if !is_on_terrain(sample) {
        return 0.0;
    }
    let share = flow / max(first_channel_at(WATER, sample) + pipes.rain_m, LEAST_M);
    return first_channel_at(SEDIMENT, sample) * share;
}

fn update_ground(sample: vec2<i32>) {
    let at_west = sample + vec2<i32>(-1, 0);
    let at_east = sample + vec2<i32>(1, 0);
    let at_north = sample + vec2<i32>(0, -1);
    let at_south = sample + vec2<i32>(0, 1);
    let out_w = flow_at(WEST, sample);
    let out_e = flow_at(EAST, sample);
    let out_n = flow_at(NORTH, sample);
    let out_s = flow_at(SOUTH, sample);
    let in_w = flow_at(EAST, at_west);
    let in_e = flow_at(WEST, at_east);
    let in_n = flow_at(SOUTH, at_north);
    let in_s = flow_at(NORTH, at_south);
    let left = (first_channel_at(WATER, sample) + pipes.rain_m) - ((out_w + out_e) + (out_n + out_s));
    let new_depth = left + ((in_w + in_e) + (in_n + in_s));
    store(WATER, sample, enough(new_depth * pipes.staying));

    let lost = (carried(sample, out_w) + carried(sample, out_e)) + (carried(sample, out_n) + carried(sample, out_s));
    let won = (carried(at_west, in_w) + carried(at_east, in_e)) + (carried(at_north, in_n) + carried(at_south, in_s));
    let load = max(first_channel_at(SEDIMENT, sample) - lost, 0.0) + won;

    let height = first_channel_at(TERRAIN, sample);
    let west = ground_or(at_west, height);
    let east = ground_or(at_east, height);
    let north = ground_or(at_north, height);
    let south = ground_or(at_south, height);
    let slope = vec2<f32>((east - west) * pipes.slope_scale, (south - north) * pipes.slope_scale);
    let squared = slope.x * slope.x + slope.y * slope.y;
    let sine = sqrt(squared / (1.0 + squared));
    let flow_x = ((in_w - out_w) + (out_e - in_e)) * 0.5;
    let flow_z = ((in_n - out_n) + (out_s - in_s)) * 0.5;
    let flow = sqrt(flow_x * flow_x + flow_z * flow_z);
    let capacity = (pipes.capacity * max(sine, pipes.min_slope)) * flow;

    let lowest = min(min(west, east), min(north, south));
    let highest = max(max(west, east), max(north, south));
    let lacking = capacity - load;
    var dissolving = pipes.dissolving;
    if HAS_HARDNESS == 1u {
        dissolving = dissolving * (1.0 - third_at(sample));
    }
    let taken = min(dissolving * lacking, max(height - lowest, 0.0) * 0.5);
    let room = max(max(highest - height, 0.0), new_depth) * 0.5;
    let laid = min(pipes.deposition * -lacking, room);
    let new_height = sanitized_height(height - select(-laid, taken, lacking > 0.0));
    let new_load = load + (height - new_height);
    // The rounding of a height may be more than there is to lay down.
    let is_covered = new_load >= 0.0;
    store(TERRAIN, sample, select(height, new_height, is_covered));
    store(SEDIMENT, sample, enough(select(load, new_load, is_covered)));
}

fn update_sample(sample: vec2<i32>) {
    switch PHASE {
        case BEGIN: {
            begin(sample);
        }
        case FIRST_FLUX, FLUX: {
            update_flux(sample);
        }
        case GROUND: {
            update_ground(sample);
        }
        default: { // SETTLE
            let height = first_channel_at(TERRAIN, sample) + first_channel_at(SEDIMENT, sample);
            store(0u, sample, sanitized_height(height));
        }
    }
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
