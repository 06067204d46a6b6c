//! What a height may be: finite, within ±1e7 m, and never denormal.

use crate::{Error, Result};

/// The largest height of a terrain, in metres, either way.
pub const MAX_HEIGHT_M: f32 = 1.0e7;

/// Whether a height may be stored: finite and within ±[`MAX_HEIGHT_M`].
///
/// Looks at the bits: a comparison with NaN is false whichever way it is asked.
#[must_use]
pub const fn is_storable_height(height_m: f32) -> bool {
    (height_m.to_bits() & 0x7fff_ffff) <= MAX_HEIGHT_M.to_bits()
}

/// The height that a kernel stores: clamped to ±[`MAX_HEIGHT_M`]; denormals become +0, and so does NaN, which only a
/// damaged page could have brought in.
#[inline(always)]
#[must_use]
pub fn sanitized_height(height_m: f32) -> f32 {
    let clamped = height_m.clamp(-MAX_HEIGHT_M, MAX_HEIGHT_M);
    // Asked this way round, since a comparison with NaN is false.
    if clamped.abs() >= f32::MIN_POSITIVE { clamped } else { 0.0 }
}

/// Accepts one height from outside, with denormals turned to +0.
///
/// # Errors
/// [`Error::Height`], naming `what`, when it is not storable.
pub fn check_height(what: &str, height_m: f32) -> Result<f32> {
    if is_storable_height(height_m) {
        Ok(sanitized_height(height_m))
    } else {
        Err(Error::Height { what: what.to_owned(), height_m, limit_m: MAX_HEIGHT_M })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn storable_is_decided_by_bits() {
        for good in [0.0, -0.0, 1.0e7, -1.0e7, f32::MIN_POSITIVE, 1.0e-42] {
            assert!(is_storable_height(good), "{good}");
        }
        let just_above = f32::from_bits(MAX_HEIGHT_M.to_bits() + 1);
        for bad in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, just_above, -just_above, f32::MAX]
        {
            assert!(!is_storable_height(bad), "{bad}");
        }
    }

    #[test]
    fn denormals_become_positive_zero() {
        assert_eq!(sanitized_height(-1.0e-40).to_bits(), 0);
        assert_eq!(check_height("a test", 1.0e-45).unwrap().to_bits(), 0);
        assert!(check_height("a test", f32::NAN).is_err());
    }

    #[test]
    fn no_bits_at_all_are_stored_as_a_height_that_cannot_be() {
        for upper in 0..=u16::MAX {
            for lower in [0, 1, 0x8000, 0xffff] {
                let height_m = f32::from_bits(u32::from(upper) << 16 | lower);
                let stored = sanitized_height(height_m);
                assert!(is_storable_height(stored) && !stored.is_subnormal(), "{height_m}");
                let is_good = is_storable_height(height_m) && !height_m.is_subnormal();
                assert!(!is_good || stored.to_bits() == height_m.to_bits() || height_m == 0.0, "{height_m}");
            }
        }
        assert_eq!(sanitized_height(f32::NAN).to_bits(), 0);
        assert_eq!(sanitized_height(f32::NEG_INFINITY), -MAX_HEIGHT_M);
    }
}
