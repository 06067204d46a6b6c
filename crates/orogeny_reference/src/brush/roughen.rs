//! `H + A u(i, j, seed)`: white noise, the same at a sample for all instances of a stroke.

use multiversion::multiversion;

use crate::hash::signed_uniform;
use crate::store::update_row;

/// Adds noise of up to ± the amounts, in metres, to the samples `first_x ..` of row `z`. The row lies on the terrain.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(heights: &mut [f32], amounts: &[f32], first_x: i32, z: i32, seed: u32) -> u32 {
    let (first_x, z) = (first_x.cast_unsigned(), z.cast_unsigned());
    update_row(heights, amounts, |place, height, amount| {
        height + amount * signed_uniform(first_x.wrapping_add(place as u32), z, seed)
    })
}
