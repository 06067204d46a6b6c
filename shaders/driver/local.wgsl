// Runs a local brush over tiles of pages, in place: each invocation owns every 16th sample of a tile, both ways, and takes
// the tile's instances in stroke order. A kernel includes this file and defines
//     fn new_height(height: f32, amount: f32, sample: vec2<i32>, instance: Instance) -> f32
// Bindings from 11 on are the kernel's own. Twin: orogeny_brush::executor_cpu.
#include "driver/footprint.wgsl"
#include "lib/tile.wgsl"
#include "lib/height.wgsl"

const WORKGROUP_SIDE = 16u;

override IS_GATED: u32 = 0u;
override IS_MASK: u32 = 0u;

struct Counters {
    num_clamped: atomic<u32>,
}

@group(1) @binding(3) var<storage, read> instances: array<Instance>;
@group(1) @binding(4) var<storage, read> tiles: array<Tile>;
@group(1) @binding(5) var<storage, read> tile_instances: array<u32>;
@group(1) @binding(6) var<storage, read_write> counters: Counters;
@group(1) @binding(7) var heights: texture_storage_2d_array<r32float, read_write>;
@group(1) @binding(8) var before: texture_2d_array<f32>;
@group(1) @binding(9) var weights: texture_storage_2d_array<r32float, read_write>;
@group(1) @binding(10) var gates: texture_2d_array<f32>;

// The tile that the workgroup works on.
var<private> current_tile: Tile;

fn stored_height(height: f32) -> f32 {
    if IS_MASK == 1u {
        return sanitized_height(clamp(height, 0.0, 1.0));
    }
    // Stops well before it would wrap.
    if !is_storable_height(height) && atomicLoad(&counters.num_clamped) < 0xf0000000u {
        atomicAdd(&counters.num_clamped, 1u);
    }
    return sanitized_height(height);
}

// What the gate lets through at a sample, 0..1.
fn let_through(tile: Tile, texel: vec2<u32>) -> f32 {
    if IS_GATED == 1u {
        return textureLoad(gates, texel, tile.gate_layer, 0).x;
    }
    return 1.0;
}

// Instances one after another on the height as it is.
fn update_in_place(tile: Tile, texel: vec2<u32>, sample: vec2<i32>) {
    let gate = let_through(tile, texel);
    var height = textureLoad(heights, texel, tile.heights_layer).x;
    for (var k = tile.first_index; k < tile.end_index; k++) {
        let instance = instances[tile_instances[k]];
        height = stored_height(new_height(height, amount_of(instance, sample) * gate, sample, instance));
    }
    textureStore(heights, texel, tile.heights_layer, vec4<f32>(height));
}

// The largest weight of the stroke so far, on the height from before it.
fn update_wash(tile: Tile, texel: vec2<u32>, sample: vec2<i32>) {
    var weight = textureLoad(weights, texel, tile.scratch_layer).x;
    for (var k = tile.first_index; k < tile.end_index; k++) {
        let instance = instances[tile_instances[k]];
        weight = gathered(weight, amount_of(instance, sample), instance.flow);
    }
    textureStore(weights, texel, tile.scratch_layer, vec4<f32>(weight));
    let original = textureLoad(before, texel, tile.scratch_layer, 0).x;
    let amount = weight * let_through(tile, texel);
    let height = stored_height(new_height(original, amount, sample, instances[tile_instances[tile.first_index]]));
    textureStore(heights, texel, tile.heights_layer, vec4<f32>(height));
}

fn update_tile(workgroup: vec3<u32>, num_workgroups: vec3<u32>, local: vec3<u32>) {
    let index = workgroup.y * num_workgroups.x + workgroup.x;
    if index >= arrayLength(&tiles) {
        return;
    }
    let tile = tiles[index];
    current_tile = tile;
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
