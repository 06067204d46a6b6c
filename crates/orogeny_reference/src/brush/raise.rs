//! `H + A`. Lowering is raising by a negative amount.

use multiversion::multiversion;

use crate::store::update_row;

/// Raises the heights by the amounts, in metres.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(heights: &mut [f32], amounts: &[f32]) -> u32 {
    update_row(heights, amounts, |_, height, amount| height + amount)
}
