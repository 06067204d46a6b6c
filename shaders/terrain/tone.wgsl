// One pixel as a screen shows it: light of any strength to what a screen has. The curve is Narkowicz, "ACES filmic tone mapping curve" (2015).
#include "scene/ground.wgsl"
#include "lib/screen.wgsl"

override IS_FILMIC: u32 = 1u;

@group(1) @binding(0) var light: texture_2d<f32>;

// A little noise of one step of 8 bits, so that no band shows in a sky. Interleaved gradient noise: Jimenez, "Next generation post processing" (2014).
fn dither(pixel: vec2<f32>) -> f32 {
    return (fract(52.9829189 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

@fragment
fn main(pixel: ScreenVertex) -> @location(0) vec4<f32> {
    let colour = textureLoad(light, vec2<i32>(pixel.clip.xy), 0).xyz;
    if IS_FILMIC == 0u {
        return vec4<f32>(clamp(colour, vec3<f32>(0.0), vec3<f32>(1.0)), 1.0);
    }
    let exposed = colour * frame.exposure;
    let toned = exposed * (2.51 * exposed + 0.03) / (exposed * (2.43 * exposed + 0.59) + 0.14);
    return vec4<f32>(clamp(toned + dither(pixel.clip.xy), vec3<f32>(0.0), vec3<f32>(1.0)), 1.0);
}
