//! `lerp(H, step(H), A)`: steps of equal height, level or on a tilted plane.
//!
//! `step(H) = h (n + clamp((f - 1/2) / (1 - 0.99 sharpness) + 1/2, 0, 1))`, `n = floor(H / h)`, `f = H / h - n`.

use multiversion::multiversion;
use orogeny_field::TerraceSteps;

use crate::store::{lerp, update_row};

/// Pulls the samples `first_x ..` of row `z` towards steps by the amounts, 0..1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(heights: &mut [f32], amounts: &[f32], [first_x, z]: [i32; 2], steps: &TerraceSteps) -> u32 {
    update_row(heights, amounts, |place, height, amount| {
        let plane = plane_m(first_x.wrapping_add(place as i32), z, steps);
        let level = (height - plane) * steps.inverse_step;
        let number = level.floor();
        let within = ((level - number - 0.5) * steps.steepness + 0.5).clamp(0.0, 1.0);
        lerp(height, steps.step_m * (number + within) + plane, amount)
    })
}

/// The height of the tilted plane at a sample, in metres, 0 at its anchor.
#[inline(always)]
fn plane_m(x: i32, z: i32, steps: &TerraceSteps) -> f32 {
    let [anchor_x, anchor_z] = steps.anchor;
    let [slope_x, slope_z] = steps.plane_m_per_sample;
    x.wrapping_sub(anchor_x) as f32 * slope_x + z.wrapping_sub(anchor_z) as f32 * slope_z
}
