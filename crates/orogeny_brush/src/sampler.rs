//! Places at equal distances along the curve through pointer samples, however these arrive.

use std::collections::VecDeque;

use crate::curve::{CurveSegment, distance};
use crate::{Error, Result};

/// Successive points closer than this, in samples, are one.
const SAME_PLACE: f64 = 1.0e-3;
/// The most instances of one stroke.
const MAX_INSTANCES: u32 = 1 << 24;

/// Where an instance lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedSample {
    /// In samples of the terrain.
    pub position: [f64; 2],
    /// 0..1.
    pub pressure: f64,
    /// Which one of the stroke, from 0.
    pub index: u32,
}

/// Turns pointer samples into places at equal arc length. A piece of the curve is settled when the point after its end is
/// known, or the stroke ends; what is left of one piece carries into the next. So feeding a stroke whole or sample by sample
/// gives the same places.
#[derive(Debug, Clone)]
pub struct StrokeSampler {
    spacing: f64,
    spacing_m: f64,
    /// The last points of the curve, distinct, oldest first: at most the three that the next piece needs before its end.
    recent: VecDeque<Point>,
    settled: VecDeque<Settled>,
    /// Distance from the start of the first settled piece to the next place.
    until_next: f64,
    num_placed: u32,
    num_points: u32,
    is_finished: bool,
}

#[derive(Debug, Clone, Copy)]
struct Point {
    position: [f64; 2],
    pressure: f64,
}

#[derive(Debug, Clone)]
struct Settled {
    curve: CurveSegment,
    start_pressure: f64,
    end_pressure: f64,
}

impl StrokeSampler {
    /// Places `spacing` samples apart, which are `spacing_m` metres.
    #[must_use]
    pub const fn new(spacing: f64, spacing_m: f64) -> Self {
        Self {
            spacing,
            spacing_m,
            recent: VecDeque::new(),
            settled: VecDeque::new(),
            until_next: 0.0,
            num_placed: 0,
            num_points: 0,
            is_finished: false,
        }
    }

    /// The next pointer sample: its place in samples, and its pressure 0..1.
    pub fn push(&mut self, position: [f64; 2], pressure: f64) {
        let next = Point { position, pressure };
        if let Some(last) = self.recent.back_mut()
            && distance(last.position, position) < SAME_PLACE
        {
            last.pressure = pressure;
            return;
        }
        self.num_points += 1;
        self.settle(Some(position));
        self.recent.push_back(next);
        if self.recent.len() > 3 {
            self.recent.pop_front();
        }
    }

    /// No more samples come: the rest is settled.
    pub fn finish(&mut self) {
        if !self.is_finished {
            self.settle(None);
            self.is_finished = true;
        }
    }

    /// Settles the piece between the last two points, now that the point after them, or that there is none, is known.
    fn settle(&mut self, after: Option<[f64; 2]>) {
        let mut newest = self.recent.iter().rev();
        if let (Some(end), Some(start)) = (newest.next(), newest.next()) {
            let before = newest.next().map(|point| point.position);
            let curve = CurveSegment::new(before, start.position, end.position, after);
            let (start_pressure, end_pressure) = (start.pressure, end.pressure);
            self.settled.push_back(Settled { curve, start_pressure, end_pressure });
        }
    }

    /// Whether the stroke is known to have moved. Until then a finished stroke is a single dab at full strength.
    #[must_use]
    pub const fn has_moved(&self) -> bool {
        self.num_points > 1
    }

    /// The next settled place, if there is one.
    ///
    /// # Errors
    /// [`Error::TooManyInstances`] for a stroke that would not end.
    pub fn next_place(&mut self) -> Result<Option<PlacedSample>> {
        while let Some(piece) = self.settled.front() {
            let length = piece.curve.length();
            // The end of the last piece belongs to the stroke; that of any other is the start of the next.
            if self.until_next <= length && (self.until_next < length || self.is_last_piece()) {
                let u = piece.curve.parameter_at(self.until_next);
                let pressure = piece.start_pressure + u * (piece.end_pressure - piece.start_pressure);
                let position = piece.curve.point(u);
                self.until_next += self.spacing;
                return self.place(position, pressure).map(Some);
            }
            self.until_next -= length;
            self.settled.pop_front();
        }
        if self.is_finished && self.num_points == 1 && self.num_placed == 0 {
            let only = self.recent.back().copied();
            return only.map(|point| self.place(point.position, point.pressure)).transpose();
        }
        Ok(None)
    }

    fn is_last_piece(&self) -> bool {
        self.is_finished && self.settled.len() == 1
    }

    fn place(&mut self, position: [f64; 2], pressure: f64) -> Result<PlacedSample> {
        if self.num_placed >= MAX_INSTANCES {
            return Err(Error::TooManyInstances { limit: MAX_INSTANCES, spacing_m: self.spacing_m });
        }
        let index = self.num_placed;
        self.num_placed += 1;
        Ok(PlacedSample { position, pressure, index })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn all_places(sampler: &mut StrokeSampler) -> Vec<PlacedSample> {
        std::iter::from_fn(|| sampler.next_place().unwrap()).collect()
    }

    #[test]
    fn a_straight_stroke_has_places_at_equal_distances_and_carries_the_rest() {
        let mut sampler = StrokeSampler::new(3.0, 3.0);
        for x in [0.0, 4.0, 5.0, 12.5] {
            sampler.push([x, 7.0], 1.0);
        }
        sampler.finish();
        let found: Vec<_> = all_places(&mut sampler).iter().map(|place| place.position[0]).collect();
        assert_eq!(found.len(), 5);
        for (found, expected) in found.iter().zip([0.0, 3.0, 6.0, 9.0, 12.0]) {
            assert!((found - expected).abs() < 0.03, "{found} {expected}");
        }
    }

    #[test]
    fn a_stroke_that_never_moves_is_one_place_with_the_last_pressure() {
        let mut sampler = StrokeSampler::new(3.0, 3.0);
        sampler.push([5.0, 5.0], 0.25);
        assert_eq!(sampler.next_place().unwrap(), None, "not settled before the end");
        sampler.push([5.0005, 5.0], 0.75);
        sampler.finish();
        assert!(!sampler.has_moved());
        let places = all_places(&mut sampler);
        assert_eq!(places, [PlacedSample { position: [5.0, 5.0], pressure: 0.75, index: 0 }]);
    }

    #[test]
    fn a_stroke_that_would_not_end_is_refused() {
        let mut sampler = StrokeSampler::new(0.5, 0.5);
        sampler.push([0.0, 0.0], 1.0);
        sampler.push([1.0e9, 0.0], 1.0);
        sampler.finish();
        let end = loop {
            match sampler.next_place() {
                Ok(place) => assert!(place.is_some()),
                Err(err) => break err,
            }
        };
        assert!(matches!(end, Error::TooManyInstances { limit: MAX_INSTANCES, .. }));
    }

    proptest! {
        #[test]
        fn however_the_samples_arrive_the_places_are_the_same(
            points in prop::collection::vec(((-50.0_f64..50.0, -50.0_f64..50.0), 0.0_f64..=1.0, any::<bool>()), 1..25),
            spacing in 0.5_f64..20.0,
        ) {
            let mut whole = StrokeSampler::new(spacing, spacing);
            let mut live = StrokeSampler::new(spacing, spacing);
            let mut live_places = Vec::new();
            for ((x, z), pressure, doubled) in points {
                let x = if doubled { x.round() } else { x };
                whole.push([x, z], pressure);
                live.push([x, z], pressure);
                live_places.extend(all_places(&mut live));
                if doubled {
                    whole.push([x, z + 1.0e-4], pressure / 2.0);
                    live.push([x, z + 1.0e-4], pressure / 2.0);
                    live_places.extend(all_places(&mut live));
                }
            }
            whole.finish();
            live.finish();
            live_places.extend(all_places(&mut live));
            prop_assert_eq!(all_places(&mut whole), live_places);
        }

        #[test]
        fn neighbouring_places_lie_one_spacing_apart_along_the_curve(
            points in prop::collection::vec((-50.0_f64..50.0, -50.0_f64..50.0), 2..12), spacing in 0.5_f64..5.0,
        ) {
            let mut sampler = StrokeSampler::new(spacing, spacing);
            for (x, z) in points {
                sampler.push([x, z], 1.0);
            }
            sampler.finish();
            for pair in all_places(&mut sampler).windows(2) {
                // A chord is never longer than the curve between its ends.
                prop_assert!(distance(pair[0].position, pair[1].position) <= spacing * 1.02);
                prop_assert_eq!(pair[0].index + 1, pair[1].index);
            }
        }
    }
}
