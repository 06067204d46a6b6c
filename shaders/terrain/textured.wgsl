// One pixel of the ground with its material.
#include "scene/light.wgsl"
#include "scene/cursor.wgsl"
#include "lib/surface.wgsl"

@fragment
fn main(pixel: SurfaceVertex) -> @location(0) vec4<f32> {
    let place = (pixel.relative.xz + frame.eye_offset_m) / frame.spacing_m;
    let level = sample_level(place);
    let height_m = pixel.relative.y + frame.eye_height_m;
    let shape = shape_between(level, place);
    let normal = normal_of(shape.gradient * frame.slope_exaggeration);
    let lit = sunlight(pixel.relative, normal_of(shape.gradient));
    let seen = sky_share(place, height_m, level);
    let steep = smoothstep(0.5, 1.0, length(shape.gradient));
    let albedo = vec3<f32>(0.10, 0.13, 0.05) + steep * (vec3<f32>(0.22, 0.20, 0.18) - vec3<f32>(0.10, 0.13, 0.05));
    let sun = frame.sun_light * max(dot(normal, frame.to_sun), 0.0) * lit;
    let sky_light = frame.sky_light * (0.5 + 0.5 * normal.y) * seen;
    let bounced = (frame.sun_light * max(frame.to_sun.y, 0.0) + frame.sky_light) * 0.12 * (0.5 - 0.5 * normal.y);
    let light = albedo / PI * (sun + sky_light + bounced);
    return vec4<f32>(with_cursors(hazed(light, pixel.relative), pixel.relative), 1.0);
}
