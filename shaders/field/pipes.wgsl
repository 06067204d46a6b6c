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

// Ground and water, what the water carries, and what flows from there in one direction.
struct Column {
    ground: f32,
    water: f32,
    sediment: f32,
    flow: f32,
}

// A neighbour's column; beyond the terrain nothing, on ground of another height.
fn neighbour_at(sample: vec2<i32>, direction: u32, beyond: f32) -> Column {
    if is_on_terrain(sample) {
        return Column(
            first_channel_at(TERRAIN, sample),
            first_channel_at(WATER, sample),
            first_channel_at(SEDIMENT, sample),
            second_channel_at(direction, sample),
        );
    }
    return Column(beyond, 0.0, 0.0, 0.0);
}

// The four of a sample, with what flows from them to it.
struct Neighbours {
    west: Column,
    east: Column,
    north: Column,
    south: Column,
}

fn neighbours_of(sample: vec2<i32>, beyond: f32) -> Neighbours {
    return Neighbours(
        neighbour_at(sample + vec2<i32>(-1, 0), EAST, beyond),
        neighbour_at(sample + vec2<i32>(1, 0), WEST, beyond),
        neighbour_at(sample + vec2<i32>(0, -1), SOUTH, beyond),
        neighbour_at(sample + vec2<i32>(0, 1), NORTH, beyond),
    );
}

fn begin(sample: vec2<i32>) {
    store(TERRAIN, sample, first_channel_at(0u, sample));
    store(WATER, sample, 0.0);
    store(SEDIMENT, sample, 0.0);
}

fn new_flow(direction: u32, sample: vec2<i32>, drop: f32) -> f32 {
    var old = 0.0;
    if PHASE == FLUX {
        old = second_channel_at(direction, sample);
    }
    return max(old * pipes.flowing + pipes.acceleration * drop, 0.0);
}

fn update_flux(sample: vec2<i32>) {
    let ground = first_channel_at(TERRAIN, sample);
    let water = first_channel_at(WATER, sample);
    let at = neighbours_of(sample, WALL_M);
    let w = new_flow(WEST, sample, (ground - at.west.ground) + (water - at.west.water));
    let e = new_flow(EAST, sample, (ground - at.east.ground) + (water - at.east.water));
    let n = new_flow(NORTH, sample, (ground - at.north.ground) + (water - at.north.water));
    let s = new_flow(SOUTH, sample, (ground - at.south.ground) + (water - at.south.water));
    let total = (w + e) + (n + s);
    let scale = min(1.0, ((water + pipes.rain_m) * KEPT) / max(total, LEAST_M));
    store(WEST, sample, enough(w * scale));
    store(EAST, sample, enough(e * scale));
    store(NORTH, sample, enough(n * scale));
    store(SOUTH, sample, enough(s * scale));
}

// The sediment that a flow out of a column takes along.
fn carried(sediment: f32, water: f32, flow: f32) -> f32 {
    return sediment * (flow / max(water + pipes.rain_m, LEAST_M));
}

fn carried_from(column: Column) -> f32 {
    return carried(column.sediment, column.water, column.flow);
}

fn update_ground(sample: vec2<i32>) {
    let height = first_channel_at(TERRAIN, sample);
    let water = first_channel_at(WATER, sample);
    let sediment = first_channel_at(SEDIMENT, sample);
    let out_w = second_channel_at(WEST, sample);
    let out_e = second_channel_at(EAST, sample);
    let out_n = second_channel_at(NORTH, sample);
    let out_s = second_channel_at(SOUTH, sample);
    // Beyond the terrain the ground is level.
    let at = neighbours_of(sample, height);
    let left = (water + pipes.rain_m) - ((out_w + out_e) + (out_n + out_s));
    let new_depth = left + ((at.west.flow + at.east.flow) + (at.north.flow + at.south.flow));
    store(WATER, sample, enough(new_depth * pipes.staying));

    let lost = (carried(sediment, water, out_w) + carried(sediment, water, out_e))
        + (carried(sediment, water, out_n) + carried(sediment, water, out_s));
    let won = (carried_from(at.west) + carried_from(at.east)) + (carried_from(at.north) + carried_from(at.south));
    let load = max(sediment - lost, 0.0) + won;

    let west = at.west.ground;
    let east = at.east.ground;
    let north = at.north.ground;
    let south = at.south.ground;
    let slope = vec2<f32>((east - west) * pipes.slope_scale, (south - north) * pipes.slope_scale);
    let squared = slope.x * slope.x + slope.y * slope.y;
    let sine = sqrt(squared / (1.0 + squared));
    let flow_x = ((at.west.flow - out_w) + (out_e - at.east.flow)) * 0.5;
    let flow_z = ((at.north.flow - out_n) + (out_s - at.south.flow)) * 0.5;
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
