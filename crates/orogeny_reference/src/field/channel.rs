//! One quantity of several, as a mask.

use multiversion::multiversion;

/// 0 up to a value, 1 where it is `1 / inverse_width` more, and in between the share of the way: for each sample.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(target: &mut [f32], values: &[f32], from: f32, inverse_width: f32) {
    for (target, value) in target.iter_mut().zip(values) {
        *target = ((value - from) * inverse_width).clamp(0.0, 1.0);
    }
}
