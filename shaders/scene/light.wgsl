// Sun, sky, shadow and haze, and how finely the ground shows in them. Radiances are those of a sun of irradiance 1 before the air. Twins: orogeny_geomip's `sky` and `shadow`.
#include "scene/ground.wgsl"

@group(0) @binding(4) var sky: texture_2d<f32>;
@group(0) @binding(5) var smooth_sampler: sampler;
@group(0) @binding(6) var shadow_maps: texture_depth_2d_array;
@group(0) @binding(7) var shadow_sampler: sampler_comparison;

const PI: f32 = 3.14159265;

// The sky in a direction, but for the sun's disc. Its texture holds half of it, from the sun's side (left) to the other one, and from the zenith down;
// more of it lies near the horizon.
fn sky_radiance(direction: vec3<f32>) -> vec3<f32> {
    let across = length(direction.xz) * length(frame.to_sun.xz);
    var cosine = 0.0;
    if across > 1.0e-6 {
        cosine = clamp(dot(direction.xz, frame.to_sun.xz) / across, -1.0, 1.0);
    }
    let azimuth = acos(cosine) / PI;
    let elevation = 1.0 - sqrt(clamp(direction.y, 0.0, 1.0));
    let size = vec2<f32>(textureDimensions(sky));
    let at = (vec2<f32>(azimuth, elevation) * (size - vec2<f32>(1.0)) + vec2<f32>(0.5)) / size;
    return textureSampleLevel(sky, smooth_sampler, at, 0.0).xyz;
}

// The share of the sun that reaches a place, by the finest shadow map that holds it.
fn sunlight(relative: vec3<f32>, normal: vec3<f32>) -> f32 {
    for (var k = 0u; k < frame.num_cascades; k++) {
        let texel_m = frame.cascade_texel_m[k];
        // Off the ground by as much as a texel's slope may hide.
        let slant = 1.0 - clamp(dot(normal, frame.to_sun), 0.0, 1.0);
        let place = relative + normal * (texel_m * (0.8 + 1.6 * slant));
        let clip = frame.cascades[k] * vec4<f32>(place, 1.0);
        let size = f32(textureDimensions(shadow_maps).x);
        let at = vec2<f32>(0.5 + 0.5 * clip.x, 0.5 - 0.5 * clip.y);
        let rim = 2.5 / size;
        if all(at > vec2<f32>(rim)) && all(at < vec2<f32>(1.0 - rim)) {
            var lit = 0.0;
            for (var z = -1; z <= 1; z++) {
                for (var x = -1; x <= 1; x++) {
                    let offset = vec2<f32>(f32(x), f32(z)) * 1.1 / size;
                    lit += textureSampleCompareLevel(shadow_maps, shadow_sampler, at + offset, k, clip.z);
                }
            }
            return lit / 9.0;
        }
    }
    return 1.0;
}

// The share of the sky that the ground around leaves free, by how far coarser levels lie above a place: what is below them lies in a hollow.
fn sky_share(place: vec2<f32>, height_m: f32, level: f32) -> f32 {
    var hidden = 0.0;
    for (var k = 1u; k <= 5u; k++) {
        let coarse = u32(level) + k + 1u;
        if coarse > frame.top_level + 3u { break; }
        let read = min(coarse, frame.top_level);
        let step_m = frame.spacing_m * f32(1u << read);
        hidden += max(height_between(read, place) - height_m, 0.0) / step_m * 0.55;
    }
    return 1.0 - frame.ambient_occlusion * (1.0 - 1.0 / (1.0 + hidden));
}

fn normal_of(gradient: vec2<f32>) -> vec3<f32> {
    return normalize(vec3<f32>(-gradient.x, 1.0, -gradient.y));
}

// What the air between the eye and a place leaves of its light, and the light that it adds: haze that thins out with height.
// The mean density along a line: Quilez, "Better fog" (2010).
fn hazed(colour: vec3<f32>, relative: vec3<f32>) -> vec3<f32> {
    let distance_m = length(relative);
    if frame.fog_density <= 0.0 || distance_m <= 0.0 {
        return colour;
    }
    let rise = frame.fog_falloff * relative.y;
    var mean = 1.0;
    if abs(rise) > 1.0e-4 {
        mean = (1.0 - exp(-clamp(rise, -60.0, 60.0))) / rise;
    }
    let at_eye = exp(-clamp(frame.fog_falloff * (frame.eye_height_m - frame.fog_base_m), -60.0, 60.0));
    let depth = min(frame.fog_density * at_eye * mean * distance_m, 60.0);
    // Blue goes first, and comes first.
    let left = exp(-depth * vec3<f32>(0.55, 0.8, 1.25));
    let direction = relative / distance_m;
    let air = sky_radiance(normalize(vec3<f32>(direction.x, max(direction.y, 0.06), direction.z)));
    return colour * left + air * (vec3<f32>(1.0) - left);
}

// The level whose samples are as wide as pixels. From how far a place moves from pixel to pixel, across the line of sight; along it up to four times as far. In uniform control flow only.
fn sample_level(place: vec2<f32>) -> f32 {
    let across = length(dpdx(place));
    let along = length(dpdy(place));
    let widest = max(across, along);
    let level = log2(max(max(min(across, along), 0.25 * widest), 1.0e-6));
    return clamp(level, 0.0, f32(frame.top_level));
}
