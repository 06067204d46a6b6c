// One quantity of several, as a mask. Twin: orogeny_reference::field::channel.
#include "driver/plane.wgsl"

struct Channel {
    number: u32,
    from_value: f32,
    inverse_width: f32,
}

@group(1) @binding(6) var<uniform> channel: Channel;

fn update_sample(sample: vec2<i32>) {
    let value = first_channel_at(channel.number, sample);
    store(0u, sample, clamp((value - channel.from_value) * channel.inverse_width, 0.0, 1.0));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
