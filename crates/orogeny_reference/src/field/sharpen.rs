//! Heights pushed away from their smoothed ones.

use multiversion::multiversion;

/// `H + gain (H − G)` for each sample.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(target: &mut [f32], heights: &[f32], smoothed: &[f32], gain: f32) {
    for ((target, height), smoothed) in target.iter_mut().zip(heights).zip(smoothed) {
        *target = height + gain * (height - smoothed);
    }
}
