//! One plane pulled to another by a mask.

use multiversion::multiversion;

use crate::store::pulled;

/// The first plane where the mask is 0, the second where it is 1, and in between what lies between them.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(target: &mut [f32], first: &[f32], second: &[f32], mask: &[f32]) {
    for (((target, first), second), mask) in target.iter_mut().zip(first).zip(second).zip(mask) {
        *target = pulled(*first, *second, *mask);
    }
}
