// What the file of a user's brush sees: its input, and functions to call. A name that is added here is taken from the users.
// The guide is docs/custom-brushes.md.
#include "lib/custom_noise.wgsl"
#include "lib/hash.wgsl"
#include "lib/height.wgsl"
#include "lib/transcendental.wgsl"

struct BrushInput {
    height_m: f32,      // as it is
    weight: f32,        // the amount of the brush, never 0
    place_m: vec2<f32>, // from the instance's centre; of a fill or a wash, from the terrain's first sample
    sample: vec2<i32>,  // on the terrain
    radius_m: f32,
    spacing_m: f32,
    seed: u32,
}
