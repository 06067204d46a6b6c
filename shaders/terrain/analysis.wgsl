// One pixel of the ground as a plain material or as what there is to know of it.
#include "scene/light.wgsl"
#include "scene/cursor.wgsl"
#include "lib/surface.wgsl"

// 0 shaded, 1 slope, 2 aspect, 3 height bands, 4 contour lines, 5 normals, 6 details, 7 a mask or the difference. Twin: orogeny_geomip::Mode.
override MODE: u32 = 0u;

const CLAY: vec3<f32> = vec3<f32>(0.42, 0.39, 0.34);

// Five colours from 0 to 1.
fn ramp(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, d: vec3<f32>, e: vec3<f32>, t: f32) -> vec3<f32> {
    let at = clamp(t, 0.0, 1.0) * 4.0;
    let first = a + clamp(at, 0.0, 1.0) * (b - a);
    let second = first + clamp(at - 1.0, 0.0, 1.0) * (c - b);
    let third = second + clamp(at - 2.0, 0.0, 1.0) * (d - c);
    return third + clamp(at - 3.0, 0.0, 1.0) * (e - d);
}

fn by_height(t: f32) -> vec3<f32> {
    return ramp(vec3<f32>(0.09, 0.20, 0.09), vec3<f32>(0.29, 0.37, 0.14), vec3<f32>(0.60, 0.50, 0.26),
        vec3<f32>(0.36, 0.23, 0.15), vec3<f32>(0.92, 0.92, 0.92), t);
}

fn by_slope(t: f32) -> vec3<f32> {
    return ramp(vec3<f32>(0.05, 0.25, 0.10), vec3<f32>(0.45, 0.60, 0.10), vec3<f32>(0.90, 0.65, 0.05),
        vec3<f32>(0.75, 0.15, 0.03), vec3<f32>(0.30, 0.02, 0.10), t);
}

// Around the circle; grey-free, so that neighbours differ.
fn by_angle(turn: f32) -> vec3<f32> {
    let wheel = abs(fract(vec3<f32>(turn, turn + 2.0 / 3.0, turn + 1.0 / 3.0)) * 6.0 - vec3<f32>(3.0)) - vec3<f32>(1.0);
    return 0.08 + 0.72 * clamp(wheel, vec3<f32>(0.0), vec3<f32>(1.0));
}

// A line of `width_px` where a value is a multiple of 1.
fn line_at(value: f32, change_a_px: f32, width_px: f32) -> f32 {
    let away_px = abs(fract(value + 0.5) - 0.5) / max(change_a_px, 1.0e-6);
    // Where lines are closer than pixels they fade.
    let faint = clamp(0.35 / max(change_a_px, 1.0e-6), 0.0, 1.0);
    return clamp(0.5 * width_px + 0.5 - away_px, 0.0, 1.0) * faint;
}

// The light of the thesis's section 5.3.2.3: what faces the sun is bright and warm, what does not has the sky's colour.
fn plain_light(normal: vec3<f32>, lit: f32) -> vec3<f32> {
    let facing = max(dot(normal, frame.to_sun), 0.0) * lit;
    let of_sky = vec3<f32>(0.30, 0.36, 0.46);
    let of_sun = vec3<f32>(1.55, 1.42, 1.22);
    return of_sky + facing * (of_sun - of_sky);
}

@fragment
fn main(pixel: SurfaceVertex) -> @location(0) vec4<f32> {
    let place = (pixel.relative.xz + frame.eye_offset_m) / frame.spacing_m;
    let level = sample_level(place);
    let height_m = pixel.relative.y + frame.eye_height_m;
    let height_change = fwidth(height_m / frame.contour_m);
    let thick_change = fwidth(height_m / (5.0 * frame.contour_m));
    let shape = shape_between(level, place);
    let true_normal = normal_of(shape.gradient);
    let normal = normal_of(shape.gradient * frame.slope_exaggeration);
    let lit = sunlight(pixel.relative, true_normal);
    let light = plain_light(normal, lit) * sky_share(place, height_m, level);
    var colour = CLAY * light;
    let span = max(frame.high_m - frame.low_m, 1.0e-6);
    let steepness = atan(length(shape.gradient)) * (2.0 / PI);
    if MODE == 1u { colour = by_slope(steepness / 0.667) * (0.35 + 0.65 * light); }
    if MODE == 2u {
        // Clockwise from the north, downhill.
        let turn = atan2(-shape.gradient.x, shape.gradient.y) / (2.0 * PI);
        let flat = 1.0 - smoothstep(0.002, 0.02, length(shape.gradient));
        colour = by_angle(turn) + flat * (vec3<f32>(0.35) - by_angle(turn));
        colour *= 0.5 + 0.5 * light;
    }
    if MODE == 3u {
        let bands = 24.0;
        let at = (height_m - frame.low_m) / span;
        colour = by_height((floor(clamp(at, 0.0, 0.9999) * bands) + 0.5) / bands) * (0.25 + 0.75 * light);
    }
    if MODE == 4u {
        let thin = line_at(height_m / frame.contour_m, height_change, 1.0);
        let thick = line_at(height_m / (5.0 * frame.contour_m), thick_change, 2.0);
        let ground = by_height((height_m - frame.low_m) / span) * 0.6 + vec3<f32>(0.3);
        colour = ground * (0.45 + 0.55 * light);
        colour += max(0.65 * thin, 0.9 * thick) * (vec3<f32>(0.12, 0.05, 0.02) - colour);
    }
    if MODE == 5u { colour = 0.5 + 0.5 * vec3<f32>(true_normal.x, -true_normal.z, true_normal.y); }
    if MODE == 6u {
        let coarse = pixel.tile.y - pixel.tile.x;
        colour = by_angle(pixel.tile.y * 0.17) * (0.45 + 0.55 * light) * (1.0 - 0.08 * coarse);
    }
    if MODE == 7u {
        let value = overlay_between(u32(level), place).x;
        let at = (value - frame.overlay_low) / max(frame.overlay_high - frame.overlay_low, 1.0e-12);
        let tint = ramp(vec3<f32>(0.02, 0.16, 0.60), vec3<f32>(0.25, 0.50, 0.85), vec3<f32>(0.62, 0.62, 0.60),
            vec3<f32>(0.90, 0.45, 0.15), vec3<f32>(0.65, 0.06, 0.02), at);
        colour = tint * (0.35 + 0.65 * light);
    }
    return vec4<f32>(with_cursors(colour, pixel.relative), 1.0);
}
