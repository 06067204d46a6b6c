// Ground moved along with brushes, in steps so short that nothing folds over. Twin: orogeny_reference::field::grab, which has the
// source.
#include "driver/between.wgsl"

struct Grab {
    num_drags: u32,
    num_steps: u32,
    inverse_num_steps: f32,
}

struct Drag {
    cell: vec2<i32>,
    fraction: vec2<f32>,
    way: vec2<f32>,
    inverse_radius: f32,
    padding: f32,
}

@group(1) @binding(6) var<uniform> grab: Grab;
@group(1) @binding(7) var<storage, read> drags: array<Drag>;
@group(1) @binding(8) var<storage, read> drag_weights: array<f32>; // from the centre to the radius

fn weight_at(r: f32) -> f32 {
    if r >= 1.0 {
        return 0.0;
    }
    let place = r * f32(arrayLength(&drag_weights) - 1u);
    let entry = floor(place);
    let nearer = drag_weights[u32(entry)];
    let further = drag_weights[u32(entry) + 1u];
    return nearer + (place - entry) * (further - nearer);
}

fn moved(sample: vec2<i32>) -> vec2<f32> {
    var sum = vec2<f32>(0.0);
    for (var k = grab.num_steps; k > 0u; k--) {
        let before = sum;
        let gone = f32(k) * grab.inverse_num_steps;
        for (var d = 0u; d < grab.num_drags; d++) {
            let drag = drags[d];
            let way = vec2<f32>(sample - drag.cell) - drag.fraction - before - gone * drag.way;
            let r = sqrt(way.x * way.x + way.y * way.y) * drag.inverse_radius;
            sum += weight_at(r) * (drag.way * grab.inverse_num_steps);
        }
    }
    return sum;
}

fn update_sample(sample: vec2<i32>) {
    let back = -moved(sample);
    let cell = floor(back);
    store(0u, sample, first_between(sample + vec2<i32>(cell), back - cell));
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
