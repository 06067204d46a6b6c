//! Grids that go on without an end: mirrored at their borders, as often as it takes.

use crate::SampleRect;

/// The sample that lies where `place` does once a grid of `num_samples` is mirrored at its first and last sample, without
/// repeating them: `dcb|abcd|cba`, as often as it takes.
#[must_use]
pub const fn mirrored(place: i32, num_samples: u32) -> i32 {
    mirrored_by(place, 2 * num_samples.saturating_sub(1))
}

/// The same of a grid that is there again after `period` samples, once forwards and once backwards. After an odd number of them it
/// is mirrored between two samples at its far end, which are alike: `dcb|abcd|dcb`.
const fn mirrored_by(place: i32, period: u32) -> i32 {
    if period == 0 {
        return 0;
    }
    let period = period.cast_signed();
    let within = place.rem_euclid(period);
    if within <= period / 2 { within } else { period - within }
}

/// After how many samples along x and z a grid is there again, once forwards and once backwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Mirrors {
    /// In samples; `None`: along that axis nobody asks for what the grid does not have.
    pub periods: [Option<u32>; 2],
}

impl Mirrors {
    /// Nobody asks for what the grid does not have.
    pub const NONE: Self = Self { periods: [None, None] };

    /// Those of a grid of so many samples along x and z, mirrored at its first and last ones.
    #[must_use]
    pub fn of_extent(extent: [u32; 2]) -> Self {
        Self { periods: extent.map(|num_samples| Some(2 * num_samples.saturating_sub(1))) }
    }

    /// Where along x a place lies in the grid.
    #[inline]
    #[must_use]
    pub const fn column(&self, x: i32) -> i32 {
        Self::place(x, self.periods[0])
    }

    /// Where along z a place lies in the grid.
    #[inline]
    #[must_use]
    pub const fn row(&self, z: i32) -> i32 {
        Self::place(z, self.periods[1])
    }

    /// The samples of the grid that a rectangle shows.
    #[must_use]
    pub fn shown(&self, rect: &SampleRect) -> SampleRect {
        let range = |first: i32, end: i32, period: Option<u32>| match period {
            Some(period) if first < end => mirrored_range(first, end, period),
            _ => (first, end),
        };
        let (x0, x1) = range(rect.x0, rect.x1, self.periods[0]);
        let (z0, z1) = range(rect.z0, rect.z1, self.periods[1]);
        SampleRect::new(x0, z0, x1, z1)
    }

    const fn place(place: i32, period: Option<u32>) -> i32 {
        match period {
            Some(period) => mirrored_by(place, period),
            None => place,
        }
    }
}

/// The samples that `first..end` show, which is not empty: first and one past the last.
fn mirrored_range(first: i32, end: i32, period: u32) -> (i32, i32) {
    let whole = period.cast_signed();
    let middle = whole / 2;
    if whole == 0 || i64::from(end) - i64::from(first) >= i64::from(whole) {
        return (0, middle + 1);
    }
    // Between two mirrors the samples keep their order, so the ends are ends; a mirror within the range is an end too.
    let (a, b) = (mirrored_by(first, period), mirrored_by(end - 1, period));
    let shows = |place: i32| i64::from(first) + i64::from((place - first).rem_euclid(whole)) < i64::from(end);
    let least = if shows(0) { 0 } else { a.min(b) };
    let greatest = if shows(middle) || shows(whole - middle) { middle } else { a.max(b) };
    (least, greatest + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn places_beyond_a_grid_are_mirrored_in_it() {
        for (place, expected) in
            [(-1, 1), (0, 0), (9, 9), (10, 8), (11, 7), (18, 0), (19, 1), (-10, 8), (400, 4)]
        {
            assert_eq!(mirrored(place, 10), expected, "{place}");
        }
        assert_eq!((mirrored(-7, 1), mirrored(3, 1), mirrored(3, 2)), (0, 0, 1));
        let largest = 1 << 20;
        assert_eq!(mirrored((1 << 20) + 5, largest), (1 << 20) - 7);
    }

    #[test]
    fn an_odd_period_has_two_samples_alike_at_the_far_end() {
        let found: Vec<_> = (-3..12).map(|place| mirrored_by(place, 7)).collect();
        assert_eq!(found, [3, 2, 1, 0, 1, 2, 3, 3, 2, 1, 0, 1, 2, 3, 3]);
    }

    #[test]
    fn every_other_sample_of_a_mirrored_grid_is_mirrored_after_half_as_many() {
        for num_samples in [2_u32, 7, 8, 33] {
            let period = 2 * (num_samples - 1);
            for place in -90..90 {
                let there = mirrored_by(place, period / 2);
                assert_eq!(mirrored(2 * place, num_samples), mirrored(2 * there, num_samples), "{place}");
            }
        }
    }

    proptest! {
        #[test]
        fn a_range_shows_what_its_samples_are_and_no_more(
            period in 0_u32..80, first in -100_i32..100, length in 1_i32..120,
        ) {
            let places: Vec<_> = (first..first + length).map(|place| mirrored_by(place, period)).collect();
            let expected = (*places.iter().min().unwrap(), places.iter().max().unwrap() + 1);
            prop_assert_eq!(mirrored_range(first, first + length, period), expected);
        }
    }
}
