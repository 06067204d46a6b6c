//! `lerp(H, T, A)` towards one target height, both ways or one way only.

use multiversion::multiversion;
use orogeny_field::LevelOnly;

use crate::store::{goal_of, lerp, update_row};

/// Pulls the heights towards `target_m` by the amounts, 0..1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(heights: &mut [f32], amounts: &[f32], target_m: f32, only: LevelOnly) -> u32 {
    // Asked once: a loop with the question in it is worked one sample at a time, which takes twelve times as many instructions.
    match only {
        LevelOnly::Both => update_row(heights, amounts, |_, height, amount| lerp(height, target_m, amount)),
        LevelOnly::Cut | LevelOnly::Fill => update_row(heights, amounts, |_, height, amount| {
            lerp(height, goal_of(target_m, height, only), amount)
        }),
    }
}
