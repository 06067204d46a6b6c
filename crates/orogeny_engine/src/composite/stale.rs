//! What of a page is no longer true.

use orogeny_field::SampleRect;

/// More rectangles than these become one around all of them.
const MAX_RECTS: usize = 6;

/// Rectangles that hold all samples that are no longer true.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Stale(Vec<SampleRect>);

impl Stale {
    pub(super) fn add(&mut self, rect: SampleRect) {
        if rect.is_empty() || self.0.iter().any(|known| known.contains(&rect)) {
            return;
        }
        self.0.retain(|known| !rect.contains(known));
        self.0.push(rect);
        self.limit();
    }

    /// A rectangle is true again.
    pub(super) fn remove(&mut self, rect: &SampleRect) {
        let beside = |known: SampleRect| {
            let both = known.intersection(rect);
            if both.is_empty() {
                return vec![known];
            }
            let north_and_south = [SampleRect { z1: both.z0, ..known }, SampleRect { z0: both.z1, ..known }];
            let west = SampleRect { x0: known.x0, x1: both.x0, ..both };
            let east = SampleRect { x0: both.x1, x1: known.x1, ..both };
            north_and_south.into_iter().chain([west, east]).filter(|part| !part.is_empty()).collect()
        };
        self.0 = std::mem::take(&mut self.0).into_iter().flat_map(beside).collect();
        self.limit();
    }

    /// The samples of a rectangle that are no longer true lie within this one.
    pub(super) fn within(&self, rect: &SampleRect) -> SampleRect {
        let parts = self.0.iter().map(|known| known.intersection(rect));
        parts.fold(SampleRect::EMPTY, |all, part| all.bounds_with(&part))
    }

    fn limit(&mut self) {
        if self.0.len() > MAX_RECTS {
            let all = self.0.iter().fold(SampleRect::EMPTY, |all, rect| all.bounds_with(rect));
            self.0 = vec![all];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::hash;

    const SIDE: i32 = 12;

    #[test]
    fn every_sample_that_is_stale_is_held() {
        let random = |seed: u32, number: u32, below: i32| {
            (f64::from(hash::uniform(seed, number, 1)).abs() * f64::from(below)) as i32
        };
        for seed in 0..200 {
            let mut stale = Stale::default();
            let mut is_stale = vec![false; (SIDE * SIDE) as usize];
            for change in (0_u32..30).map(|change| 8 * change) {
                let at = |number| random(seed, change + number, SIDE - 1);
                let (x, z) = (at(0), at(1));
                let rect = SampleRect::new(x, z, (x + 1 + at(2)).min(SIDE), (z + 1 + at(3)).min(SIDE));
                let is_added = at(4) < SIDE / 2;
                if is_added {
                    stale.add(rect)
                } else {
                    stale.remove(&rect)
                }
                for (place, is_stale) in (0_i32..).zip(&mut is_stale) {
                    let (x, z) = (place % SIDE, place / SIDE);
                    let sample = SampleRect::new(x, z, x + 1, z + 1);
                    if rect.contains(&sample) {
                        *is_stale = is_added;
                        assert!(is_added || stale.0.len() == 1 || stale.within(&sample).is_empty());
                    }
                    assert!(!*is_stale || stale.within(&sample) == sample);
                }
            }
            stale.remove(&SampleRect::new(0, 0, SIDE, SIDE));
            assert_eq!(stale, Stale::default());
        }
    }

    #[test]
    fn what_is_made_true_in_the_middle_leaves_what_is_around_it() {
        let mut stale = Stale::default();
        stale.add(SampleRect::new(0, 0, 10, 10));
        let middle = SampleRect::new(3, 3, 7, 8);
        stale.remove(&middle);
        assert!(stale.within(&middle).is_empty());
        assert_eq!(stale.within(&SampleRect::new(2, 3, 7, 8)), SampleRect::new(2, 3, 3, 8));
        assert_eq!(stale.within(&SampleRect::new(0, 0, 10, 10)), SampleRect::new(0, 0, 10, 10));
    }
}
