//! Between ordered values and four planes of bytes, one for each byte of what a prediction leaves.
//!
//! The steps stand alone so that a benchmark can put others between them. Every step is a loop over whole rows or
//! whole planes that vectorises; what they pass on lies in the second-level cache.

use multiversion::multiversion;

/// The most often that a page is predicted.
pub const MAX_ORDER: u8 = 2;

/// One band of so many rows is looked at to decide how often a page is predicted: by its first three.
const ROWS_PER_BAND: usize = 8;

/// How often to predict the values, `side` to a row, for the fewest bits: not at all where they are noise, once for
/// most ground, twice for what a smooth brush did. Judged by a part of the rows.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx512cd", "x86_64+avx2"))]
#[must_use]
pub fn best_order(values: &[u32], side: usize) -> u8 {
    let (mut bits_0, mut bits_1, mut bits_2) = (0_u32, 0_u32, 0_u32);
    for band in values.chunks_exact(side * ROWS_PER_BAND) {
        let mut rows = band.chunks_exact(side);
        let (Some(top), Some(middle), Some(bottom)) = (rows.next(), rows.next(), rows.next()) else {
            continue;
        };
        // Three columns of three rows: `a` to `c` from the left, 0 to 2 from above.
        let a = top.iter().zip(middle).zip(bottom);
        let b = from(top, 1).iter().zip(from(middle, 1)).zip(from(bottom, 1));
        let c = from(top, 2).iter().zip(from(middle, 2)).zip(from(bottom, 2));
        for ((((a0, a1), a2), ((b0, b1), b2)), ((c0, c1), c2)) in a.zip(b).zip(c) {
            let above_left = once(*a0, *b0, *a1, *b1);
            let above = once(*b0, *c0, *b1, *c1);
            let left = once(*a1, *b1, *a2, *b2);
            let here = once(*b1, *c1, *b2, *c2);
            bits_0 += length_in_bits(*c2);
            bits_1 += length_in_bits(here);
            bits_2 += length_in_bits(once(above_left, above, left, here));
        }
    }
    match (bits_0 < bits_1, bits_2 < bits_1) {
        (true, _) => 0,
        (false, true) => 2,
        (false, false) => 1,
    }
}

/// What remains of the values when each is predicted from its neighbours above and to the left, `side` to a row, and the
/// bits that any of it has. The rows and columns before the first count as `base`.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn predict(values: &[u32], side: usize, base: u32, residuals: &mut [u32]) -> u32 {
    let row_before_first = vec![base; side];
    let mut above = row_before_first.as_slice();
    let mut used_bits = 0;
    for (row, residuals) in values.chunks_exact(side).zip(residuals.chunks_exact_mut(side)) {
        let Some((residual, residuals)) = residuals.split_first_mut() else { continue };
        if let (Some(value), Some(up)) = (row.first(), above.first()) {
            *residual = value.wrapping_sub(*up);
            used_bits |= *residual;
        }
        let left = row.iter().zip(above);
        let here = from(row, 1).iter().zip(from(above, 1));
        for (residual, ((value, up), (left, above_left))) in residuals.iter_mut().zip(here.zip(left)) {
            *residual = once(*above_left, *up, *left, *value);
            used_bits |= *residual;
        }
        above = row;
    }
    used_bits
}

/// The inverse of [`predict`], in place.
pub fn unpredict(residuals: &mut [u32], side: usize, base: u32) {
    let mut above = vec![base; side];
    for row in residuals.chunks_exact_mut(side) {
        // The sum along the row of what remains is the rise over the row above.
        let mut rise = 0_u32;
        for (value, up) in row.iter_mut().zip(&mut above) {
            rise = rise.wrapping_add(*value);
            *value = up.wrapping_add(rise);
            *up = *value;
        }
    }
}

/// Puts the four bytes of each residual, less its lowest `shift` bits, which are zero, into four planes, the lowest first.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn split(residuals: &[u32], shift: u32, planes: &mut [u8]) {
    let (low, high) = planes.split_at_mut(residuals.len() * 2);
    let (plane_0, plane_1) = low.split_at_mut(residuals.len());
    let (plane_2, plane_3) = high.split_at_mut(residuals.len());
    let bytes = plane_0.iter_mut().zip(plane_1).zip(plane_2).zip(plane_3);
    for (residual, (((b0, b1), b2), b3)) in residuals.iter().zip(bytes) {
        let code = folded((residual.cast_signed() >> shift).cast_unsigned());
        *b0 = code as u8;
        *b1 = (code >> 8) as u8;
        *b2 = (code >> 16) as u8;
        *b3 = (code >> 24) as u8;
    }
}

/// The inverse of [`split`].
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn join(planes: &[u8], shift: u32, residuals: &mut [u32]) {
    let (low, high) = planes.split_at(residuals.len() * 2);
    let (plane_0, plane_1) = low.split_at(residuals.len());
    let (plane_2, plane_3) = high.split_at(residuals.len());
    let bytes = plane_0.iter().zip(plane_1).zip(plane_2).zip(plane_3);
    for (residual, (((b0, b1), b2), b3)) in residuals.iter_mut().zip(bytes) {
        let code = u32::from(*b0) | u32::from(*b1) << 8 | u32::from(*b2) << 16 | u32::from(*b3) << 24;
        *residual = unfolded(code) << shift;
    }
}

/// Small numbers of either sign to small codes: 0, -1, 1, -2, 2 ...
#[inline(always)]
#[must_use]
pub const fn folded(residual: u32) -> u32 {
    (residual << 1) ^ (residual.cast_signed() >> 31).cast_unsigned()
}

/// The inverse of [`folded`].
#[inline(always)]
#[must_use]
pub const fn unfolded(code: u32) -> u32 {
    (code >> 1) ^ (code & 1).wrapping_neg()
}

/// What remains of a value when it is predicted once.
#[inline(always)]
const fn once(above_left: u32, above: u32, left: u32, here: u32) -> u32 {
    here.wrapping_sub(above).wrapping_sub(left.wrapping_sub(above_left))
}

#[inline(always)]
const fn length_in_bits(residual: u32) -> u32 {
    u32::BITS - folded(residual).leading_zeros()
}

#[inline(always)]
fn from(row: &[u32], skipped: usize) -> &[u32] {
    row.get(skipped..).unwrap_or_default()
}
