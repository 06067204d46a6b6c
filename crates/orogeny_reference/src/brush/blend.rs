//! `lerp(H, G, A)` towards a goal of each sample's own: what a filter made of the ground.

use multiversion::multiversion;

use crate::store::{pulled, update_row};

/// Pulls the heights towards `goals` by the amounts, 0..1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(heights: &mut [f32], amounts: &[f32], goals: &[f32]) -> u32 {
    update_row(heights, amounts, |place, height, amount| {
        pulled(height, goals.get(place).copied().unwrap_or(height), amount)
    })
}
