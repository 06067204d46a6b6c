// One vertex of a triangle over the whole picture, infinitely far away: reversed depth is 0 there.
#include "lib/screen.wgsl"

@vertex
fn main(@builtin(vertex_index) vertex: u32) -> ScreenVertex {
    let at = vec2<f32>(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0);
    return ScreenVertex(vec4<f32>(at, 0.0, 1.0), at);
}
