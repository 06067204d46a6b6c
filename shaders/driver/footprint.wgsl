// How much an instance acts on a sample: profile, alpha bitmap, weight mode. Twin: orogeny_reference::amounts.
#include "lib/falloff.wgsl"
#include "lib/height.wgsl"

// orogeny_field::WeightMode
override WEIGHT_MODE: u32 = 0u;
const DIRECT = 0u;
const BUILD_UP = 1u;
const WASH = 2u;

// Whether all instances reach all samples alike, as that of a fill does.
override IS_EVERYWHERE: u32 = 0u;
override IS_SEGMENT: u32 = 0u;
override HAS_ALPHA: u32 = 0u;

struct Brush {
    inverse_falloff_ratio: f32,
    falloff_exponent: f32,
    falloff_scale: f32,
}

// orogeny_field::Instance
struct Instance {
    cell: vec2<i32>,
    fraction: vec2<f32>,
    inverse_radius: f32,
    amplitude: f32,
    reference_height_m: f32,
    inverse_radius_m: f32,
    axis: vec2<f32>,
    mirror: f32,
    flow: f32,
    segment: vec2<f32>,
    inverse_segment_squared: f32,
    end_height_m: f32,
    frame: u32,
    frame_blend: f32,
}

@group(1) @binding(0) var<uniform> brush: Brush;
@group(1) @binding(1) var alpha: texture_2d<f32>;
@group(1) @binding(2) var<storage, read> curves: array<f32>;

// Which of the tables in `curves` is what.
const FALLOFF_CURVE = 0u;
const TRANSFER_CURVE = 1u;
const RESULT_CURVE = 2u;

// A curve at `raw` entries from its beginning, and its slope there by the entry. Twin: orogeny_reference::curve.
fn curve_value(curve: u32, raw: f32) -> vec2<f32> {
    let place = clamp(raw, 0.0, 255.0);
    let entry = min(floor(place), 254.0);
    let index = curve * 256u + u32(entry);
    let low = curves[index];
    let high = curves[index + 1u];
    let slope = select(0.0, high - low, raw >= 0.0 && raw <= 255.0);
    return vec2<f32>(low + (place - entry) * (high - low), slope);
}

// The way from an instance's centre to a sample, in samples.
fn offset_of(sample: vec2<i32>, instance: Instance) -> vec2<f32> {
    return vec2<f32>(sample - instance.cell) - instance.fraction;
}

// How far along an instance's segment the place nearest to a sample lies, 0..1.
fn along_segment(way: vec2<f32>, instance: Instance) -> f32 {
    return clamp((way.x * instance.segment.x + way.y * instance.segment.y) * instance.inverse_segment_squared, 0.0, 1.0);
}

fn alpha_pixel(pixel: vec2<i32>, size: vec2<i32>) -> f32 {
    return textureLoad(alpha, clamp(pixel, vec2<i32>(0), size - 1), 0).x;
}

// The bitmap at a place, bilinear between the middles of pixels: the square about the instance's circle, turned.
fn alpha_value(way: vec2<f32>, instance: Instance) -> f32 {
    let size = vec2<i32>(textureDimensions(alpha));
    let turned = vec2<f32>(
        (way.x * instance.axis.x + way.y * instance.axis.y) * instance.mirror,
        way.y * instance.axis.x - way.x * instance.axis.y,
    );
    let place = (turned * instance.inverse_radius * 0.5 + 0.5) * vec2<f32>(size) - 0.5;
    let corner = floor(place);
    let share = place - corner;
    let pixel = vec2<i32>(corner);
    let upper = lerp(alpha_pixel(pixel, size), alpha_pixel(pixel + vec2<i32>(1, 0), size), share.x);
    let lower = lerp(alpha_pixel(pixel + vec2<i32>(0, 1), size), alpha_pixel(pixel + 1, size), share.x);
    return lerp(upper, lower, share.y);
}

// The weight of an instance's profile at a sample that lies so far from its centre, 0..1.
fn profile_weight(way: vec2<f32>, instance: Instance) -> f32 {
    if IS_EVERYWHERE == 1u {
        return 1.0;
    }
    var from_nearest = way;
    if IS_SEGMENT == 1u {
        from_nearest = way - along_segment(way, instance) * instance.segment;
    }
    let r = sqrt(from_nearest.x * from_nearest.x + from_nearest.y * from_nearest.y) * instance.inverse_radius;
    let falloff = Falloff(brush.inverse_falloff_ratio, brush.falloff_exponent, brush.falloff_scale);
    if FALLOFF_FORMULA == CURVE && r < 1.0 {
        return curve_value(FALLOFF_CURVE, falloff_slope(r, falloff) * 255.0).x;
    }
    return falloff_weight(r, falloff);
}

fn amount_of(instance: Instance, sample: vec2<i32>) -> f32 {
    let way = offset_of(sample, instance);
    var amount = profile_weight(way, instance) * instance.amplitude;
    if HAS_ALPHA == 1u {
        amount = amount * alpha_value(way, instance);
    }
    if WEIGHT_MODE == BUILD_UP {
        return -exp_minus_one(amount);
    }
    return amount;
}

// The one weight of a wash stroke, with a further instance: the larger of both, or a share of the way to it.
fn gathered(weight: f32, amount: f32, flow: f32) -> f32 {
    if flow < 1.0 {
        return weight + flow * max(amount - weight, 0.0);
    }
    return max(weight, amount);
}
