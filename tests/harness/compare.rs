//! Comparisons of planes. What they find comes with the worst sample: where it lies, both values and their bits.

use crate::Plane;

/// How far apart two heights may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Units in the last place …
    pub ulps: f64,
    /// … of this magnitude, in metres.
    pub of_m: f32,
    /// And metres besides.
    pub absolute_m: f64,
}

impl Tolerance {
    /// Not a bit.
    pub const EXACT: Self = Self { ulps: 0.0, of_m: 0.0, absolute_m: 0.0 };

    /// In metres.
    #[must_use]
    pub fn bound_m(&self) -> f64 {
        self.ulps * unit_in_the_last_place(self.of_m) + self.absolute_m
    }
}

/// The distance from a finite number's magnitude to the next larger one.
#[must_use]
pub fn unit_in_the_last_place(value: f32) -> f64 {
    let bits = value.abs().to_bits();
    f64::from(f32::from_bits(bits + 1)) - f64::from(f32::from_bits(bits))
}

/// One sample of two planes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Column and row.
    pub place: [u32; 2],
    /// The value that it should be near to.
    pub expected: f32,
    /// The value that it is.
    pub found: f32,
    /// How far apart they may be, in metres.
    pub tolerance_m: f64,
}

impl Sample {
    /// Distance over tolerance: above 1 is too much. Two values with one tolerance of 0 are 0 or infinitely far apart.
    #[must_use]
    pub fn share(&self) -> f64 {
        let distance_m = self.distance_m();
        if distance_m == 0.0 { 0.0 } else { distance_m / self.tolerance_m }
    }

    /// In metres.
    #[must_use]
    pub fn distance_m(&self) -> f64 {
        (f64::from(self.expected) - f64::from(self.found)).abs()
    }
}

impl std::fmt::Display for Sample {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { place: [x, z], expected, found, tolerance_m } = self;
        let bits = (expected.to_bits(), found.to_bits());
        write!(
            f,
            "at column {x}, row {z}: expected {expected:e} ({:#010x}), found {found:e} ({:#010x}), {:e} apart, \
             {tolerance_m:e} allowed",
            bits.0,
            bits.1,
            self.distance_m()
        )
    }
}

/// What two planes that agree have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Samples compared, above 0.
    pub num_samples: usize,
    /// Samples whose bits differ.
    pub num_different: usize,
    /// The sample with the largest [`Sample::share`].
    pub worst: Sample,
}

/// Why two planes do not agree.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Mismatch {
    /// Nothing was compared, which proves nothing.
    #[error("there is nothing to compare")]
    Empty,
    /// They are of different sizes.
    #[error("expected {expected:?} samples, found {found:?}")]
    Size {
        /// Width and depth.
        expected: [u32; 2],
        /// Width and depth.
        found: [u32; 2],
    },
    /// One has a NaN or an infinity, even if both have it.
    #[error("{num} samples are NaN or infinite, the first {first}")]
    NotFinite {
        /// How many.
        num: usize,
        /// The first of them.
        first: Sample,
    },
    /// They are too far apart.
    #[error("{num} of {of} samples differ too much, the worst {worst}")]
    Apart {
        /// How many.
        num: usize,
        /// Of how many.
        of: usize,
        /// The worst of them.
        worst: Sample,
    },
}

/// Whether each sample found lies within its tolerance of the one expected; `tolerance` gets column and row.
///
/// # Errors
/// A [`Mismatch`]; finite values are told by their bits, since a comparison with NaN is false whichever way it is asked.
pub fn within(
    expected: &Plane,
    found: &Plane,
    mut tolerance: impl FnMut(u32, u32) -> Tolerance,
) -> Result<Agreement, Mismatch> {
    compare(expected, found, |sample, x, z| {
        sample.tolerance_m = tolerance(x, z).bound_m();
        sample.share() <= 1.0
    })
}

/// Whether all samples have the same bits.
///
/// # Errors
/// A [`Mismatch`].
pub fn bit_equal(expected: &Plane, found: &Plane) -> Result<Agreement, Mismatch> {
    compare(expected, found, |sample, _, _| sample.expected.to_bits() == sample.found.to_bits())
}

fn compare(
    expected: &Plane,
    found: &Plane,
    mut is_near: impl FnMut(&mut Sample, u32, u32) -> bool,
) -> Result<Agreement, Mismatch> {
    let sizes = [[expected.width(), expected.depth()], [found.width(), found.depth()]];
    if sizes[0] != sizes[1] {
        return Err(Mismatch::Size { expected: sizes[0], found: sizes[1] });
    }
    let mut not_finite = Vec::new();
    let mut worst: Option<(Sample, (bool, f64, f64))> = None;
    let (mut num_apart, mut num_different) = (0, 0);
    for z in 0..expected.depth() {
        for x in 0..expected.width() {
            let (expected, found) = (expected.at(x, z), found.at(x, z));
            let mut sample = Sample { place: [x, z], expected, found, tolerance_m: 0.0 };
            if !is_finite(expected) || !is_finite(found) {
                not_finite.push(sample);
                continue;
            }
            num_different += usize::from(expected.to_bits() != found.to_bits());
            let is_near = is_near(&mut sample, x, z);
            num_apart += usize::from(!is_near);
            // +0 and -0 are no distance apart, but not equal either.
            let badness = (!is_near, sample.share(), sample.distance_m());
            if worst.is_none_or(|(_, worst)| badness > worst) {
                worst = Some((sample, badness));
            }
        }
    }
    if let Some(first) = not_finite.first() {
        return Err(Mismatch::NotFinite { num: not_finite.len(), first: *first });
    }
    let (worst, _) = worst.ok_or(Mismatch::Empty)?;
    let of = expected.samples().len();
    if num_apart > 0 {
        return Err(Mismatch::Apart { num: num_apart, of, worst });
    }
    Ok(Agreement { num_samples: of, num_different, worst })
}

fn is_finite(value: f32) -> bool {
    value.to_bits() & 0x7f80_0000 != 0x7f80_0000
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane() -> Plane {
        Plane::from_fn(5, 3, |x, z| 100.0 + (x * 3 + z) as f32)
    }

    fn changed(change: impl FnOnce(&mut [f32])) -> Plane {
        let mut plane = plane();
        change(plane.samples_mut());
        plane
    }

    fn ten_ulps(_: u32, _: u32) -> Tolerance {
        Tolerance { ulps: 10.0, of_m: 100.0, absolute_m: 0.0 }
    }

    fn next(value: f32, num: i32) -> f32 {
        f32::from_bits((value.to_bits().cast_signed() + num).cast_unsigned())
    }

    #[test]
    fn a_unit_in_the_last_place_is_the_gap_to_the_next_number() {
        assert_eq!(unit_in_the_last_place(1.0), f64::from(f32::EPSILON));
        assert_eq!(unit_in_the_last_place(-1.5), f64::from(f32::EPSILON));
        assert_eq!(unit_in_the_last_place(1.0e7), 1.0);
        let tolerance = Tolerance { ulps: 2.0, of_m: 1.0e7, absolute_m: 0.25 };
        assert_eq!(tolerance.bound_m(), 2.25);
    }

    #[test]
    fn equal_planes_agree() {
        assert_eq!(bit_equal(&plane(), &plane()).unwrap().num_samples, 15);
        assert_eq!(within(&plane(), &plane(), |_, _| Tolerance::EXACT).unwrap().num_different, 0);
    }

    #[test]
    fn one_sample_at_the_tolerance_agrees_and_one_past_it_does_not() {
        let at = changed(|samples| samples[7] = next(samples[7], 10));
        let agreement = within(&plane(), &at, ten_ulps).unwrap();
        assert_eq!((agreement.num_different, agreement.worst.place), (1, [2, 1]));
        assert_eq!(agreement.worst.share(), 1.0);
        for num in [-11, 11] {
            let past = changed(|samples| samples[7] = next(samples[7], num));
            let mismatch = within(&plane(), &past, ten_ulps).unwrap_err();
            assert!(matches!(mismatch, Mismatch::Apart { num: 1, of: 15, worst } if worst.place == [2, 1]));
            assert!(
                mismatch.to_string().contains("column 2, row 1: expected 1.07e2 (0x42d60000)"),
                "{mismatch}"
            );
        }
    }

    #[test]
    fn the_worst_of_several_is_reported() {
        let several = changed(|samples| {
            samples[2] += 0.01;
            samples[11] += 5.0;
            samples[14] += 1.0;
        });
        for mismatch in [within(&plane(), &several, ten_ulps), bit_equal(&plane(), &several)] {
            let mismatch = mismatch.unwrap_err();
            assert!(
                matches!(mismatch, Mismatch::Apart { num: 3, worst, .. } if worst.place == [1, 2]),
                "{mismatch}"
            );
        }
    }

    #[test]
    fn one_bit_is_too_much_for_bits() {
        for change in [|value| next(value, 1), |value: f32| -value] {
            let other = changed(|samples| samples[0] = change(samples[0]));
            assert!(matches!(bit_equal(&plane(), &other), Err(Mismatch::Apart { num: 1, .. })));
            assert!(within(&plane(), &other, |_, _| Tolerance::EXACT).is_err());
        }
        let zero = Plane::new(2, 1, vec![1.0, 0.0]);
        let negative_zero = Plane::new(2, 1, vec![1.0, -0.0]);
        let mismatch = bit_equal(&zero, &negative_zero).unwrap_err();
        assert!(matches!(mismatch, Mismatch::Apart { num: 1, worst, .. } if worst.place == [1, 0]));
    }

    #[test]
    fn nan_and_infinity_never_agree_not_even_with_themselves() {
        for bad in [f32::NAN, -f32::NAN, f32::from_bits(0x7f80_0001), f32::INFINITY, f32::NEG_INFINITY] {
            let bad = changed(|samples| samples[3] = bad);
            let limitless = |_: u32, _: u32| Tolerance { absolute_m: f64::INFINITY, ..Tolerance::EXACT };
            for (expected, found) in [(&plane(), &bad), (&bad, &plane()), (&bad, &bad)] {
                for result in [bit_equal(expected, found), within(expected, found, limitless)] {
                    assert!(matches!(result, Err(Mismatch::NotFinite { num: 1, .. })), "{result:?}");
                }
            }
        }
    }

    #[test]
    fn swapped_samples_do_not_agree() {
        let swapped = changed(|samples| samples.swap(4, 5));
        assert!(within(&plane(), &swapped, ten_ulps).is_err());
        assert!(bit_equal(&plane(), &swapped).is_err());
        let turned = Plane::from_fn(5, 3, |x, z| plane().at(4 - x, z));
        assert!(bit_equal(&plane(), &turned).is_err());
    }

    #[test]
    fn another_size_does_not_agree_even_with_the_same_samples() {
        let other = Plane::new(3, 5, plane().samples().to_vec());
        assert!(matches!(bit_equal(&plane(), &other), Err(Mismatch::Size { .. })));
        assert!(matches!(within(&plane(), &other, ten_ulps), Err(Mismatch::Size { .. })));
    }

    #[test]
    fn nothing_does_not_agree_with_nothing() {
        let nothing = Plane::new(0, 0, Vec::new());
        assert_eq!(bit_equal(&nothing, &nothing), Err(Mismatch::Empty));
        assert_eq!(within(&nothing, &nothing, ten_ulps), Err(Mismatch::Empty));
    }
}
