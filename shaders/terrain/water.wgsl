// One pixel of the water's plane: tint by depth, a brighter shore, the sky in it by Fresnel's share. Blended over the ground below it.
#include "scene/light.wgsl"
#include "lib/screen.wgsl"

// Whether the picture gets the tone curve.
override IS_TONED: u32 = 1u;

@group(1) @binding(0) var depths: texture_depth_2d;

const DEEP: vec3<f32> = vec3<f32>(0.010, 0.045, 0.060);
const SHALLOW: vec3<f32> = vec3<f32>(0.09, 0.22, 0.20);
// Which share of the light a metre of water takes.
const ABSORPTION: f32 = 0.35;

// Of a slope of 1, where it is longer than pixels.
fn wave(at: vec2<f32>, direction: vec2<f32>, length_m: f32, pixel_m: f32) -> vec2<f32> {
    let seen = clamp(1.5 - 4.0 * pixel_m / length_m, 0.0, 1.0);
    return seen * direction * cos(dot(at, direction) * (2.0 * PI / length_m));
}

// Slopes of a few crossing waves, where a pixel is so many metres long.
fn waves(at: vec2<f32>, pixel_m: f32) -> vec2<f32> {
    return 0.030 * wave(at, vec2<f32>(0.8, 0.6), 7.3, pixel_m) + 0.024 * wave(at, vec2<f32>(-0.4, 0.917), 4.9, pixel_m)
        + 0.020 * wave(at, vec2<f32>(0.99, -0.14), 2.7, pixel_m) + 0.016 * wave(at, vec2<f32>(-0.71, -0.70), 1.6, pixel_m);
}

@fragment
fn main(pixel: ScreenVertex) -> @location(0) vec4<f32> {
    let ray = frame.ray_forward + pixel.at.x * frame.ray_right + pixel.at.y * frame.ray_up;
    let below_m = frame.water_level_m - frame.eye_height_m;
    let depth = textureLoad(depths, vec2<i32>(pixel.clip.xy), 0);
    // Along the ray, in multiples of its length.
    let to_water = below_m / ray.y;
    var to_ground = 3.0e38;
    if depth > 0.0 { to_ground = frame.near_m / depth; }
    if !(to_water > 0.0) || to_water >= to_ground {
        return vec4<f32>(0.0);
    }
    let relative = ray * to_water;
    let place = (relative.xz + frame.eye_offset_m) / frame.spacing_m;
    let samples = place + vec2<f32>(frame.eye_sample);
    if any(samples < vec2<f32>(0.0)) || any(samples > vec2<f32>(frame.num_samples - vec2<i32>(1))) {
        return vec4<f32>(0.0);
    }
    let through_m = min(to_ground - to_water, 1.0e5) * length(ray);
    let deep_m = max(frame.water_level_m - height_between(0u, place), 0.0);
    let distance_m = length(relative);
    let pixel_m = distance_m * distance_m / (frame.metre_px * max(abs(below_m), 1.0e-3));
    let slopes = waves(relative.xz + frame.eye_offset_m, pixel_m);
    let normal = normalize(vec3<f32>(-slopes.x, 1.0, -slopes.y));
    let to_eye = -normalize(relative);
    let facing = clamp(dot(normal, to_eye), 0.0, 1.0);
    let fresnel = 0.02 + 0.98 * pow(1.0 - facing, 5.0);
    let mirrored = reflect(-to_eye, normal);
    let mirror = sky_radiance(normalize(vec3<f32>(mirrored.x, max(mirrored.y, 0.02), mirrored.z)));
    let glint = pow(clamp(dot(mirrored, frame.to_sun), 0.0, 1.0), 400.0) * 8.0 * frame.sun_light;
    let murk = exp(-ABSORPTION * deep_m);
    let light = (frame.sun_light * max(frame.to_sun.y, 0.0) + frame.sky_light) / PI;
    let body = (DEEP + murk * (SHALLOW - DEEP)) * light * 2.0;
    let foam = smoothstep(0.35, 0.0, deep_m) * 0.25;
    let seen = 1.0 - exp(-ABSORPTION * through_m);
    // What is not toned is as bright as plain ground is.
    let brightness = select(1.0, 0.5 * frame.exposure, IS_TONED == 0u);
    let colour = brightness * (body * seen * (1.0 - fresnel) + fresnel * mirror + glint + vec3<f32>(foam) * light);
    let alpha = clamp(seen * (1.0 - fresnel) + fresnel + foam, 0.0, 1.0);
    if IS_TONED == 0u { return vec4<f32>(colour, alpha); }
    return vec4<f32>(hazed(colour / max(alpha, 1.0e-4), relative) * alpha, alpha);
}
