// What the ground's vertices give to its pixels.

struct SurfaceVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) relative: vec3<f32>,                  // metres from the eye
    @location(1) @interpolate(flat) tile: vec2<f32>,   // the tile's level, its detail
}
