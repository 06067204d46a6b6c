// One vertex of a tile. Twin: orogeny_geomip::DrawnTile::vertex_m, which has the rules.
#include "scene/ground.wgsl"
#include "lib/surface.wgsl"

const TILE_CELLS: i32 = 64;
const MAX_COARSENING: u32 = 5u; // along a rim
const MAX_TURNS: i32 = 16;

struct TileInstance {
    place: vec2<i32>,            // column and row of tiles of its level
    level: u32,
    detail: f32,
    rim: array<vec4<f32>, 4>,    // of its parts, clockwise from the north-western corner
}

// 1: a line is a little nearer than the faces that it lies on.
override IS_LINE: u32 = 0u;

@group(1) @binding(0) var<storage, read> tiles: array<TileInstance>;

// 0 the first place of a side, 2 its middle, 4 its last; 1 and 3 its halves.
fn part_of_side(place: i32) -> u32 {
    if place == 0 { return 0u; }
    if place == TILE_CELLS { return 4u; }
    if place == TILE_CELLS / 2 { return 2u; }
    return select(3u, 1u, place < TILE_CELLS / 2);
}

fn detail_at(tile: u32, place: vec2<i32>) -> f32 {
    let x = part_of_side(place.x);
    let z = part_of_side(place.y);
    var part = 16u;
    if z == 0u { part = x; }
    else if x == 4u { part = 4u + z; }
    else if z == 4u { part = 12u - x; }
    else if x == 0u { part = 16u - z; }
    if part >= 16u {
        return tiles[tile].detail;
    }
    return tiles[tile].rim[part >> 2u][part & 3u];
}

fn rounded(place: vec2<i32>, border: vec2<i32>, coarsening: u32) -> vec2<i32> {
    let down = (place >> vec2<u32>(coarsening)) << vec2<u32>(coarsening);
    return select(down, place, place == border);
}

// Where a level has its sample at a place of the tile, in metres from the eye.
fn sample_position(tile: u32, place: vec2<i32>, level: u32) -> vec3<f32> {
    let full = (tiles[tile].place * TILE_CELLS + place) << vec2<u32>(tiles[tile].level);
    let height_m = height_at(level, min(full >> vec2<u32>(level), last_sample(level)));
    let samples = min(full, frame.num_samples - vec2<i32>(1)) - frame.eye_sample;
    let along = vec2<f32>(samples) * frame.spacing_m - frame.eye_offset_m;
    return vec3<f32>(along.x, height_m - frame.eye_height_m, along.y);
}

@vertex
fn main(@builtin(vertex_index) vertex: u32, @builtin(instance_index) tile: u32) -> SurfaceVertex {
    let own = tiles[tile].level;
    let row = u32(TILE_CELLS + 1);
    let first = (tiles[tile].place * TILE_CELLS) << vec2<u32>(own);
    let cell = (1 << own) - 1;
    let border = min((frame.num_samples - vec2<i32>(1) - first + vec2<i32>(cell)) >> vec2<u32>(own), vec2<i32>(TILE_CELLS));
    var place = min(vec2<i32>(i32(vertex % row), i32(vertex / row)), border);
    var relative = vec3<f32>(0.0);
    var share = 1.0;
    for (var turn = 0; turn < MAX_TURNS; turn++) {
        let detail = detail_at(tile, place);
        let coarsening = min(max(u32(detail), own) - own, MAX_COARSENING);
        let finer = rounded(place, border, coarsening);
        if any(finer != place) {
            // It has fallen together with another one.
            place = finer;
            continue;
        }
        let level = own + coarsening;
        let here = sample_position(tile, place, level);
        let fraction = detail - f32(level);
        if fraction <= 0.0 {
            relative += share * here;
            break;
        }
        let coarser = rounded(place, border, coarsening + 1u);
        if all(coarser == place) {
            let there = sample_position(tile, place, level + 1u);
            relative += share * (here + fraction * (there - here));
            break;
        }
        relative += (share * (1.0 - fraction)) * here;
        share *= fraction;
        place = coarser;
    }
    var clip = frame.clip_from_relative * vec4<f32>(relative, 1.0);
    if IS_LINE == 1u { clip.z *= 1.002; }
    return SurfaceVertex(clip, relative, vec2<f32>(f32(own), tiles[tile].detail));
}
