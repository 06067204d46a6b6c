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

/// Turns pointer samples into places at equal arc length. The first place is known with the second point; a piece of the curve
/// is settled when the point after its end is known, or the stroke ends; what is left of one piece carries into the next. So
/// feeding a stroke whole or sample by sample gives the same places.
#[derive(Debug, Clone)]
pub struct StrokeSampler {
    spacing: f64,
    spacing_m: f64,
    /// The first point, until its place is given.
    first: Option<Point>,
    /// The last points of the curve, distinct, oldest first: at most the three that the next piece needs before its end.
    recent: VecDeque<Point>,
    settled: VecDeque<Piece>,
    /// The oldest settled piece, measured, while places lie on it.
    current: Option<(Piece, CurveSegment)>,
    /// Distance from the start of the current piece to the next place.
    until_next: f64,
    num_placed: u32,
    num_points: u32,
    /// Sum of the distances between successive points, which the curve is no shorter than.
    least_length: f64,
    is_finished: bool,
}

#[derive(Debug, Clone, Copy)]
struct Point {
    position: [f64; 2],
    pressure: f64,
}

/// A settled piece, not measured yet: a long stroke that is fed whole has many.
#[derive(Debug, Clone, Copy)]
struct Piece {
    before: Option<[f64; 2]>,
    start: Point,
    end: Point,
    after: Option<[f64; 2]>,
}

impl StrokeSampler {
    /// Places `spacing` samples apart, which are `spacing_m` metres.
    #[must_use]
    pub const fn new(spacing: f64, spacing_m: f64) -> Self {
        Self {
            spacing,
            spacing_m,
            first: None,
            recent: VecDeque::new(),
            settled: VecDeque::new(),
            current: None,
            until_next: 0.0,
            num_placed: 0,
            num_points: 0,
            least_length: 0.0,
            is_finished: false,
        }
    }

    /// The next pointer sample: its place in samples, and its pressure 0..1.
    ///
    /// # Errors
    /// [`Error::TooManyInstances`] when the stroke becomes too long; it goes on without the sample.
    pub fn push(&mut self, position: [f64; 2], pressure: f64) -> Result<()> {
        let next = Point { position, pressure };
        if let Some(last) = self.recent.back_mut() {
            let step = distance(last.position, position);
            if step < SAME_PLACE {
                last.pressure = pressure;
                if self.num_points == 1 {
                    self.first = Some(*last);
                }
                return Ok(());
            }
            if (self.least_length + step) / self.spacing > f64::from(MAX_INSTANCES) {
                return Err(self.too_many());
            }
            self.least_length += step;
        } else {
            self.first = Some(next);
        }
        self.num_points += 1;
        self.settle(Some(position));
        self.recent.push_back(next);
        if self.recent.len() > 3 {
            self.recent.pop_front();
        }
        Ok(())
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
            self.settled.push_back(Piece { before, start: *start, end: *end, after });
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
        if let Some(first) = self.first.take_if(|_| self.num_points > 1 || self.is_finished) {
            self.until_next = self.spacing;
            return self.place(first.position, first.pressure).map(Some);
        }
        while let Some((piece, curve)) = self.take_current() {
            let length = curve.length();
            // The end of the last piece belongs to the stroke; that of any other is the start of the next.
            if self.until_next < length || (self.until_next <= length && self.is_last_piece()) {
                let u = curve.parameter_at(self.until_next);
                let pressure = piece.start.pressure + u * (piece.end.pressure - piece.start.pressure);
                let position = curve.point(u);
                self.current = Some((piece, curve));
                self.until_next += self.spacing;
                return self.place(position, pressure).map(Some);
            }
            self.until_next -= length;
        }
        Ok(None)
    }

    /// The piece that places lie on, measured; the next settled one where the last is used up.
    fn take_current(&mut self) -> Option<(Piece, CurveSegment)> {
        self.current.take().or_else(|| {
            let piece = self.settled.pop_front()?;
            Some((
                piece,
                CurveSegment::new(piece.before, piece.start.position, piece.end.position, piece.after),
            ))
        })
    }

    fn is_last_piece(&self) -> bool {
        self.is_finished && self.settled.is_empty()
    }

    fn place(&mut self, position: [f64; 2], pressure: f64) -> Result<PlacedSample> {
        if self.num_placed >= MAX_INSTANCES {
            return Err(self.too_many());
        }
        let index = self.num_placed;
        self.num_placed += 1;
        Ok(PlacedSample { position, pressure, index })
    }

    const fn too_many(&self) -> Error {
        Error::TooManyInstances { limit: MAX_INSTANCES, spacing_m: self.spacing_m }
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
            sampler.push([x, 7.0], 1.0).unwrap();
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
        sampler.push([5.0, 5.0], 0.25).unwrap();
        assert_eq!(sampler.next_place().unwrap(), None, "not settled before the end");
        sampler.push([5.0005, 5.0], 0.75).unwrap();
        sampler.finish();
        assert!(!sampler.has_moved());
        let places = all_places(&mut sampler);
        assert_eq!(places, [PlacedSample { position: [5.0, 5.0], pressure: 0.75, index: 0 }]);
    }

    #[test]
    fn the_first_place_is_known_with_the_second_point() {
        let mut sampler = StrokeSampler::new(3.0, 3.0);
        sampler.push([5.0, 5.0], 0.25).unwrap();
        sampler.push([9.0, 5.0], 1.0).unwrap();
        let places = all_places(&mut sampler);
        assert_eq!(places, [PlacedSample { position: [5.0, 5.0], pressure: 0.25, index: 0 }]);
    }

    #[test]
    fn a_stroke_that_would_not_end_is_refused_before_anything_is_placed() {
        let mut sampler = StrokeSampler::new(0.5, 0.5);
        sampler.push([0.0, 0.0], 1.0).unwrap();
        let err = sampler.push([1.0e9, 0.0], 1.0).unwrap_err();
        assert!(matches!(err, Error::TooManyInstances { limit: MAX_INSTANCES, .. }));
        sampler.push([1.0, 0.0], 1.0).unwrap();
        sampler.finish();
        assert_eq!(all_places(&mut sampler).len(), 3);
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
                whole.push([x, z], pressure).unwrap();
                live.push([x, z], pressure).unwrap();
                live_places.extend(all_places(&mut live));
                if doubled {
                    whole.push([x, z + 1.0e-4], pressure / 2.0).unwrap();
                    live.push([x, z + 1.0e-4], pressure / 2.0).unwrap();
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
                sampler.push([x, z], 1.0).unwrap();
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
