// One value of a plane an invocation, made of those of other planes. A kernel includes this file and defines
//     fn value_at(sample: vec2<i32>) -> f32
// Bindings from 4 on are the kernel's own. Twin: orogeny_brush::executor_cpu::planes.

const WORKGROUP_SIDE = 16u;

struct Plane {
    origin: vec2<i32>, // of its first sample, on its grid
    stride: u32,       // samples from row to row
    padding: u32,
}

struct Step {
    result: Plane,
    first: Plane,
    second: Plane,
    size: vec2<u32>,        // of the result
    mirrored_in: vec2<u32>, // samples of the terrain where `first` is mirrored at its border, else 0
}

@group(1) @binding(0) var<uniform> step_planes: Step;
@group(1) @binding(1) var<storage, read> first_values: array<f32>;
@group(1) @binding(2) var<storage, read> second_values: array<f32>;
@group(1) @binding(3) var<storage, read_write> result_values: array<f32>;

// Where a place lies once a grid is mirrored at its ends. Twin: orogeny_field::mirrored.
fn mirrored(place: i32, num_samples: u32) -> i32 {
    let last = i32(num_samples) - 1;
    if last == 0 {
        return 0;
    }
    let period = 2 * last;
    let within = (place % period + period) % period;
    return min(within, period - within);
}

fn index_in(plane: Plane, sample: vec2<i32>) -> u32 {
    let local = vec2<u32>(sample - plane.origin);
    return local.y * plane.stride + local.x;
}

fn first_at(sample: vec2<i32>) -> f32 {
    var place = sample;
    if step_planes.mirrored_in.x > 0u {
        place = vec2<i32>(mirrored(place.x, step_planes.mirrored_in.x), mirrored(place.y, step_planes.mirrored_in.y));
    }
    return first_values[index_in(step_planes.first, place)];
}

fn second_at(sample: vec2<i32>) -> f32 {
    return second_values[index_in(step_planes.second, sample)];
}

fn update_plane(invocation: vec3<u32>) {
    if any(invocation.xy >= step_planes.size) {
        return;
    }
    let sample = step_planes.result.origin + vec2<i32>(invocation.xy);
    result_values[index_in(step_planes.result, sample)] = value_at(sample);
}
