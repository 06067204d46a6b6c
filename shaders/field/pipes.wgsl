// A part of an iteration of erosion by running water: columns of water joined by pipes, sediment in flux form. What passes between
// two samples both work out alike. Twin: orogeny_reference::field::pipes, which has the formulas and their source.
#include "driver/plane.wgsl"
#include "driver/rows.wgsl"

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
const TO_WEST = 0u;
const TO_EAST = 1u;
const TO_NORTH = 2u;
const TO_SOUTH = 3u;

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

fn enough(values: vec4<f32>) -> vec4<f32> {
    return select(vec4<f32>(0.0), values, values >= vec4<f32>(LEAST_M));
}

fn begin(sample: vec2<i32>) {
    store(TERRAIN, sample, first_channel_at(0u, sample));
    store(WATER, sample, 0.0);
    store(SEDIMENT, sample, 0.0);
}

fn settle(sample: vec2<i32>) {
    let height = first_channel_at(TERRAIN, sample) + first_channel_at(SEDIMENT, sample);
    store(0u, sample, sanitized_height(height));
}

// Ground and water, and what the water carries.
struct Columns {
    ground: Row,
    water: Row,
    sediment: Row,
}

fn columns_at(first: vec2<i32>) -> Columns {
    return Columns(
        first_row(TERRAIN, first, WALL_M),
        first_row(WATER, first, 0.0),
        first_row(SEDIMENT, first, 0.0),
    );
}

fn new_flow(old: vec4<f32>, drop: vec4<f32>) -> vec4<f32> {
    return max(old * pipes.flowing + pipes.acceleration * drop, vec4<f32>(0.0));
}

fn old_flow(direction: u32, first: vec2<i32>) -> vec4<f32> {
    if PHASE == FLUX {
        return second_four(direction, first);
    }
    return vec4<f32>(0.0);
}

fn store_flux(first: vec2<i32>, north: Columns, row: Columns, south: Columns) {
    let ground = row.ground.here;
    let water = row.water.here;
    let w = new_flow(old_flow(TO_WEST, first), (ground - row.ground.west) + (water - row.water.west));
    let e = new_flow(old_flow(TO_EAST, first), (ground - row.ground.east) + (water - row.water.east));
    let n = new_flow(old_flow(TO_NORTH, first), (ground - north.ground.here) + (water - north.water.here));
    let s = new_flow(old_flow(TO_SOUTH, first), (ground - south.ground.here) + (water - south.water.here));
    let total = (w + e) + (n + s);
    let most = (water + pipes.rain_m) * KEPT;
    let scale = min(vec4<f32>(1.0), most / max(total, vec4<f32>(LEAST_M)));
    store_four(TO_WEST, first, EAST, enough(w * scale));
    store_four(TO_EAST, first, EAST, enough(e * scale));
    store_four(TO_NORTH, first, EAST, enough(n * scale));
    store_four(TO_SOUTH, first, EAST, enough(s * scale));
}

// What leaves four samples and what comes to them.
struct Flows {
    out_w: vec4<f32>,
    out_e: vec4<f32>,
    out_n: vec4<f32>,
    out_s: vec4<f32>,
    in_w: vec4<f32>,
    in_e: vec4<f32>,
    in_n: vec4<f32>,
    in_s: vec4<f32>,
}

// The sediment that a flow out of samples takes along; none beyond the terrain, where there is none.
fn carried(sediment: vec4<f32>, water: vec4<f32>, flow: vec4<f32>) -> vec4<f32> {
    return sediment * (flow / max(water + pipes.rain_m, vec4<f32>(LEAST_M)));
}

// Beyond the terrain the ground is level.
fn ground_or(ground: vec4<f32>, beyond: vec4<f32>) -> vec4<f32> {
    return select(ground, beyond, ground >= vec4<f32>(WALL_M));
}

fn store_ground(first: vec2<i32>, north: Columns, row: Columns, south: Columns, flows: Flows) {
    let sediment = row.sediment;
    let water = row.water;
    let flowing_out = (flows.out_w + flows.out_e) + (flows.out_n + flows.out_s);
    let left = (water.here + pipes.rain_m) - flowing_out;
    let new_depth = left + ((flows.in_w + flows.in_e) + (flows.in_n + flows.in_s));
    store_four(WATER, first, EAST, enough(new_depth * pipes.staying));

    let lost = (carried(sediment.here, water.here, flows.out_w) + carried(sediment.here, water.here, flows.out_e))
        + (carried(sediment.here, water.here, flows.out_n) + carried(sediment.here, water.here, flows.out_s));
    let won = (carried(sediment.west, water.west, flows.in_w) + carried(sediment.east, water.east, flows.in_e))
        + (carried(north.sediment.here, north.water.here, flows.in_n)
        + carried(south.sediment.here, south.water.here, flows.in_s));
    let load = max(sediment.here - lost, vec4<f32>(0.0)) + won;

    let height = row.ground.here;
    let west = ground_or(row.ground.west, height);
    let east = ground_or(row.ground.east, height);
    let to_north = ground_or(north.ground.here, height);
    let to_south = ground_or(south.ground.here, height);
    let slope_x = (east - west) * pipes.slope_scale;
    let slope_z = (to_south - to_north) * pipes.slope_scale;
    let squared = slope_x * slope_x + slope_z * slope_z;
    let sine = sqrt(squared / (1.0 + squared));
    let flow_x = ((flows.in_w - flows.out_w) + (flows.out_e - flows.in_e)) * 0.5;
    let flow_z = ((flows.in_n - flows.out_n) + (flows.out_s - flows.in_s)) * 0.5;
    let flow = sqrt(flow_x * flow_x + flow_z * flow_z);
    let capacity = (pipes.capacity * max(sine, vec4<f32>(pipes.min_slope))) * flow;

    let lowest = min(min(west, east), min(to_north, to_south));
    let highest = max(max(west, east), max(to_north, to_south));
    let lacking = capacity - load;
    var dissolving = vec4<f32>(pipes.dissolving);
    if HAS_HARDNESS == 1u {
        let hardness = vec4<f32>(
            third_at(first),
            third_at(first + EAST),
            third_at(first + 2 * EAST),
            third_at(first + 3 * EAST),
        );
        dissolving = dissolving * (1.0 - hardness);
    }
    let taken = min(dissolving * lacking, max(height - lowest, vec4<f32>(0.0)) * 0.5);
    let room = max(max(highest - height, vec4<f32>(0.0)), new_depth) * 0.5;
    let laid = min(pipes.deposition * -lacking, room);
    let new_height = sanitized_heights(height - select(-laid, taken, lacking > vec4<f32>(0.0)));
    let new_load = load + (height - new_height);
    // The rounding of a height may be more than there is to lay down.
    let is_covered = new_load >= vec4<f32>(0.0);
    store_four(TERRAIN, first, EAST, select(height, new_height, is_covered));
    store_four(SEDIMENT, first, EAST, enough(select(load, new_load, is_covered)));
}

fn update_rows(first: vec2<i32>) {
    var north = columns_at(first - SOUTH);
    var row = columns_at(first);
    var from_north = second_four(TO_SOUTH, first - SOUTH);
    var to_north = second_four(TO_NORTH, first);
    for (var z = 0u; z < AT_ONCE_ALONG_Z; z++) {
        let at = first + vec2<i32>(0, i32(z));
        let south = columns_at(at + SOUTH);
        if PHASE == GROUND {
            let to_west = second_row(TO_WEST, at);
            let to_east = second_row(TO_EAST, at);
            let to_south = second_four(TO_SOUTH, at);
            let from_south = second_four(TO_NORTH, at + SOUTH);
            let flows = Flows(
                to_west.here, to_east.here, to_north, to_south, to_east.west, to_west.east, from_north, from_south,
            );
            if is_in_result(at) {
                store_ground(at, north, row, south, flows);
            }
            from_north = to_south;
            to_north = from_south;
        } else if is_in_result(at) {
            store_flux(at, north, row, south);
        }
        north = row;
        row = south;
    }
}

fn update_sample(first: vec2<i32>) {
    switch PHASE {
        case BEGIN: {
            begin(first);
        }
        case FIRST_FLUX, FLUX, GROUND: {
            update_rows(first);
        }
        default: { // SETTLE
            settle(first);
        }
    }
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
