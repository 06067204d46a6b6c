// Where the values of a plane lie in a buffer. Twin: orogeny_field::Plane.

struct Plane {
    origin: vec2<i32>,   // of its first sample, on its grid
    stride: u32,         // values from row to row
    channel_stride: u32, // values from channel to channel
}

fn index_in(plane: Plane, channel: u32, sample: vec2<i32>) -> u32 {
    let local = vec2<u32>(sample - plane.origin);
    return channel * plane.channel_stride + local.y * plane.stride + local.x;
}
