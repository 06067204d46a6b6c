//! A sum of two planes, each times a factor.

use multiversion::multiversion;

/// `a first + b second` for each sample.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(target: &mut [f32], first: &[f32], second: &[f32], [a, b]: [f32; 2]) {
    for ((target, first), second) in target.iter_mut().zip(first).zip(second) {
        *target = a * first + b * second;
    }
}
