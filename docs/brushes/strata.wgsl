// Strata: layers of rock, the hard ones standing out as steps, drifting up and down along the slope.
//
// A blending brush: its weight 0..1 says how far the ground goes to what the strata make of it.

// @param step_m: f32 = 12 (0.5 .. 200) "mean thickness of a layer, metres"
// @param sharpness: f32 = 0.7 (0 .. 0.95) "0 leaves the slope as it is, 0.95 makes cliffs"
// @param drift_m: f32 = 4 (0 .. 100) "how far a layer wanders up and down, metres"
// @param drift_size_m: f32 = 150 (5 .. 5000) "over what distance it wanders, metres"
// @param tilt_deg: f32 = 3 (-60 .. 60) "dip of the layers towards the east, degrees"

const DEGREE = 0.017453293;

// How hard a layer is, 0.5..1: the same for all of a layer, whatever it is.
fn hardness(layer: f32, seed: u32) -> f32 {
    return 0.75 + 0.25 * signed_uniform(u32(i32(layer)), 0u, seed);
}

fn brush(at: BrushInput) -> f32 {
    // The layers lie flat in a height that is bent with them. It is the same for all instances of a stroke.
    let drift = parameters.drift_m * fbm_at(at.sample, parameters.drift_size_m / at.spacing_m, 5u, 0.5, at.seed);
    let east_m = at.spacing_m * f32(at.sample.x);
    let dip = tan(DEGREE * parameters.tilt_deg) * east_m;
    let level = (at.height_m + drift + dip) / parameters.step_m;
    let layer = floor(level);

    // Within a layer the ground is flat first, then steep: a step as high as the layer is thick.
    let steepness = 1.0 / (1.0 - parameters.sharpness * hardness(layer, at.seed));
    let step = clamp((level - layer - 0.5) * steepness + 0.5, 0.0, 1.0);
    let goal_m = parameters.step_m * (layer + step) - drift - dip;
    return lerp(at.height_m, goal_m, clamp(at.weight, 0.0, 1.0));
}
