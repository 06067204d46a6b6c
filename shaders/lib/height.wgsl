// Arithmetic on heights. Twin: orogeny_reference::store.

const MAX_HEIGHT_M = 1.0e7;
const SMALLEST_NORMAL = 1.1754944e-38;

// a + w (b - a), written out: mix differs by driver.
fn lerp(a: f32, b: f32, w: f32) -> f32 {
    return a + w * (b - a);
}

// Clamped to what a terrain holds; denormals become +0.
fn sanitized_height(height_m: f32) -> f32 {
    let clamped = clamp(height_m, -MAX_HEIGHT_M, MAX_HEIGHT_M);
    return select(clamped, 0.0, abs(clamped) < SMALLEST_NORMAL);
}
