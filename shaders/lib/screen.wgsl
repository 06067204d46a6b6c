// What a triangle over the whole picture gives to its pixels.

struct ScreenVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec2<f32>, // from -1 to 1, to the right and up
}
