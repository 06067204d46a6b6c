// Runs a local brush over tiles of pages, in place: each invocation owns every 16th sample of a tile, both ways, and takes
// the tile's instances in stroke order. A kernel includes this file and defines
//     fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32
// Twin: orogeny_brush::executor_cpu.
#include "lib/falloff.wgsl"
#include "lib/height.wgsl"

const WORKGROUP_SIDE = 16u;

// orogeny_field::WeightMode
override WEIGHT_MODE: u32 = 0u;
const DIRECT = 0u;
const BUILD_UP = 1u;
const WASH = 2u;

struct Brush {
    inverse_falloff_ratio: f32,
    falloff_exponent: f32,
    falloff_scale: f32,
    target_height_m: f32,
    ledge_direction: f32, // 1 raises, -1 lowers
    level_only: u32,      // 0 both ways, 1 cut, 2 fill
    seed: u32,
}

// orogeny_field::Instance
struct Instance {
    cell: vec2<i32>,
    fraction: vec2<f32>,
    inverse_radius: f32,
    amplitude: f32,
    reference_height_m: f32,
    inverse_radius_m: f32,
}

struct Tile {
    page_origin: vec2<i32>, // of the page's first sample, on the terrain
    first: vec2<u32>,       // first sample to change, in the page
    end: vec2<u32>,         // one past the last
    heights_layer: u32,
    scratch_layer: u32,     // of `before` and `weights`; wash only
    first_index: u32,       // its instances: tile_instances[first_index .. end_index]
    end_index: u32,
}

struct Counters {
    num_clamped: atomic<u32>,
}

@group(1) @binding(0) var<uniform> brush: Brush;
@group(1) @binding(1) var<storage, read> instances: array<Instance>;
@group(1) @binding(2) var<storage, read> tiles: array<Tile>;
@group(1) @binding(3) var<storage, read> tile_instances: array<u32>;
@group(1) @binding(4) var<storage, read_write> counters: Counters;
@group(1) @binding(5) var heights: texture_storage_2d_array<r32float, read_write>;
@group(1) @binding(6) var before: texture_2d_array<f32>;
@group(1) @binding(7) var weights: texture_storage_2d_array<r32float, read_write>;

fn amount_of(instance: Instance, sample: vec2<i32>) -> f32 {
    let offset = vec2<f32>(sample - instance.cell) - instance.fraction;
    let r = sqrt(offset.x * offset.x + offset.y * offset.y) * instance.inverse_radius;
    let falloff = Falloff(brush.inverse_falloff_ratio, brush.falloff_exponent, brush.falloff_scale);
    let amount = falloff_weight(r, falloff) * instance.amplitude;
    if WEIGHT_MODE == BUILD_UP {
        return -exp_minus_one(amount);
    }
    return amount;
}

fn stored_height(height: f32) -> f32 {
    // Stops well before it would wrap.
    if !is_storable_height(height) && atomicLoad(&counters.num_clamped) < 0xf0000000u {
        atomicAdd(&counters.num_clamped, 1u);
    }
    return sanitized_height(height);
}

// Instances one after another on the height as it is.
fn update_in_place(tile: Tile, texel: vec2<u32>, sample: vec2<i32>) {
    var height = textureLoad(heights, texel, tile.heights_layer).x;
    for (var k = tile.first_index; k < tile.end_index; k++) {
        let instance = instances[tile_instances[k]];
        height = stored_height(new_height(height, amount_of(instance, sample), sample, instance));
    }
    textureStore(heights, texel, tile.heights_layer, vec4<f32>(height));
}

// The largest weight of the stroke so far, on the height from before it.
fn update_wash(tile: Tile, texel: vec2<u32>, sample: vec2<i32>) {
    var weight = textureLoad(weights, texel, tile.scratch_layer).x;
    for (var k = tile.first_index; k < tile.end_index; k++) {
        weight = max(weight, amount_of(instances[tile_instances[k]], sample));
    }
    textureStore(weights, texel, tile.scratch_layer, vec4<f32>(weight));
    let original = textureLoad(before, texel, tile.scratch_layer, 0).x;
    let height = stored_height(new_height(original, weight, sample, instances[tile_instances[tile.first_index]]));
    textureStore(heights, texel, tile.heights_layer, vec4<f32>(height));
}

fn update_tile(workgroup: vec3<u32>, num_workgroups: vec3<u32>, local: vec3<u32>) {
    let index = workgroup.y * num_workgroups.x + workgroup.x;
    if index >= arrayLength(&tiles) {
        return;
    }
    let tile = tiles[index];
    for (var z = tile.first.y + local.y; z < tile.end.y; z += WORKGROUP_SIDE) {
        for (var x = tile.first.x + local.x; x < tile.end.x; x += WORKGROUP_SIDE) {
            let texel = vec2<u32>(x, z);
            let sample = tile.page_origin + vec2<i32>(texel);
            if WEIGHT_MODE == WASH {
                update_wash(tile, texel, sample);
            } else {
                update_in_place(tile, texel, sample);
            }
        }
    }
}
