// How much a whole stroke takes of what is made: the largest weight of its instances, into a plane that is 0 elsewhere. Twin:
// orogeny_reference::field::weights.
#include "driver/footprint.wgsl"
#include "lib/plane.wgsl"
#include "lib/tile.wgsl"

const WORKGROUP_SIDE = 16u;

override IS_GATED: u32 = 0u;

@group(1) @binding(3) var<storage, read> instances: array<Instance>;
@group(1) @binding(4) var<storage, read> tiles: array<Tile>;
@group(1) @binding(5) var<storage, read> tile_instances: array<u32>;
@group(1) @binding(6) var<uniform> weights_plane: Plane;
@group(1) @binding(7) var<storage, read> gate_values: array<f32>; // of the same plane
@group(1) @binding(8) var<storage, read_write> weight_values: array<f32>;

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) num_workgroups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    let number = workgroup.y * num_workgroups.x + workgroup.x;
    if number >= arrayLength(&tiles) {
        return;
    }
    let tile = tiles[number];
    for (var z = tile.first.y + local.y; z < tile.end.y; z += WORKGROUP_SIDE) {
        for (var x = tile.first.x + local.x; x < tile.end.x; x += WORKGROUP_SIDE) {
            let sample = tile.page_origin + vec2<i32>(vec2<u32>(x, z));
            var weight = 0.0;
            for (var k = tile.first_index; k < tile.end_index; k++) {
                let instance = instances[tile_instances[k]];
                weight = gathered(weight, amount_of(instance, sample), instance.flow);
            }
            let index = index_in(weights_plane, 0u, sample);
            if IS_GATED == 1u {
                weight = weight * gate_values[index];
            }
            weight_values[index] = weight;
        }
    }
}
