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
    ($number:ty, $wide:ty) => {
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

real!(f32, i32);
real!(f64, i64);
