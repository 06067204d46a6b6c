//! `H + A T(X)`, `T` any noise.

use multiversion::multiversion;

use crate::store::update_row;

/// Adds a noise, given at each sample, times the amounts, in metres.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(heights: &mut [f32], amounts: &[f32], noise: &[f32]) -> u32 {
    let mut num_clamped = 0;
    // In pieces that `update_row` can index without looking whether it may.
    for ((heights, amounts), noise) in heights.chunks_mut(256).zip(amounts.chunks(256)).zip(noise.chunks(256))
    {
        let mut noise = noise.iter();
        num_clamped += update_row(heights, amounts, |_, height, amount| {
            height + amount * noise.next().copied().unwrap_or_default()
        });
    }
    num_clamped
}
