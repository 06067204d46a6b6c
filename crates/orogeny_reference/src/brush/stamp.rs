//! A height image pressed into the ground: `T = H_C + b scale`, `b` the bitmap's value, or laid on it: `H + A b scale`.

use multiversion::multiversion;
use orogeny_field::{Bitmap, Instance, StampMode};

use crate::amounts::{alpha, offset};
use crate::store::{lerp, update_row};

/// Presses the bitmap into the samples `first_x ..` of row `z` by the amounts, 0..1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(
    heights: &mut [f32],
    amounts: &[f32],
    [first_x, z]: [i32; 2],
    instance: &Instance,
    bitmap: &Bitmap,
    scale_m: f32,
    mode: StampMode,
) -> u32 {
    update_row(heights, amounts, |place, height, amount| {
        let way = offset(first_x.wrapping_add(place as i32), z, instance);
        let stamp = alpha(bitmap, instance, way) * scale_m;
        let goal = instance.reference_height_m + stamp;
        match mode {
            StampMode::Replace => lerp(height, goal, amount),
            StampMode::Add => height + amount * stamp,
            StampMode::Max => lerp(height, goal.max(height), amount),
            StampMode::Min => lerp(height, goal.min(height), amount),
        }
    })
}
