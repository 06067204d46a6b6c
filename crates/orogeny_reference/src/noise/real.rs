//! The two kinds of numbers that noise is worked in.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// `f32`, as on a GPU, or `f64`.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The nearest number of this kind.
    fn of(value: f64) -> Self;
    /// The largest integer that is no larger.
    fn floor(self) -> Self;
    /// An integer as 32 bits, wrapped.
    fn wrapped(self) -> u32;
    /// The same for one within ±2^21, which takes fewer instructions.
    fn wrapped_near(self) -> u32;
    /// With the other sign where the topmost bit is set.
    fn turned_by(self, bits: u32) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// Without its sign.
    fn abs(self) -> Self;
    /// The smaller.
    fn least(self, other: Self) -> Self;
    /// The larger.
    fn most(self, other: Self) -> Self;
    /// -1..1 of 32 random bits.
    fn signed(bits: u32) -> Self;
}

macro_rules! real {
    ($number:ty, $wide:ty, $near:expr, $turned:expr) => {
        impl Real for $number {
            #[inline(always)]
            fn of(value: f64) -> Self {
                value as Self
            }

            #[inline(always)]
            fn floor(self) -> Self {
                Self::floor(self)
            }

            #[inline(always)]
            fn wrapped(self) -> u32 {
                (self as $wide) as u32
            }

            #[inline(always)]
            fn wrapped_near(self) -> u32 {
                $near(self)
            }

            #[inline(always)]
            fn turned_by(self, bits: u32) -> Self {
                $turned(self, bits)
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                Self::sqrt(self)
            }

            #[inline(always)]
            fn abs(self) -> Self {
                Self::abs(self)
            }

            #[inline(always)]
            fn least(self, other: Self) -> Self {
                Self::min(self, other)
            }

            #[inline(always)]
            fn most(self, other: Self) -> Self {
                Self::max(self, other)
            }

            #[inline(always)]
            fn signed(bits: u32) -> Self {
                Self::from(crate::hash::bits_to_signed(bits))
            }
        }
    };
}

/// Added to a small integer, it puts it into the lowest bits of the sum: `1.5 * 2^23`.
const LOWEST_BITS: f32 = 12_582_912.0;

#[inline(always)]
const fn near_f32(value: f32) -> u32 {
    (value + LOWEST_BITS).to_bits().wrapping_sub(LOWEST_BITS.to_bits())
}

#[inline(always)]
const fn turned_f32(value: f32, bits: u32) -> f32 {
    f32::from_bits(value.to_bits() ^ (bits & 0x8000_0000))
}

#[inline(always)]
const fn turned_f64(value: f64, bits: u32) -> f64 {
    if bits >> 31 == 1 { -value } else { value }
}

real!(f32, i32, near_f32, turned_f32);
real!(f64, i64, f64::wrapped, turned_f64);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quick_ways_are_the_plain_ones() {
        for value in [-2_097_152.0_f32, -33.0, -1.0, -0.0, 0.0, 1.0, 31.0, 2_097_151.0] {
            assert_eq!(value.wrapped_near(), value.wrapped(), "{value}");
            assert_eq!(f64::from(value).wrapped_near(), value.wrapped(), "{value}");
        }
        for bits in [0, 1, 0x7fff_ffff, 0x8000_0000, u32::MAX] {
            assert_eq!(f64::from(1.5_f32.turned_by(bits)), 1.5_f64.turned_by(bits));
        }
    }
}
