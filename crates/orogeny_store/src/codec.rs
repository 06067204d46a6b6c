//! How a page is made small: ordered integers, two-dimensional prediction, bytes by significance, zstd.
//!
//! 1. The bits of an `f32` are mapped to a `u32` that grows with the number ([`ordered_from_bits`]), so that the
//!    wrapping difference of two pages is small where they are close, and exactly reversible for every bit pattern.
//! 2. Each value is predicted from its three neighbours above and to the left (Lorenzo), and what remains once more,
//!    or not at all, whichever leaves the least.
//! 3. Zero bits at the low end that all that remains shares are left out: heights in whole metres differ by
//!    multiples of a power of two.
//! 4. What remains is folded so that small negative numbers have small codes.
//! 5. The four bytes of each code go into four planes: the high ones are nearly all zero.
//! 6. zstd, level 1, a frame for each plane.
//!
//! Before the frames stand how often the values were predicted and how many bits were left out, one byte each, and the
//! page's first value, from which the prediction starts, four bytes, little-endian (0 where nothing is predicted).
//!
//! A page's content is coded as its ordered values, a history delta as the wrapping difference `after - before` of
//! them. A constant cancels in step 2, so an absent page counts as ordered 0 and no codec needs a field's constant.

pub mod planes;
mod workspace;

use std::cell::RefCell;

use orogeny_field::Page;

use workspace::{Header, Workspace};

/// What the `codec` column holds for the first coding: step 2 once, no step 3, one zstd frame, no header. Read, but no
/// longer written.
pub const LORENZO_SHUFFLE_ZSTD: u8 = 1;

/// What the `codec` column holds for the coding described above. Other numbers are refused, so that a later version can
/// add one.
pub const ADAPTIVE_LORENZO_SHUFFLE_ZSTD: u8 = 2;

/// What [`encode`] writes.
pub const WRITTEN: u8 = ADAPTIVE_LORENZO_SHUFFLE_ZSTD;

thread_local! {
    static WORKSPACE: RefCell<Workspace> = RefCell::default();
}

/// Why coded bytes could not be decoded.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// The number in the `codec` column is not known to this version.
    #[error("its codec {codec} is not known, {LORENZO_SHUFFLE_ZSTD} and {ADAPTIVE_LORENZO_SHUFFLE_ZSTD} are")]
    UnknownCodec {
        /// What was found.
        codec: u8,
    },
    /// The bytes before the compressed planes are missing or make no sense.
    #[error("its {size_in_bytes} bytes begin with no header that makes sense")]
    Header {
        /// How many coded bytes there were.
        size_in_bytes: usize,
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

/// Codes the values of a square page, `side` to a row, as [`WRITTEN`].
///
/// # Errors
/// What zstd reports: in practice only that memory ran out.
pub fn encode(values: &[u32], side: usize) -> std::io::Result<Vec<u8>> {
    WORKSPACE.with_borrow_mut(|workspace| {
        let coded = workspace.encode(values, side);
        workspace.let_go_of_much();
        coded
    })
}

/// The values of a square page, `side` to a row, from its coded bytes. Takes no more memory than two pages, whatever
/// the bytes claim.
///
/// # Errors
/// [`DecodeError`] when the bytes are not exactly one page in a known codec.
pub fn decode(codec: u8, bytes: &[u8], side: usize) -> Result<Vec<u32>, DecodeError> {
    let (header, compressed) = match codec {
        LORENZO_SHUFFLE_ZSTD => (Header::IMPLIED, bytes),
        ADAPTIVE_LORENZO_SHUFFLE_ZSTD => Header::from_bytes(bytes)?,
        _ => return Err(DecodeError::UnknownCodec { codec }),
    };
    WORKSPACE.with_borrow_mut(|workspace| {
        let mut values = vec![0; side * side];
        let joined = workspace.join(compressed, header.shift, &mut values);
        workspace.let_go_of_much();
        joined?;
        for remaining in (0..header.order).rev() {
            planes::unpredict(&mut values, side, if remaining == 0 { header.base } else { 0 });
        }
        Ok(values)
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SIDE: usize = 64;

    fn any_bits() -> impl Strategy<Value = u32> {
        prop_oneof![any::<u32>(), (0_u32..64).prop_map(|n| n), Just(0x8000_0000), Just(u32::MAX)]
    }

    /// Values that are best not predicted, predicted once and twice.
    fn of_order(order: u8, seed: u32) -> Vec<u32> {
        let mixed = |n: u32| (n ^ n >> 15).wrapping_mul(0x846c_a68b);
        let noise = |i: u32| mixed(mixed(i.wrapping_add(seed).wrapping_mul(0x7feb_352d)));
        let value = |i: u32| {
            let (x, z) = (i % SIDE as u32, i / SIDE as u32);
            match order {
                // As likely below 0 as above, as noise of a brush is.
                0 => (noise(i) >> 18).wrapping_sub(1 << 13),
                1 => 2_000 * x + 900 * z + (noise(i) >> 26),
                _ => x * z * (x + z) + 0x4000_0000,
            }
        };
        (0..(SIDE * SIDE) as u32).map(value).collect()
    }

    /// As the first codec was written.
    fn encode_as_before(values: &[u32]) -> Vec<u8> {
        let (mut residuals, mut bytes) = (vec![0; values.len()], vec![0; values.len() * 4]);
        planes::predict(values, SIDE, 0, &mut residuals);
        planes::split(&residuals, 0, &mut bytes);
        zstd::bulk::compress(&bytes, 1).unwrap()
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
            assert!(planes::folded(residual.cast_unsigned()) < 256, "{residual}");
        }
    }

    #[test]
    fn a_constant_page_takes_next_to_nothing() {
        let coded = encode(&vec![0x1234_5678; 256 * 256], 256).unwrap();
        assert!(coded.len() < 128, "{}", coded.len());
    }

    #[test]
    fn each_content_is_predicted_as_often_as_suits_it() {
        for order in 0..=planes::MAX_ORDER {
            assert_eq!(encode(&of_order(order, 7), SIDE).unwrap()[0], order);
        }
    }

    #[test]
    fn whole_metres_leave_low_bits_out() {
        let ground = |metres: fn(i32) -> i32| -> Vec<u32> {
            let height_m = |i: i32| metres(i % SIDE as i32 + (i / SIDE as i32) * 3) as f32;
            (0..(SIDE * SIDE) as i32).map(|i| ordered_from_bits(height_m(i).to_bits())).collect()
        };
        // A unit in the last place is 2^-13 m from 1024 m and 2^-12 m from 2048 m; negative numbers do as well.
        for (values, shift) in [
            (ground(|n| 1024 + n * n % 97), 13),
            (ground(|n| 2000 + n * n % 97), 12),
            (ground(|n| -2000 - n * n % 97), 12),
        ] {
            let coded = encode(&values, SIDE).unwrap();
            assert_eq!(u32::from(coded[1]), shift);
            assert_eq!(decode(WRITTEN, &coded, SIDE).unwrap(), values);
        }
    }

    #[test]
    fn a_bomb_is_refused_without_its_memory() {
        let bomb = zstd::bulk::compress(&vec![0_u8; 64 << 20], 1).unwrap();
        // A frame header that declares 2^40 bytes of content and has none.
        let declared = [0x28, 0xb5, 0x2f, 0xfd, 0xe0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0];
        for (codec, header) in [(LORENZO_SHUFFLE_ZSTD, &[][..]), (WRITTEN, &[1, 0, 0, 0, 0, 0])] {
            let refused = decode(codec, &[header, &bomb].concat(), SIDE);
            assert!(matches!(refused, Err(DecodeError::Compression { expected: 16_384, .. })));
            assert!(decode(codec, &[header, &declared].concat(), SIDE).is_err());
        }
    }

    #[test]
    fn other_codecs_headers_and_short_content_are_refused() {
        let coded = encode(&vec![7; SIDE * SIDE], SIDE).unwrap();
        assert_eq!(decode(3, &coded, SIDE), Err(DecodeError::UnknownCodec { codec: 3 }));
        assert_eq!(
            decode(WRITTEN, &coded, SIDE * 2),
            Err(DecodeError::Length { expected: 65_536, actual: 16_384 })
        );
        for (place, value) in [(0, planes::MAX_ORDER + 1), (1, 32)] {
            let mut damaged = coded.clone();
            damaged[place] = value;
            let refused = Err(DecodeError::Header { size_in_bytes: coded.len() });
            assert_eq!(decode(WRITTEN, &damaged, SIDE), refused);
        }
        assert_eq!(decode(WRITTEN, &coded[..5], SIDE), Err(DecodeError::Header { size_in_bytes: 5 }));
    }

    #[test]
    fn what_large_pages_need_is_not_kept() {
        let large = vec![1; 1024 * 1024];
        assert_eq!(decode(WRITTEN, &encode(&large, 1024).unwrap(), 1024).unwrap(), large);
        WORKSPACE.with_borrow(|workspace| assert_eq!(workspace.planes.capacity(), 0));
    }

    proptest! {
        #[test]
        fn ordering_is_reversible_for_all_bits(bits in any::<u32>()) {
            prop_assert_eq!(bits_from_ordered(ordered_from_bits(bits)), bits);
            prop_assert_eq!(planes::unfolded(planes::folded(bits)), bits);
        }

        #[test]
        fn any_values_come_back(
            order in 0..=planes::MAX_ORDER, seed in any::<u32>(), shift in 0_u32..16, is_smooth in any::<bool>(),
            others in prop::collection::vec(any_bits(), SIDE * SIDE),
        ) {
            // Any bits, or what is predicted so often and may leave bits out.
            let smooth = || of_order(order, seed).iter().map(|value| value << shift).collect();
            let values = if is_smooth { smooth() } else { others };
            let coded = encode(&values, SIDE).unwrap();
            prop_assert!(coded.len() <= max_size_in_bytes(values.len()));
            prop_assert_eq!(&decode(WRITTEN, &coded, SIDE).unwrap(), &values);
            prop_assert_eq!(&decode(LORENZO_SHUFFLE_ZSTD, &encode_as_before(&values), SIDE).unwrap(), &values);
        }

        #[test]
        fn damaged_bytes_never_panic(
            order in 0..=planes::MAX_ORDER, seed in any::<u32>(), codec in 1..=WRITTEN, length in 0_usize..4000,
            flip in any::<prop::sample::Index>(), bit in 0..8,
        ) {
            let values = of_order(order, seed);
            let mut coded = if codec == WRITTEN { encode(&values, SIDE).unwrap() } else { encode_as_before(&values) };
            let place = flip.index(coded.len());
            coded[place] ^= 1_u8 << bit;
            if let Ok(decoded) = decode(codec, &coded, SIDE) {
                prop_assert_eq!(decoded.len(), values.len());
            }
            coded.truncate(length.min(coded.len() - 1));
            prop_assert!(decode(codec, &coded, SIDE).is_err());
        }
    }
}
