// One pixel of an edge of a triangle.
#include "lib/surface.wgsl"

@fragment
fn main(pixel: SurfaceVertex) -> @location(0) vec4<f32> {
    let coarse = clamp(pixel.tile.y * 0.12, 0.0, 1.0);
    return vec4<f32>(vec3<f32>(0.02, 0.05, 0.10) + coarse * vec3<f32>(0.35, 0.02, 0.0), 1.0);
}
