// The ground as the page pyramid has it: any sample of any level, from the page that the table names. Bind group 0 of all that draws a
// terrain. Twins: orogeny_geomip::PageTable, and its FrameUniform.
//
// Places are samples of full resolution: whole ones, and the rest of one as a fraction, so that nothing is lost 10^6 samples from the origin.

const TABLE_SIDE: i32 = 64;
const SLOT_BITS: u32 = 27u;
const CONSTANT_SLOT: u32 = 0x7ffffffu;
const NO_PAGE: u32 = 0xffffffffu;

struct FrameUniform {
    clip_from_relative: mat4x4<f32>, // from metres relative to the eye
    ray_right: vec3<f32>,         // from the middle of the picture to its right border, one metre before the eye
    near_m: f32,                  // forward distance times depth
    ray_up: vec3<f32>,
    eye_height_m: f32,
    ray_forward: vec3<f32>,
    spacing_m: f32,
    eye_sample: vec2<i32>,        // the sample to the north-west of the eye
    eye_offset_m: vec2<f32>,      // from there to the eye
    num_samples: vec2<i32>,
    page_size_log2: u32,
    top_level: u32,
    slots_a_side_log2: u32,       // of a layer of the page texture
    unpainted_m: f32,
    slope_exaggeration: f32,      // of light alone
    exposure: f32,
    to_sun: vec3<f32>,
    ambient_occlusion: f32,       // 0: none
    sun_light: vec3<f32>,         // irradiance of what faces the sun
    fog_density: f32,             // 1/m, at the fog's base
    sky_light: vec3<f32>,         // irradiance of what faces the zenith, but for the sun
    fog_falloff: f32,             // 1/m of height
    fog_base_m: f32,
    water_level_m: f32,
    low_m: f32,                   // heights of the first and the last colour
    high_m: f32,
    contour_m: f32,               // from contour line to contour line
    metre_px: f32,                // how many pixels a metre at one metre's distance is wide
    overlay_low: f32,             // values of the first and the last colour of the overlay
    overlay_high: f32,
    num_cursors: u32,
    num_cascades: u32,
    pad_a: u32,
    pad_b: u32,
    unpainted_overlay: vec4<f32>, // what lies over the ground where nothing was painted
    cascades: array<mat4x4<f32>, 4>, // shadow maps, from metres relative to the eye
    cascade_texel_m: vec4<f32>,
    windows: array<vec4<i32>, 16>,   // of the page table, by level: first column and row of pages, one past the last
    cursors: array<vec4<f32>, 32>,   // centre relative to the eye along x and z, radius in metres, hardness
}

@group(0) @binding(0) var<uniform> frame: FrameUniform;
@group(0) @binding(1) var<storage, read> page_table: array<u32>;
@group(0) @binding(2) var heights: texture_2d_array<f32>;
@group(0) @binding(3) var overlay: texture_2d_array<f32>; // four masks a sample, or in the first the difference in metres

// Where a sample of a level is read.
struct Found {
    entry: u32,
    level: u32, // of the page
}

fn find(level: u32, sample: vec2<i32>) -> Found {
    for (var above = level; above <= frame.top_level; above++) {
        let page = (sample >> vec2<u32>(above - level)) >> vec2<u32>(frame.page_size_log2);
        let window = frame.windows[above];
        if all(page >= window.xy) && all(page < window.zw) {
            let wrapped = page & vec2<i32>(TABLE_SIDE - 1);
            let entry = page_table[(i32(above) * TABLE_SIDE + wrapped.y) * TABLE_SIDE + wrapped.x];
            return Found(entry, entry >> SLOT_BITS);
        }
    }
    return Found(NO_PAGE, frame.top_level);
}

fn is_page(found: Found) -> bool {
    return found.entry != NO_PAGE && (found.entry & CONSTANT_SLOT) != CONSTANT_SLOT;
}

// Of a place in a page, in samples of its level: the texel, and the layer.
fn texel(found: Found, sample: vec2<i32>) -> vec3<i32> {
    let slot = found.entry & CONSTANT_SLOT;
    let side = 1u << frame.slots_a_side_log2;
    let cell = vec2<u32>(slot, slot >> frame.slots_a_side_log2) & vec2<u32>(side - 1u);
    let within = vec2<u32>(sample) & vec2<u32>((1u << frame.page_size_log2) - 1u);
    return vec3<i32>(vec2<i32>((cell << vec2<u32>(frame.page_size_log2)) + within), i32(slot >> (2u * frame.slots_a_side_log2)));
}

fn last_sample(level: u32) -> vec2<i32> {
    return (frame.num_samples - vec2<i32>(1)) >> vec2<u32>(level);
}

// A sample of a page's level, or, where that lies in another page that is not there, the nearest of the page.
fn beside(found: Found, page: vec2<i32>, sample: vec2<i32>) -> f32 {
    let first = page << vec2<u32>(frame.page_size_log2);
    let end = first + vec2<i32>((1 << frame.page_size_log2) - 1);
    let inside = clamp(sample, vec2<i32>(0), last_sample(found.level));
    var there = found;
    var nearest = clamp(inside, first, end);
    if any(nearest != inside) {
        let other = find(found.level, inside);
        if other.level == found.level && is_page(other) {
            there = other;
            nearest = inside;
        }
    }
    let at = texel(there, nearest);
    return textureLoad(heights, at.xy, at.z, 0).x;
}

// The height between samples of a page's level.
fn height_in(found: Found, sample: vec2<i32>, fraction: vec2<f32>) -> f32 {
    let page = sample >> vec2<u32>(frame.page_size_log2);
    let north = beside(found, page, sample);
    let north_east = beside(found, page, sample + vec2<i32>(1, 0));
    let south = beside(found, page, sample + vec2<i32>(0, 1));
    let south_east = beside(found, page, sample + vec2<i32>(1, 1));
    let above = north + fraction.x * (north_east - north);
    let below = south + fraction.x * (south_east - south);
    return above + fraction.y * (below - above);
}

// A sample of a level; while its page is not there, what the next coarser one has there. `sample` lies on the terrain.
fn height_at(level: u32, sample: vec2<i32>) -> f32 {
    let found = find(level, sample);
    if !is_page(found) {
        return frame.unpainted_m;
    }
    if found.level == level {
        let at = texel(found, sample);
        return textureLoad(heights, at.xy, at.z, 0).x;
    }
    let coarser = found.level - level;
    let rest = sample & vec2<i32>((1 << coarser) - 1);
    return height_in(found, sample >> vec2<u32>(coarser), vec2<f32>(rest) / f32(1u << coarser));
}

// A place on the ground relative to the eye's sample, in samples of full resolution; its whole sample of a level and the rest.
struct LevelPlace {
    sample: vec2<i32>,
    fraction: vec2<f32>,
}

fn level_place(level: u32, place: vec2<f32>) -> LevelPlace {
    let whole = floor(place);
    let sample = frame.eye_sample + vec2<i32>(whole);
    let rest = vec2<f32>(sample & vec2<i32>((1 << level) - 1)) + (place - whole);
    return LevelPlace(sample >> vec2<u32>(level), rest / f32(1u << level));
}

// The height of a level between its samples.
fn height_between(level: u32, place: vec2<f32>) -> f32 {
    let last = last_sample(level);
    let at = level_place(level, place);
    let found = find(level, clamp(at.sample, vec2<i32>(0), last));
    if !is_page(found) {
        return frame.unpainted_m;
    }
    if found.level == level {
        return height_in(found, clamp(at.sample, vec2<i32>(0), last), at.fraction);
    }
    let coarser = level_place(found.level, place);
    return height_in(found, clamp(coarser.sample, vec2<i32>(0), last_sample(found.level)), coarser.fraction);
}

// What light and materials need of the ground.
struct Shape {
    gradient: vec2<f32>, // rise over run, to the east and to the south
    curvature: f32,      // 1/m; ridges above 0, hollows below
}

// The shape of a level, which changes smoothly between samples: gradients of four samples, and what lies between them.
fn shape_of(level: u32, place: vec2<f32>) -> Shape {
    let at = level_place(level, place);
    let sample = clamp(at.sample, vec2<i32>(0), last_sample(level));
    var found = find(level, sample);
    if !is_page(found) {
        return Shape(vec2<f32>(0.0), 0.0);
    }
    var base = sample;
    var fraction = at.fraction;
    if found.level != level {
        let coarser = level_place(found.level, place);
        base = clamp(coarser.sample, vec2<i32>(0), last_sample(found.level));
        fraction = coarser.fraction;
    }
    let mask = (1 << frame.page_size_log2) - 1;
    let within = base & vec2<i32>(mask);
    let is_inside = all(within >= vec2<i32>(1)) && all(within <= vec2<i32>(mask - 2))
        && all(base + vec2<i32>(2) <= last_sample(found.level));
    let page = base >> vec2<u32>(frame.page_size_log2);
    let at_base = texel(found, base);
    var rows: array<vec4<f32>, 4>;
    for (var z = 0; z < 4; z++) {
        for (var x = 0; x < 4; x++) {
            let offset = vec2<i32>(x - 1, z - 1);
            if is_inside {
                rows[z][x] = textureLoad(heights, at_base.xy + offset, at_base.z, 0).x;
            } else {
                rows[z][x] = beside(found, page, base + offset);
            }
        }
    }
    let step_m = frame.spacing_m * f32(1u << found.level);
    let weights = vec4<f32>(
        (1.0 - fraction.x) * (1.0 - fraction.y), fraction.x * (1.0 - fraction.y),
        (1.0 - fraction.x) * fraction.y, fraction.x * fraction.y,
    );
    let east = vec4<f32>(rows[1].z - rows[1].x, rows[1].w - rows[1].y, rows[2].z - rows[2].x, rows[2].w - rows[2].y);
    let south = vec4<f32>(rows[2].y - rows[0].y, rows[2].z - rows[0].z, rows[3].y - rows[1].y, rows[3].z - rows[1].z);
    let centre = vec4<f32>(rows[1].y, rows[1].z, rows[2].y, rows[2].z);
    let around = vec4<f32>(
        rows[1].x + rows[1].z + rows[0].y + rows[2].y, rows[1].y + rows[1].w + rows[0].z + rows[2].z,
        rows[2].x + rows[2].z + rows[1].y + rows[3].y, rows[2].y + rows[2].w + rows[1].z + rows[3].z,
    );
    let gradient = vec2<f32>(dot(east, weights), dot(south, weights)) / (2.0 * step_m);
    return Shape(gradient, dot(4.0 * centre - around, weights) / (step_m * step_m));
}

// The shape at a level with a fraction.
fn shape_between(level: f32, place: vec2<f32>) -> Shape {
    let finer = u32(level);
    let fraction = level - f32(finer);
    let first = shape_of(finer, place);
    if fraction == 0.0 {
        return first;
    }
    let second = shape_of(min(finer + 1u, frame.top_level), place);
    return Shape(
        first.gradient + fraction * (second.gradient - first.gradient),
        first.curvature + fraction * (second.curvature - first.curvature),
    );
}

// What lies over a sample of a page's level: see `overlay`.
fn overlay_at(sample: vec2<i32>, level: u32) -> vec4<f32> {
    let found = find(level, clamp(sample, vec2<i32>(0), last_sample(level)));
    if !is_page(found) {
        return frame.unpainted_overlay;
    }
    let at = texel(found, clamp(sample >> vec2<u32>(found.level - level), vec2<i32>(0), last_sample(found.level)));
    return textureLoad(overlay, at.xy, at.z, 0);
}

// What lies over the ground of a level between its samples.
fn overlay_between(level: u32, place: vec2<f32>) -> vec4<f32> {
    let at = level_place(level, place);
    let north = overlay_at(at.sample, level);
    let south = overlay_at(at.sample + vec2<i32>(0, 1), level);
    let above = north + at.fraction.x * (overlay_at(at.sample + vec2<i32>(1, 0), level) - north);
    let below = south + at.fraction.x * (overlay_at(at.sample + vec2<i32>(1, 1), level) - south);
    return above + at.fraction.y * (below - above);
}
