//! A level of a Laplacian pyramid, weighted, laid on what the coarser ones came to (Burt & Adelson 1983).

use multiversion::multiversion;

/// The coarsest level, which is no difference from a coarser one: `factor mask level` for each sample.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn coarsest_row(target: &mut [f32], mask: &[f32], level: &[f32], factor: f32) {
    for ((target, mask), level) in target.iter_mut().zip(mask).zip(level) {
        *target = factor * mask * level;
    }
}

/// Any other: `below + factor mask (level − coarser)` for each sample. `coarser` is the next level expanded to this one, `below`
/// what came of all coarser ones, expanded too.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(target: &mut [f32], mask: &[f32], level: &[f32], coarser: &[f32], below: &[f32], factor: f32) {
    let samples = mask.iter().zip(level).zip(coarser.iter().zip(below));
    for (target, ((mask, level), (coarser, below))) in target.iter_mut().zip(samples) {
        *target = below + factor * mask * (level - coarser);
    }
}
