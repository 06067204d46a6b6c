// A level of a Laplacian pyramid, weighted, laid on what the coarser ones came to. Twin: orogeny_reference::field::band.
#include "driver/plane.wgsl"

override IS_COARSEST: u32 = 0u;

struct Band {
    factor: f32,
}

@group(1) @binding(6) var<uniform> band: Band;

// The place on the next level, expanded along z, at or before a sample's.
fn coarse_of(sample: vec2<i32>) -> vec2<i32> {
    return vec2<i32>(sample.x >> 1u, sample.y);
}

// A sample expanded along x: of the coarse samples before it, at or before it, and after that.
fn expanded(west: f32, here: f32, east: f32, is_odd: bool) -> f32 {
    let odd = here + 0.5 * (east - here);
    let even = here + 0.125 * (west - here) + 0.125 * (east - here);
    return select(even, odd, is_odd);
}

fn update_sample(sample: vec2<i32>) {
    let mask = band.factor * first_at(sample);
    if IS_COARSEST == 1u {
        store(0u, sample, mask * second_at(sample));
        return;
    }
    let here = coarse_of(sample);
    let is_odd = (sample.x & 1) == 1;
    let step = vec2<i32>(1, 0);
    let coarser = expanded(third_at(here - step), third_at(here), third_at(here + step), is_odd);
    let below = expanded(fourth_at(here - step), fourth_at(here), fourth_at(here + step), is_odd);
    store(0u, sample, below + mask * (second_at(sample) - coarser));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
