// Half an iteration of thermal erosion: the shares of samples that slide, or the heights once they have, for four samples of a row,
// whose neighbours are much the same. What passes between two samples both work out alike. Twin: orogeny_reference::field::thermal,
// which has the formulas and their source.
#include "driver/plane.wgsl"
#include "lib/height.wgsl"

// orogeny_brush::filter::ThermalPhase
const SHARES = 0u;

// Constants, so that a kernel holds the code of its own part only.
override PHASE: u32 = 0u;
override NUM_LAYERS: u32 = 1u;
// Whether the second plane of shares is the hardness.
override HAS_HARDNESS: u32 = 0u;

const EAST = vec2<i32>(1, 0);
const SOUTH = vec2<i32>(0, 1);
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

fn height_at(sample: vec2<i32>) -> f32 {
    if is_on_terrain(sample) {
        return first_channel_at(0u, sample);
    }
    return WALL_M;
}

// Of the second plane; beyond the terrain, where nothing slides, 0.
fn share_at(channel: u32, sample: vec2<i32>) -> f32 {
    if is_on_terrain(sample) {
        return second_channel_at(channel, sample);
    }
    return 0.0;
}

// What four samples of a row have, and their neighbours in it.
struct Row {
    west: vec4<f32>,
    here: vec4<f32>,
    east: vec4<f32>,
}

fn row_of(west: f32, here: vec4<f32>, east: f32) -> Row {
    return Row(vec4<f32>(west, here.xyz), here, vec4<f32>(here.yzw, east));
}

fn heights_at(first: vec2<i32>) -> vec4<f32> {
    return vec4<f32>(
        height_at(first),
        height_at(first + EAST),
        height_at(first + 2 * EAST),
        height_at(first + 3 * EAST),
    );
}

fn heights_of(first: vec2<i32>) -> Row {
    return row_of(height_at(first - EAST), heights_at(first), height_at(first + 4 * EAST));
}

fn shares_at(channel: u32, first: vec2<i32>) -> vec4<f32> {
    return vec4<f32>(
        share_at(channel, first),
        share_at(channel, first + EAST),
        share_at(channel, first + 2 * EAST),
        share_at(channel, first + 3 * EAST),
    );
}

fn shares_of(channel: u32, first: vec2<i32>) -> Row {
    return row_of(share_at(channel, first - EAST), shares_at(channel, first), share_at(channel, first + 4 * EAST));
}

fn excess(height: vec4<f32>, neighbour: vec4<f32>, talus_m: vec4<f32>) -> vec4<f32> {
    return max((height - neighbour) - talus_m, vec4<f32>(0.0));
}

fn update_shares(first: vec2<i32>) {
    let north = heights_of(first - SOUTH);
    let row = heights_of(first);
    let south = heights_of(first + SOUTH);
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

// Four samples: heights, shares that slide, and drops that hold.
struct Four {
    height: vec4<f32>,
    share: vec4<f32>,
    talus_m: vec4<f32>,
}

// What samples give neighbours, less what they are given.
fn net(here: Four, height: vec4<f32>, share: vec4<f32>, talus_m: vec4<f32>, distance: f32) -> vec4<f32> {
    let drop = here.height - height;
    let given = here.share * max(drop - here.talus_m * distance, vec4<f32>(0.0));
    return given - share * max(-drop - talus_m * distance, vec4<f32>(0.0));
}

fn taluses_of(first: vec2<i32>) -> Row {
    if NUM_LAYERS > 1u {
        return shares_of(1u, first);
    }
    let talus_m = vec4<f32>(layers[0].talus_m);
    return Row(talus_m, talus_m, talus_m);
}

fn update_heights(first: vec2<i32>) {
    let north = heights_of(first - SOUTH);
    let row = heights_of(first);
    let south = heights_of(first + SOUTH);
    let north_share = shares_of(0u, first - SOUTH);
    let share = shares_of(0u, first);
    let south_share = shares_of(0u, first + SOUTH);
    let north_m = taluses_of(first - SOUTH);
    let talus_m = taluses_of(first);
    let south_m = taluses_of(first + SOUTH);
    let here = Four(row.here, share.here, talus_m.here);
    let w = net(here, row.west, share.west, talus_m.west, 1.0);
    let e = net(here, row.east, share.east, talus_m.east, 1.0);
    let n = net(here, north.here, north_share.here, north_m.here, 1.0);
    let s = net(here, south.here, south_share.here, south_m.here, 1.0);
    let nw = net(here, north.west, north_share.west, north_m.west, SQRT_2);
    let ne = net(here, north.east, north_share.east, north_m.east, SQRT_2);
    let sw = net(here, south.west, south_share.west, south_m.west, SQRT_2);
    let se = net(here, south.east, south_share.east, south_m.east, SQRT_2);
    let height = row.here - (((w + e) + (n + s)) + ((nw + se) + (ne + sw)));
    store_four(0u, first, EAST, vec4<f32>(
        sanitized_height(height.x),
        sanitized_height(height.y),
        sanitized_height(height.z),
        sanitized_height(height.w),
    ));
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
