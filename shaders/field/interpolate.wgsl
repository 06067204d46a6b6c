// A coarse grid turned into a finer one, along one axis, for four values one after another, which are made of much the same. Twin:
// orogeny_reference::field::interpolate.
#include "driver/plane.wgsl"

// orogeny_brush::filter::Axis
override AXIS: u32 = 0u;

// How many times as fine; a constant, so that drivers have a kernel of its own for two, the step of a pyramid.
override NUM_PHASES: i32 = 2;

// Weights of three of the four coarse samples around a value; the second has what is left to 1.
struct PhaseWeights {
    before: f32,
    next: f32,
    after_next: f32,
}

@group(1) @binding(6) var<storage, read> phases: array<PhaseWeights>;

fn axis() -> vec2<i32> {
    return select(vec2<i32>(1, 0), vec2<i32>(0, 1), AXIS == 1u);
}

// Four values of twice as fine a grid, whose coarse samples are six.
fn between_halves(first: vec2<i32>) -> vec4<f32> {
    let place = select(first.x, first.y, AXIS == 1u);
    let coarse = first + axis() * ((place >> 1u) - place);
    let a = first_at(coarse - axis());
    let b = first_at(coarse);
    let c = first_at(coarse + axis());
    let d = first_at(coarse + 2 * axis());
    let e = first_at(coarse + 3 * axis());
    let f = first_at(coarse + 4 * axis());
    let is_odd = (place & 1) == 1;
    let before = select(vec4<f32>(a, a, b, b), vec4<f32>(a, b, b, c), is_odd);
    let here = select(vec4<f32>(b, b, c, c), vec4<f32>(b, c, c, d), is_odd);
    let next = select(vec4<f32>(c, c, d, d), vec4<f32>(c, d, d, e), is_odd);
    let after_next = select(vec4<f32>(d, d, e, e), vec4<f32>(d, e, e, f), is_odd);
    var p = phases[0];
    var q = phases[1];
    if is_odd {
        let other = p;
        p = q;
        q = other;
    }
    return here
        + vec2<f32>(p.before, q.before).xyxy * (before - here)
        + vec2<f32>(p.next, q.next).xyxy * (next - here)
        + vec2<f32>(p.after_next, q.after_next).xyxy * (after_next - here);
}

// One value of a grid of any fineness.
fn between(sample: vec2<i32>) -> f32 {
    let place = select(sample.x, sample.y, AXIS == 1u);
    // A division of whole numbers would cost more than all else here; the quotient's rounding may lead to the coarse sample beside.
    var coarse_place = i32(floor(f32(place) / f32(NUM_PHASES)));
    let rest = place - coarse_place * NUM_PHASES;
    coarse_place += select(0, 1, rest >= NUM_PHASES) - select(0, 1, rest < 0);
    let coarse = sample + axis() * (coarse_place - place);
    let weights = phases[place - coarse_place * NUM_PHASES];
    let here = first_at(coarse);
    return here
        + weights.before * (first_at(coarse - axis()) - here)
        + weights.next * (first_at(coarse + axis()) - here)
        + weights.after_next * (first_at(coarse + 2 * axis()) - here);
}

fn update_sample(first: vec2<i32>) {
    var values: vec4<f32>;
    if NUM_PHASES == 2 {
        values = between_halves(first);
    } else {
        values = vec4<f32>(
            between(first),
            between(first + axis()),
            between(first + 2 * axis()),
            between(first + 3 * axis()),
        );
    }
    store_four(0u, first, axis(), values);
}

@compute @workgroup_size(WORKGROUP_SIDE, WORKGROUP_SIDE)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
    update_plane(invocation);
}
