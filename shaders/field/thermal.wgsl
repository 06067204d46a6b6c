// Half an iteration of thermal erosion: the shares of samples that slide, or the heights once they have. What passes between two
// samples both work out alike. Twin: orogeny_reference::field::thermal, which has the formulas and their source.
#include "driver/plane.wgsl"
#include "driver/rows.wgsl"

// orogeny_brush::filter::ThermalPhase
const SHARES = 0u;

// Constants, so that a kernel holds the code of its own part only.
override PHASE: u32 = 0u;
override NUM_LAYERS: u32 = 1u;
// Whether the second plane of shares is the hardness.
override HAS_HARDNESS: u32 = 0u;

const SQRT_2 = 1.41421354;
// Where there is no neighbour: nothing slides up it.
const WALL_M = 1.0e30;
// Smaller excesses do not move.
const LEAST_EXCESS_M = 1.0e-30;

struct ThermalLayer {
    from_m: f32,
    talus_m: f32,
    half_rate: f32,
}

@group(1) @binding(6) var<storage, read> layers: array<ThermalLayer>;

fn excess(height: vec4<f32>, neighbour: vec4<f32>, talus_m: vec4<f32>) -> vec4<f32> {
    return max((height - neighbour) - talus_m, vec4<f32>(0.0));
}

fn store_shares(first: vec2<i32>, north: Row, row: Row, south: Row) {
    let height = row.here;
    var talus_m = vec4<f32>(layers[0].talus_m);
    var half_rate = vec4<f32>(layers[0].half_rate);
    for (var k = 1u; k < NUM_LAYERS; k++) {
        let is_of_it = height >= vec4<f32>(layers[k].from_m);
        talus_m = select(talus_m, vec4<f32>(layers[k].talus_m), is_of_it);
        half_rate = select(half_rate, vec4<f32>(layers[k].half_rate), is_of_it);
    }
    let diagonal_m = talus_m * SQRT_2;
    let w = excess(height, row.west, talus_m);
    let e = excess(height, row.east, talus_m);
    let n = excess(height, north.here, talus_m);
    let s = excess(height, south.here, talus_m);
    let nw = excess(height, north.west, diagonal_m);
    let ne = excess(height, north.east, diagonal_m);
    let sw = excess(height, south.west, diagonal_m);
    let se = excess(height, south.east, diagonal_m);
    let largest = max(max(max(w, e), max(n, s)), max(max(nw, se), max(ne, sw)));
    let sum = ((w + e) + (n + s)) + ((nw + se) + (ne + sw));
    var share = select(vec4<f32>(0.0), (half_rate * largest) / sum, largest > vec4<f32>(LEAST_EXCESS_M));
    if HAS_HARDNESS == 1u {
        let hardness = vec4<f32>(
            second_at(first),
            second_at(first + EAST),
            second_at(first + 2 * EAST),
            second_at(first + 3 * EAST),
        );
        share = share * (1.0 - hardness);
    }
    store_four(0u, first, EAST, share);
    if NUM_LAYERS > 1u {
        store_four(1u, first, EAST, talus_m);
    }
}

fn update_shares(first: vec2<i32>) {
    var north = first_row(0u, first - SOUTH, WALL_M);
    var row = first_row(0u, first, WALL_M);
    for (var z = 0u; z < AT_ONCE_ALONG_Z; z++) {
        let at = first + vec2<i32>(0, i32(z));
        let south = first_row(0u, at + SOUTH, WALL_M);
        if is_in_result(at) {
            store_shares(at, north, row, south);
        }
        north = row;
        row = south;
    }
}

// Heights, shares that slide, and drops that hold.
struct Slopes {
    height: Row,
    share: Row,
    talus_m: Row,
}

fn slopes_at(first: vec2<i32>) -> Slopes {
    let talus_m = vec4<f32>(layers[0].talus_m);
    var slopes = Slopes(first_row(0u, first, WALL_M), second_row(0u, first), Row(talus_m, talus_m, talus_m));
    if NUM_LAYERS > 1u {
        slopes.talus_m = second_row(1u, first);
    }
    return slopes;
}

// What four samples give neighbours, less what they are given.
fn net(here: Slopes, height: vec4<f32>, share: vec4<f32>, talus_m: vec4<f32>, distance: f32) -> vec4<f32> {
    let drop = here.height.here - height;
    let given = here.share.here * max(drop - here.talus_m.here * distance, vec4<f32>(0.0));
    return given - share * max(-drop - talus_m * distance, vec4<f32>(0.0));
}

fn store_slid(first: vec2<i32>, north: Slopes, row: Slopes, south: Slopes) {
    let w = net(row, row.height.west, row.share.west, row.talus_m.west, 1.0);
    let e = net(row, row.height.east, row.share.east, row.talus_m.east, 1.0);
    let n = net(row, north.height.here, north.share.here, north.talus_m.here, 1.0);
    let s = net(row, south.height.here, south.share.here, south.talus_m.here, 1.0);
    let nw = net(row, north.height.west, north.share.west, north.talus_m.west, SQRT_2);
    let ne = net(row, north.height.east, north.share.east, north.talus_m.east, SQRT_2);
    let sw = net(row, south.height.west, south.share.west, south.talus_m.west, SQRT_2);
    let se = net(row, south.height.east, south.share.east, south.talus_m.east, SQRT_2);
    let height = row.height.here - (((w + e) + (n + s)) + ((nw + se) + (ne + sw)));
    store_four(0u, first, EAST, sanitized_heights(height));
}

fn update_heights(first: vec2<i32>) {
    var north = slopes_at(first - SOUTH);
    var row = slopes_at(first);
    for (var z = 0u; z < AT_ONCE_ALONG_Z; z++) {
        let at = first + vec2<i32>(0, i32(z));
        let south = slopes_at(at + SOUTH);
        if is_in_result(at) {
            store_slid(at, north, row, south);
        }
        north = row;
        row = south;
    }
}

fn update_sample(first: vec2<i32>) {
    if PHASE == SHARES {
        update_shares(first);
    } else {
        update_heights(first);
    }
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
