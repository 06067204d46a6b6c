// Brushes' rings on the ground, and how strongly they act within.
#include "scene/ground.wgsl"

const RING: vec3<f32> = vec3<f32>(1.0, 0.75, 0.15);
// How many times as much ground a pixel shows at most, as it is seen at a low angle, than one that faces the eye.
const MAX_SLANT: f32 = 6.0;

// In uniform control flow only.
fn with_cursors(colour: vec3<f32>, relative: vec3<f32>) -> vec3<f32> {
    var drawn = colour;
    for (var k = 0u; k < frame.num_cursors; k++) {
        let cursor = frame.cursors[k];
        let away_m = length(relative.xz - cursor.xy);
        // Where a pixel's neighbour is on the ground behind a ridge, their distance is not the ground's in one pixel.
        let largest_m = MAX_SLANT * length(relative) / frame.metre_px;
        let pixel_m = clamp(fwidth(away_m), 1.0e-6, max(largest_m, 1.0e-6));
        if away_m < cursor.z + 4.0 * pixel_m {
            let inner = cursor.z * cursor.w;
            let fade = clamp((away_m - inner) / max(cursor.z - inner, 1.0e-6), 0.0, 1.0);
            let strength = 1.0 - fade * fade * (3.0 - 2.0 * fade);
            drawn += 0.18 * strength * (RING - drawn);
            let ring = clamp(1.6 - abs(away_m - cursor.z) / pixel_m, 0.0, 1.0);
            drawn += ring * (RING - drawn);
        }
    }
    return drawn;
}
