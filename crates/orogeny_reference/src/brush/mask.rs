//! `lerp(M, v, A)`, for masks and selections; they stay within 0..1.

use multiversion::multiversion;

use crate::store::{lerp, update_row};

/// Pulls a mask towards `value`, 0..1, by the amounts, 0..1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(mask: &mut [f32], amounts: &[f32], value: f32) -> u32 {
    update_row(mask, amounts, |_, mask, amount| lerp(mask, value, amount))
}
