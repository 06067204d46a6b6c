// Half an iteration of thermal erosion: the shares of a sample that slide, or the heights once they have. What passes between two
// samples both work out alike. Twin: orogeny_reference::field::thermal, which has the formulas and their source.
#include "driver/plane.wgsl"
#include "lib/height.wgsl"

// orogeny_brush::filter::ThermalPhase
const SHARES = 0u;

// Constants, so that a kernel holds the code of its own part only.
override PHASE: u32 = 0u;
// Whether the second plane of shares is the hardness.
override HAS_HARDNESS: u32 = 0u;

const SQRT_2 = 1.41421354;
// Where there is no neighbour: nothing slides up it.
const WALL_M = 1.0e30;
// Smaller excesses do not move.
const LEAST_EXCESS_M = 1.0e-30;

struct Thermal {
    num_layers: u32,
}

struct ThermalLayer {
    from_m: f32,
    talus_m: f32,
    half_rate: f32,
}

@group(1) @binding(6) var<uniform> thermal: Thermal;
@group(1) @binding(7) var<storage, read> layers: array<ThermalLayer>;

fn height_at(sample: vec2<i32>) -> f32 {
    if is_on_terrain(sample) {
        return first_channel_at(0u, sample);
    }
    return WALL_M;
}

fn rock_at(height: f32) -> ThermalLayer {
    var rock = layers[0];
    for (var k = 1u; k < thermal.num_layers; k++) {
        if height >= layers[k].from_m {
            rock = layers[k];
        }
    }
    return rock;
}

fn excess(height: f32, sample: vec2<i32>, talus_m: f32) -> f32 {
    return max((height - height_at(sample)) - talus_m, 0.0);
}

fn update_shares(sample: vec2<i32>) {
    let height = first_channel_at(0u, sample);
    let rock = rock_at(height);
    let diagonal_m = rock.talus_m * SQRT_2;
    let w = excess(height, sample + vec2<i32>(-1, 0), rock.talus_m);
    let e = excess(height, sample + vec2<i32>(1, 0), rock.talus_m);
    let n = excess(height, sample + vec2<i32>(0, -1), rock.talus_m);
    let s = excess(height, sample + vec2<i32>(0, 1), rock.talus_m);
    let nw = excess(height, sample + vec2<i32>(-1, -1), diagonal_m);
    let ne = excess(height, sample + vec2<i32>(1, -1), diagonal_m);
    let sw = excess(height, sample + vec2<i32>(-1, 1), diagonal_m);
    let se = excess(height, sample + vec2<i32>(1, 1), diagonal_m);
    let largest = max(max(max(w, e), max(n, s)), max(max(nw, se), max(ne, sw)));
    let sum = ((w + e) + (n + s)) + ((nw + se) + (ne + sw));
    var share = 0.0;
    if largest > LEAST_EXCESS_M {
        share = (rock.half_rate * largest) / sum;
    }
    if HAS_HARDNESS == 1u {
        share = share * (1.0 - second_at(sample));
    }
    store(0u, sample, share);
    if thermal.num_layers > 1u {
        store(1u, sample, rock.talus_m);
    }
}

// What a sample gives a neighbour, less what it is given.
fn net(height: f32, share: f32, talus_m: f32, neighbour: vec2<i32>, distance: f32) -> f32 {
    if !is_on_terrain(neighbour) {
        return 0.0;
    }
    let drop = height - first_channel_at(0u, neighbour);
    var there_m = talus_m;
    if thermal.num_layers > 1u {
        there_m = second_channel_at(1u, neighbour);
    }
    let given = share * max(drop - talus_m * distance, 0.0);
    return given - second_channel_at(0u, neighbour) * max(-drop - there_m * distance, 0.0);
}

fn update_heights(sample: vec2<i32>) {
    let height = first_channel_at(0u, sample);
    let share = second_channel_at(0u, sample);
    var talus_m = layers[0].talus_m;
    if thermal.num_layers > 1u {
        talus_m = second_channel_at(1u, sample);
    }
    let w = net(height, share, talus_m, sample + vec2<i32>(-1, 0), 1.0);
    let e = net(height, share, talus_m, sample + vec2<i32>(1, 0), 1.0);
    let n = net(height, share, talus_m, sample + vec2<i32>(0, -1), 1.0);
    let s = net(height, share, talus_m, sample + vec2<i32>(0, 1), 1.0);
    let nw = net(height, share, talus_m, sample + vec2<i32>(-1, -1), SQRT_2);
    let ne = net(height, share, talus_m, sample + vec2<i32>(1, -1), SQRT_2);
    let sw = net(height, share, talus_m, sample + vec2<i32>(-1, 1), SQRT_2);
    let se = net(height, share, talus_m, sample + vec2<i32>(1, 1), SQRT_2);
    store(0u, sample, sanitized_height(height - (((w + e) + (n + s)) + ((nw + se) + (ne + sw)))));
}

fn update_sample(sample: vec2<i32>) {
    if PHASE == SHARES {
        update_shares(sample);
    } else {
        update_heights(sample);
    }
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
