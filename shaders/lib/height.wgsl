// Arithmetic on heights. Twin: orogeny_reference::store.

const MAX_HEIGHT_M = 1.0e7;
const SMALLEST_NORMAL = 1.1754944e-38;

// a + w (b - a), written out: mix differs by driver.
fn lerp(a: f32, b: f32, w: f32) -> f32 {
    return a + w * (b - a);
}

// What a height may be pulled to where it may only go one way: 0 both ways, 1 cut, 2 fill.
fn goal_of(goal: f32, height: f32, only: u32) -> f32 {
    if only == 1u {
        return min(goal, height);
    }
    if only == 2u {
        return max(goal, height);
    }
    return goal;
}

// Whether a height is finite and within what a terrain holds. By its bits: no comparison is sure to see a NaN.
fn is_storable_height(height_m: f32) -> bool {
    return (bitcast<u32>(height_m) & 0x7fffffffu) <= bitcast<u32>(MAX_HEIGHT_M);
}

// Clamped to what a terrain holds; denormals become +0, and so does NaN, which only a damaged page could have brought in.
fn sanitized_height(height_m: f32) -> f32 {
    let magnitude = bitcast<u32>(height_m) & 0x7fffffffu;
    let is_nan = magnitude > 0x7f800000u;
    let clamped = clamp(height_m, -MAX_HEIGHT_M, MAX_HEIGHT_M);
    return select(clamped, 0.0, is_nan || magnitude < bitcast<u32>(SMALLEST_NORMAL));
}

// A height pulled to a goal by an amount, 0..1: by 1 to the goal itself. What is between two heights never leaves them, however it
// is rounded.
fn pulled(height: f32, goal: f32, amount: f32) -> f32 {
    let between = clamp(lerp(height, goal, amount), min(height, goal), max(height, goal));
    return select(between, goal, amount == 1.0);
}
