//! How a page is made small: ordered integers, two-dimensional prediction, bytes by significance, zstd.
//!
//! 1. The bits of an `f32` are mapped to a `u32` that grows with the number ([`ordered_from_bits`]), so that the
//!    wrapping difference of two pages is small where they are close, and exactly reversible for every bit pattern.
//! 2. Each value is predicted from its three neighbours above and to the left (Lorenzo); what remains is folded so
//!    that small negative numbers have small codes.
//! 3. The four bytes of what remains go into four planes: the high ones are nearly all zero.
//! 4. zstd, level 1.
//!
//! A page's content is coded as its ordered values, a history delta as the wrapping difference `after - before` of
//! them. A constant cancels in step 2, so an absent page counts as ordered 0 and no codec needs a field's constant.

use std::ops::Range;

use orogeny_field::Page;

/// What the `codec` column holds for the coding described above. Other numbers are refused, so that a later version
/// can add one.
pub const LORENZO_SHUFFLE_ZSTD: u8 = 1;

/// Speed is worth more than the last percent: higher levels gain little on these planes.
const ZSTD_LEVEL: i32 = 1;

/// Why coded bytes could not be decoded.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// The number in the `codec` column is not known to this version.
    #[error("its codec {codec} is not known, {LORENZO_SHUFFLE_ZSTD} is")]
    UnknownCodec {
        /// What was found.
        codec: u8,
    },
    /// zstd did not accept the bytes, or they hold more than a page.
    #[error("its {size_in_bytes} bytes cannot be decompressed into {expected} ({reason})")]
    Compression {
        /// How many coded bytes there were.
        size_in_bytes: usize,
        /// How many bytes a page has.
        expected: usize,
        /// What zstd said.
        reason: String,
    },
    /// The bytes hold less than a page.
    #[error("it holds {actual} bytes where a page has {expected}")]
    Length {
        /// Bytes a page has.
        expected: usize,
        /// Bytes found.
        actual: usize,
    },
}

/// A `u32` that grows with the `f32` whose bits are given: `-0.0` comes just below `0.0`.
#[inline]
#[must_use]
pub const fn ordered_from_bits(bits: u32) -> u32 {
    if bits >> 31 == 1 { !bits } else { bits | 0x8000_0000 }
}

/// The inverse of [`ordered_from_bits`].
#[inline]
#[must_use]
pub const fn bits_from_ordered(ordered: u32) -> u32 {
    if ordered >> 31 == 1 { ordered & 0x7fff_ffff } else { !ordered }
}

/// The ordered values of a page, row by row.
#[must_use]
pub fn ordered_from_page(page: &Page) -> Vec<u32> {
    page.samples().iter().map(|height| ordered_from_bits(height.to_bits())).collect()
}

/// The heights of ordered values.
#[must_use]
pub fn heights_from_ordered(ordered: &[u32]) -> Vec<f32> {
    ordered.iter().map(|&value| f32::from_bits(bits_from_ordered(value))).collect()
}

/// `after - before`, wrapping; all of `after` where there was no page before.
#[must_use]
pub fn difference(after: &[u32], before: Option<&[u32]>) -> Vec<u32> {
    match before {
        Some(before) => after.iter().zip(before).map(|(a, b)| a.wrapping_sub(*b)).collect(),
        None => after.to_vec(),
    }
}

/// The inverse of [`difference`]: `before + difference`, wrapping.
#[must_use]
pub fn sum(before: &[u32], difference: &[u32]) -> Vec<u32> {
    before.iter().zip(difference).map(|(b, d)| b.wrapping_add(*d)).collect()
}

/// The most bytes that a page of `num_samples` may take when coded; what is longer is damage and is not read.
#[must_use]
pub const fn max_size_in_bytes(num_samples: usize) -> usize {
    // zstd's own bound is the content plus 1/256 and a little.
    let raw = num_samples * 4;
    raw + raw / 128 + 1024
}

/// Codes the values of a square page, `side` to a row.
///
/// # Errors
/// What zstd reports: in practice only that memory ran out.
pub fn encode(values: &[u32], side: usize) -> std::io::Result<Vec<u8>> {
    let mut planes = vec![0_u8; values.len() * 4];
    split_residuals(values, side, &mut planes);
    let mut bytes = zstd::bulk::compress(&planes, ZSTD_LEVEL)?;
    bytes.shrink_to_fit();
    Ok(bytes)
}

/// The values of a square page, `side` to a row, from its coded bytes. Takes no more memory than two pages, whatever
/// the bytes claim.
///
/// # Errors
/// [`DecodeError`] when the bytes are not exactly one page in a known codec.
pub fn decode(codec: u8, bytes: &[u8], side: usize) -> Result<Vec<u32>, DecodeError> {
    if codec != LORENZO_SHUFFLE_ZSTD {
        return Err(DecodeError::UnknownCodec { codec });
    }
    let num_samples = side * side;
    let expected = num_samples * 4;
    let mut planes = vec![0_u8; expected];
    let actual = zstd::bulk::decompress_to_buffer(bytes, planes.as_mut_slice()).map_err(|err| {
        DecodeError::Compression { size_in_bytes: bytes.len(), expected, reason: err.to_string() }
    })?;
    if actual != expected {
        return Err(DecodeError::Length { expected, actual });
    }
    let mut values = vec![0_u32; num_samples];
    join_residuals(&planes, side, &mut values);
    Ok(values)
}

/// Small numbers of either sign to small codes: 0, -1, 1, -2, 2 ...
const fn folded(residual: u32) -> u32 {
    (residual << 1) ^ (residual.cast_signed() >> 31).cast_unsigned()
}

const fn unfolded(code: u32) -> u32 {
    (code >> 1) ^ (code & 1).wrapping_neg()
}

#[expect(
    clippy::indexing_slicing,
    reason = "the planes are 4 x values long, and every range is a row of one of them"
)]
fn split_residuals(values: &[u32], side: usize, planes: &mut [u8]) {
    let plane_len = values.len();
    let first_row_above = vec![0_u32; side];
    let mut above = first_row_above.as_slice();
    let (low, high) = planes.split_at_mut(plane_len * 2);
    let (plane_0, plane_1) = low.split_at_mut(plane_len);
    let (plane_2, plane_3) = high.split_at_mut(plane_len);
    for (row, z) in values.chunks_exact(side).zip(0..) {
        let at: Range<usize> = z * side..(z + 1) * side;
        let bytes = plane_0[at.clone()]
            .iter_mut()
            .zip(&mut plane_1[at.clone()])
            .zip(&mut plane_2[at.clone()])
            .zip(&mut plane_3[at]);
        let (mut left, mut above_left) = (0_u32, 0_u32);
        for ((&value, &up), (((b0, b1), b2), b3)) in row.iter().zip(above).zip(bytes) {
            let predicted = left.wrapping_add(up).wrapping_sub(above_left);
            [*b0, *b1, *b2, *b3] = folded(value.wrapping_sub(predicted)).to_le_bytes();
            (left, above_left) = (value, up);
        }
        above = row;
    }
}

#[expect(
    clippy::indexing_slicing,
    reason = "the planes are 4 x values long, and every range is a row of one of them"
)]
fn join_residuals(planes: &[u8], side: usize, values: &mut [u32]) {
    let plane_len = values.len();
    let mut above = vec![0_u32; side];
    for (row, z) in values.chunks_exact_mut(side).zip(0..) {
        let at = |plane: usize| plane * plane_len + z * side..plane * plane_len + (z + 1) * side;
        let bytes = planes[at(0)].iter().zip(&planes[at(1)]).zip(&planes[at(2)]).zip(&planes[at(3)]);
        // The sum along the row of what remains is the rise over the row above.
        let mut rise = 0_u32;
        for ((value, up), (((b0, b1), b2), b3)) in row.iter_mut().zip(&mut above).zip(bytes) {
            rise = rise.wrapping_add(unfolded(u32::from_le_bytes([*b0, *b1, *b2, *b3])));
            *value = up.wrapping_add(rise);
            *up = *value;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SIDE: usize = 64;

    fn any_bits() -> impl Strategy<Value = u32> {
        prop_oneof![any::<u32>(), (0_u32..64).prop_map(|n| n), Just(0x8000_0000), Just(u32::MAX)]
    }

    #[test]
    fn ordered_values_grow_with_the_number() {
        let rising = [-1.0e7_f32, -1.0, -f32::MIN_POSITIVE, -0.0, 0.0, 1.0e-45, 1.0, 1.0e7];
        for pair in rising.windows(2) {
            assert!(ordered_from_bits(pair[0].to_bits()) < ordered_from_bits(pair[1].to_bits()), "{pair:?}");
        }
    }

    #[test]
    fn small_residuals_of_either_sign_have_small_codes() {
        for residual in [0_i32, 1, -1, 127, -128] {
            assert!(folded(residual.cast_unsigned()) < 256, "{residual}");
        }
    }

    #[test]
    fn a_constant_page_takes_next_to_nothing() {
        let coded = encode(&vec![0x1234_5678; 256 * 256], 256).unwrap();
        assert!(coded.len() < 128, "{}", coded.len());
    }

    #[test]
    fn a_bomb_is_refused_without_its_memory() {
        let bomb = zstd::bulk::compress(&vec![0_u8; 64 << 20], 1).unwrap();
        assert!(matches!(
            decode(LORENZO_SHUFFLE_ZSTD, &bomb, SIDE),
            Err(DecodeError::Compression { expected: 16_384, .. })
        ));
        // A frame header that declares 2^40 bytes of content and has none.
        let declared = [0x28, 0xb5, 0x2f, 0xfd, 0xe0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0];
        assert!(decode(LORENZO_SHUFFLE_ZSTD, &declared, SIDE).is_err());
    }

    #[test]
    fn other_codecs_and_short_content_are_refused() {
        let coded = encode(&vec![7; SIDE * SIDE], SIDE).unwrap();
        assert_eq!(decode(2, &coded, SIDE), Err(DecodeError::UnknownCodec { codec: 2 }));
        assert_eq!(
            decode(LORENZO_SHUFFLE_ZSTD, &coded, SIDE * 2),
            Err(DecodeError::Length { expected: 65_536, actual: 16_384 })
        );
    }

    proptest! {
        #[test]
        fn ordering_is_reversible_for_all_bits(bits in any::<u32>()) {
            prop_assert_eq!(bits_from_ordered(ordered_from_bits(bits)), bits);
            prop_assert_eq!(unfolded(folded(bits)), bits);
        }

        #[test]
        fn any_values_come_back(values in prop::collection::vec(any_bits(), SIDE * SIDE)) {
            let coded = encode(&values, SIDE).unwrap();
            prop_assert!(coded.len() <= max_size_in_bytes(values.len()));
            prop_assert_eq!(decode(LORENZO_SHUFFLE_ZSTD, &coded, SIDE).unwrap(), values);
        }

        #[test]
        fn damaged_bytes_never_panic(
            seed in any::<u32>(), length in 0_usize..4000, flip in any::<prop::sample::Index>(),
        ) {
            let values: Vec<u32> = (0..(SIDE * SIDE) as u32).map(|i| i.wrapping_mul(seed) >> 12).collect();
            let mut coded = encode(&values, SIDE).unwrap();
            let place = flip.index(coded.len());
            coded[place] ^= 0x10;
            if let Ok(decoded) = decode(LORENZO_SHUFFLE_ZSTD, &coded, SIDE) {
                prop_assert_eq!(decoded.len(), values.len());
            }
            coded.truncate(length.min(coded.len() - 1));
            prop_assert!(decode(LORENZO_SHUFFLE_ZSTD, &coded, SIDE).is_err());
        }
    }
}
