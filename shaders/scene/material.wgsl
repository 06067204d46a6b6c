// The ground's materials: how much each layer of the set shows at a place, and what they look like together. Twin of the weights:
// orogeny_geomip::material::weights; of the structs: the renderer's `MaterialUniform`.
#include "scene/ground.wgsl"
#include "lib/hash.wgsl"

const MAX_LAYERS: u32 = 16u;
const NO_MASK: u32 = 0xffffffffu;
// What covers less than this is left out.
const LEAST_COVER: f32 = 0.004;
const LEAST_SHARE: f32 = 0.01;
// Three sides, near and far.
const WAYS: u32 = 6u;
// How many times as large a texture is where its repeats would be seen, and from how many repeats away on.
const FAR_TIMES: f32 = 7.3;
const FAR_FROM: f32 = 8.0;
const FAR_TO: f32 = 40.0;

// A ramp is four numbers: where it rises, how steeply, where it falls, how steeply.
struct LayerRule {
    height_m: vec4<f32>,
    slope_tangent: vec4<f32>,
    curvature: vec4<f32>,
    noise: vec4<f32>,      // features a metre, how far it moves borders, where patches lie, how steeply they begin
    look: vec4<f32>,       // greatest weight, repeats a metre
    ids: vec4<u32>,        // seed of the noise, mask
}

struct MaterialUniform {
    blend_depth: f32,
    blend_contrast: f32,
    macro_per_m: f32,
    macro_amount: f32,
    num_layers: u32,
    pad_a: u32,
    pad_b: u32,
    pad_c: u32,
    layers: array<LayerRule, 16>,
    // Where the eye is in each layer's texture along x, y and z, in repeats; the same of the larger one is a part of it.
    eye_repeats: array<vec4<f32>, 16>,
    eye_far_repeats: array<vec4<f32>, 16>,
}

@group(1) @binding(1) var<uniform> materials: MaterialUniform;
@group(1) @binding(2) var albedo_heights: texture_2d_array<f32>;
@group(1) @binding(3) var normal_roughnesses: texture_2d_array<f32>;
@group(1) @binding(4) var material_sampler: sampler;

struct Material {
    albedo: vec3<f32>,
    roughness: f32,
    normal: vec3<f32>,
    occlusion: f32,
}

fn smooth_share(t: f32) -> f32 {
    let share = clamp(t, 0.0, 1.0);
    return share * share * (3.0 - 2.0 * share);
}

fn ramp_at(ramp: vec4<f32>, x: f32) -> f32 {
    return smooth_share((x - ramp.x) * ramp.y) * (1.0 - smooth_share((x - ramp.z) * ramp.w));
}

fn gradient_noise(place: vec2<f32>, seed: u32) -> f32 {
    let cell = floor(place);
    let within = place - cell;
    let corner = vec2<i32>(cell);
    var values = vec4<f32>(0.0);
    for (var k = 0; k < 4; k++) {
        let offset = vec2<i32>(k & 1, k >> 1u);
        let at = bitcast<vec2<u32>>(corner + offset);
        let bits = hash(at.x, at.y, seed);
        let gradient = vec2<f32>(vec2<u32>(bits & 0xffffu, bits >> 16u)) * (1.0 / 32767.5) - vec2<f32>(1.0);
        values[k] = dot(gradient, within - vec2<f32>(offset));
    }
    let fade = within * within * within * (within * (within * 6.0 - vec2<f32>(15.0)) + vec2<f32>(10.0));
    let north = values.x + fade.x * (values.y - values.x);
    let south = values.z + fade.x * (values.w - values.z);
    return north + fade.y * (south - north);
}

fn layer_noise(place: vec2<f32>, seed: u32) -> f32 {
    let sum = 3.0 * gradient_noise(0.4 * place, seed) + 4.0 * gradient_noise(place, seed + 1u)
        + 2.0 * gradient_noise(2.5 * place, seed + 2u);
    let t = clamp(4.6 / 9.0 * sum, -1.0, 1.0);
    return t * (1.5 - 0.5 * t * t);
}

// How much a layer covers what is below it. Where its noise is finer than pixels it counts with its mean.
fn cover_of(layer: u32, height_m: f32, slope: f32, curvature: f32, world_m: vec2<f32>, pixel_m: f32, masks: vec4<f32>) -> f32 {
    let rule = materials.layers[layer];
    var share = ramp_at(rule.height_m, height_m) * ramp_at(rule.slope_tangent, slope) * ramp_at(rule.curvature, curvature);
    if rule.ids.y != NO_MASK { share *= clamp(masks[rule.ids.y & 3u], 0.0, 1.0); }
    if share <= 0.0 {
        return 0.0;
    }
    var noise = 0.0;
    var patched = 1.0;
    if rule.noise.y > 0.0 || rule.noise.z > -10.0 {
        let seen = clamp(1.6 - 2.5 * pixel_m * rule.noise.x, 0.0, 1.0);
        // Half way up their edges lies the share of ground that patches have.
        let mean = clamp(0.5 - 0.5 * (rule.noise.z + 0.5 / rule.noise.w), 0.0, 1.0);
        patched = mean;
        if seen > 0.0 {
            let value = layer_noise(world_m * rule.noise.x, rule.ids.x);
            noise = seen * value;
            patched += seen * (smooth_share((value - rule.noise.z) * rule.noise.w) - mean);
        }
    }
    let moved = clamp(share + rule.noise.y * noise * 4.0 * share * (1.0 - share), 0.0, 1.0);
    return rule.look.x * patched * moved;
}

// Three ways to lay a texture onto the ground: from above, from the west, from the north; how much of each.
struct Projections {
    relative: vec3<f32>,
    right: vec3<f32>,  // how far a place moves from pixel to pixel
    down: vec3<f32>,
    shares: vec3<f32>, // along x, y and z
}

fn projections(relative: vec3<f32>, right: vec3<f32>, down: vec3<f32>, normal: vec3<f32>) -> Projections {
    let sharp = abs(normal) * abs(normal);
    var shares = max(sharp * sharp - vec3<f32>(0.06, 0.0, 0.06), vec3<f32>(0.0));
    shares /= shares.x + shares.y + shares.z;
    return Projections(relative, right, down, shares);
}

// One of the ways to look a layer's texture up: its side (0 from the west, 1 from above, 2 from the north), and whether far off, where a larger repeat
// takes over.
struct LookUp {
    at: vec2<f32>,
    right: vec2<f32>,
    down: vec2<f32>,
    share: f32,
}

fn on_side(side: u32, place: vec3<f32>) -> vec2<f32> {
    return select(select(vec2<f32>(place.x, -place.y), place.xz, side == 1u), vec2<f32>(place.z, -place.y), side == 0u);
}

fn look_up(way: u32, layer: u32, ways: Projections, distance_m: f32) -> LookUp {
    let side = way >> 1u;
    let is_far = (way & 1u) == 1u;
    let repeats = materials.layers[layer].look.y;
    let far = smooth_share((distance_m * repeats - FAR_FROM) / (FAR_TO - FAR_FROM));
    let scale = select(repeats, repeats / FAR_TIMES, is_far);
    let eye = select(materials.eye_repeats[layer].xyz, materials.eye_far_repeats[layer].xyz, is_far);
    let share = ways.shares[side] * select(1.0 - far, far, is_far);
    return LookUp(on_side(side, eye + ways.relative * scale), on_side(side, ways.right * scale), on_side(side, ways.down * scale), share);
}

// A slope of a texture's relief, laid onto the ground.
fn bump_on_side(side: u32, bump: vec2<f32>) -> vec3<f32> {
    let upright = select(vec3<f32>(bump.x, -bump.y, 0.0), vec3<f32>(0.0, -bump.y, bump.x), side == 0u);
    return select(upright, vec3<f32>(bump.x, 0.0, bump.y), side == 1u);
}

// The ground's material at a place with a normal, a height, a slope and a curvature.
fn material_at(ways: Projections, normal: vec3<f32>, height_m: f32, slope: f32, curvature: f32, world_m: vec2<f32>, pixel_m: f32, masks: vec4<f32>) -> Material {
    let distance_m = length(ways.relative);
    var covers: array<f32, 16>;
    var looks: array<vec4<f32>, 16>;
    var left = 1.0;
    var whole = 0.0;
    let num = min(materials.num_layers, MAX_LAYERS);
    for (var k = 0u; k < num; k++) {
        let layer = num - 1u - k;
        var cover = 1.0;
        if layer > 0u { cover = cover_of(layer, height_m, slope, curvature, world_m, pixel_m, masks); }
        covers[layer] = cover * left;
        left *= 1.0 - cover;
        looks[layer] = vec4<f32>(0.0);
    }
    // A texture is looked up at one place of the text only: drivers write all of it out for each.
    for (var k = 0u; k < num * WAYS; k++) {
        let layer = k / WAYS;
        let found = look_up(k % WAYS, layer, ways, distance_m);
        if covers[layer] > LEAST_COVER && found.share > LEAST_SHARE {
            let texel = textureSampleGrad(albedo_heights, material_sampler, found.at, layer, found.right, found.down);
            looks[layer] += found.share * texel;
            whole += covers[layer] * found.share * texel.w;
        }
    }
    var sum = 0.0;
    for (var layer = 0u; layer < num; layer++) {
        covers[layer] = select(0.0, covers[layer], covers[layer] > LEAST_COVER);
        sum += covers[layer] * max(1.0 + (looks[layer].w - whole) / materials.blend_depth, 0.0);
    }
    var albedo = vec3<f32>(0.0);
    var total = 0.0;
    for (var layer = 0u; layer < num; layer++) {
        let cover = covers[layer];
        let blended = cover * max(1.0 + (looks[layer].w - whole) / materials.blend_depth, 0.0) / max(sum, 1.0e-6);
        covers[layer] = cover + materials.blend_contrast * (blended - cover);
        albedo += covers[layer] * looks[layer].xyz;
        total += covers[layer];
    }
    var bumps = vec3<f32>(0.0);
    var rough = vec3<f32>(0.0);
    for (var k = 0u; k < num * WAYS; k++) {
        let layer = k / WAYS;
        let found = look_up(k % WAYS, layer, ways, distance_m);
        let share = covers[layer] * found.share;
        if share > LEAST_SHARE {
            let texel = textureSampleGrad(normal_roughnesses, material_sampler, found.at, layer, found.right, found.down);
            bumps += share * bump_on_side((k % WAYS) >> 1u, texel.xy * 2.0 - vec2<f32>(1.0));
            rough += share * vec3<f32>(texel.zw, 1.0);
        }
    }
    rough /= max(rough.z, 1.0e-6);
    // Brighter and darker, warmer and colder over long ways.
    let broad = world_m * materials.macro_per_m;
    let tone = 0.6 * gradient_noise(broad, 771u) + 0.4 * gradient_noise(broad * 0.23, 772u);
    let warmth = gradient_noise(broad * 0.41, 773u);
    let varied = vec3<f32>(1.0 + 0.35 * warmth, 1.0 + 0.1 * warmth, 1.0 - 0.35 * warmth);
    albedo *= max(1.0 + 1.6 * materials.macro_amount * tone, 0.2) * (vec3<f32>(1.0) + materials.macro_amount * (varied - vec3<f32>(1.0)));
    return Material(albedo / max(total, 1.0e-6), clamp(rough.x, 0.05, 1.0), normalize(normal + bumps), clamp(rough.y, 0.0, 1.0));
}
