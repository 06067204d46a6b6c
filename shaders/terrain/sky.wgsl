// One pixel of the sky, where there is no ground: the air and the sun's disc.
#include "scene/light.wgsl"
#include "lib/screen.wgsl"

const SUN_COSINE: f32 = 0.99996; // 0.5 degrees across
const SUN_GLOW: f32 = 40.0;

@fragment
fn main(pixel: ScreenVertex) -> @location(0) vec4<f32> {
    let direction = normalize(frame.ray_forward + pixel.at.x * frame.ray_right + pixel.at.y * frame.ray_up);
    var colour = sky_radiance(direction);
    // Below the horizon there is no sky, but haze.
    colour *= 1.0 - 0.6 * clamp(-direction.y * 3.0, 0.0, 1.0);
    let width = fwidth(dot(direction, frame.to_sun)) + 1.0e-6;
    let disc = clamp((dot(direction, frame.to_sun) - SUN_COSINE) / width + 0.5, 0.0, 1.0);
    colour += disc * SUN_GLOW * frame.sun_light * step(0.0, direction.y);
    return vec4<f32>(colour, 1.0);
}
