//! Logarithm and exponential by range reduction and short series.
//!
//! Built-in functions differ by driver (tens of units in the last place, far more near 1), and a narrow falloff magnifies
//! that. These few multiplications are the same on every back end and vectorise.

/// `ln(x)` for a normal `x > 0`, within 2 units in the last place, near 1 as well.
///
/// `x = 2^e m` with `m` in `[sqrt(1/2), sqrt(2))`, and `ln m = 2 artanh((m - 1) / (m + 1))` as a series to the ninth power,
/// whose first term left out is under 1e-9 of the sum.
#[inline(always)]
#[must_use]
pub fn natural_log(x: f32) -> f32 {
    const SQRT_HALF_BITS: i32 = 0x3f35_04f3;
    const LN_2: f32 = std::f32::consts::LN_2;
    let bits = x.to_bits().cast_signed();
    let exponent = bits.wrapping_sub(SQRT_HALF_BITS) >> 23;
    let mantissa = f32::from_bits(bits.wrapping_sub(exponent << 23).cast_unsigned());
    let f = mantissa - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let series = 1.0 + z * (1.0 / 3.0 + z * (0.2 + z * (1.0 / 7.0 + z * (1.0 / 9.0))));
    exponent as f32 * LN_2 + 2.0 * s * series
}

/// `exp(y) - 1` for `y` in `-87..=87`, within 2 units in the last place, near 0 as well; `-1` for smaller `y`.
///
/// `y = n ln 2 + f` with `|f| <= ln 2 / 2`, a Taylor series to the eighth power for `exp(f) - 1`, and
/// `2^n (exp(f) - 1) + (2^n - 1)`, which loses no digits since the two never cancel.
#[inline(always)]
#[must_use]
pub fn exp_minus_one(y: f32) -> f32 {
    const INVERSE_LN_2: f32 = std::f32::consts::LOG2_E;
    // ln 2 in two parts, the first with few enough bits that its product with n is exact.
    const LN_2_HIGH: f32 = 0.693_359_4;
    const LN_2_LOW: f32 = -2.121_944_4e-4;
    let bounded = y.clamp(-87.0, 87.0);
    let n = (bounded * INVERSE_LN_2 + 0.5).floor();
    let f = (bounded - n * LN_2_HIGH) - n * LN_2_LOW;
    let tail = 1.0 / 720.0 + f * (1.0 / 5040.0 + f * (1.0 / 40320.0));
    let series = f + f * f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * tail))));
    // |n| <= 126, so the exponent field neither overflows nor reaches denormals.
    let two_to_n = f32::from_bits((((n as i32) + 127) << 23).cast_unsigned());
    two_to_n * series + (two_to_n - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst_relative_error(
        range: std::ops::Range<f64>,
        of: impl Fn(f32) -> f32,
        truth: impl Fn(f64) -> f64,
    ) -> f64 {
        let steps = 200_000;
        (0..steps)
            .map(|k| {
                (range.start + (range.end - range.start) * (f64::from(k) + 0.5) / f64::from(steps)) as f32
            })
            .map(|x| ((f64::from(of(x)) - truth(f64::from(x))) / truth(f64::from(x))).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn logarithm_is_right_near_one_and_far_from_it() {
        for range in [1.0e-30..1.0e-20, 1.0e-6..1.0, 0.9..1.0, 0.999_99..1.0, 1.0..1.5, 2.0..1.0e6] {
            let worst = worst_relative_error(range.clone(), natural_log, f64::ln);
            assert!(worst < 2.4e-7, "{range:?}: {worst:e}");
        }
        assert_eq!(natural_log(1.0), 0.0);
    }

    #[test]
    fn exponential_is_right_near_zero_and_far_from_it() {
        for range in [-80.0..-1.0, -1.0..-0.1, -0.1..-1.0e-6, -1.0e-3..-1.0e-9, 1.0e-9..1.0, 1.0..80.0] {
            let worst = worst_relative_error(range.clone(), exp_minus_one, f64::exp_m1);
            assert!(worst < 2.4e-7, "{range:?}: {worst:e}");
        }
        assert_eq!(exp_minus_one(0.0), 0.0);
        assert_eq!(exp_minus_one(-1.0e30), -1.0);
    }
}
