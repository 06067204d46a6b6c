// One pixel of the ground with its materials, in the light of sun and sky.
#include "scene/light.wgsl"
#include "scene/cursor.wgsl"
#include "scene/material.wgsl"
#include "lib/surface.wgsl"

// The share of light that is mirrored: Trowbridge and Reitz's distribution with Schlick's approximations, for a material that mirrors 4 % head-on.
fn mirrored(normal: vec3<f32>, to_eye: vec3<f32>, roughness: f32) -> f32 {
    let half_way = normalize(to_eye + frame.to_sun);
    let alpha = roughness * roughness;
    let facing = clamp(dot(normal, half_way), 0.0, 1.0);
    let spread = facing * facing * (alpha * alpha - 1.0) + 1.0;
    let distribution = alpha * alpha / (PI * spread * spread);
    let grazing = 1.0 - clamp(dot(to_eye, half_way), 0.0, 1.0);
    let fresnel = 0.04 + 0.96 * grazing * grazing * grazing * grazing * grazing;
    let lit = clamp(dot(normal, frame.to_sun), 0.0, 1.0);
    let seen = clamp(dot(normal, to_eye), 0.02, 1.0);
    let k = 0.5 * alpha;
    return distribution * fresnel * lit / (4.0 * (lit * (1.0 - k) + k) * (seen * (1.0 - k) + k));
}

@fragment
fn main(pixel: SurfaceVertex) -> @location(0) vec4<f32> {
    let from_eye = pixel.relative.xz + frame.eye_offset_m;
    let place = from_eye / frame.spacing_m;
    let right = dpdx(pixel.relative);
    let down = dpdy(pixel.relative);
    let level = sample_level(place);
    let height_m = pixel.relative.y + frame.eye_height_m;
    let shape = shape_between(level, place);
    let true_normal = normal_of(shape.gradient);
    let lit = sunlight(pixel.relative, true_normal);
    let seen = sky_share(place, height_m, level);
    let world_m = vec2<f32>(frame.eye_sample) * frame.spacing_m + from_eye;
    let pixel_m = max(length(right.xz), length(down.xz));
    let ways = projections(pixel.relative, right, down, true_normal);
    let shown = normal_of(shape.gradient * frame.slope_exaggeration);
    let material = material_at(ways, shown, height_m, length(shape.gradient), shape.curvature, world_m, pixel_m, overlay_between(u32(level), place));
    let normal = material.normal;
    let occlusion = seen * material.occlusion;
    let sun = frame.sun_light * lit;
    let sky_light = frame.sky_light * (0.5 + 0.5 * normal.y) * occlusion;
    let around = (frame.sun_light * max(frame.to_sun.y, 0.0) + frame.sky_light) * 0.15 * (1.0 - 0.5 * normal.y) * occlusion;
    let scattered = material.albedo / PI * (sun * max(dot(normal, frame.to_sun), 0.0) + sky_light + around);
    let glint = sun * mirrored(normal, -normalize(pixel.relative), material.roughness);
    return vec4<f32>(with_cursors(hazed(scattered + glint, pixel.relative), pixel.relative), 1.0);
}
