//! Places at equal distances along the curve through pointer samples, however these arrive, and in time while they rest.

use std::collections::VecDeque;

use crate::curve::{CurveSegment, distance};
use crate::{Error, Result};

/// Successive points closer than this, in samples, are one.
const SAME_PLACE: f64 = 1.0e-3;
/// The most instances of one stroke.
const MAX_INSTANCES: u32 = 1 << 24;
/// How often an airbrush gives an instance while it rests, seconds.
pub(crate) const REST_INTERVAL_S: f64 = 1.0 / 60.0;

/// How the pen is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pen {
    /// 0..1.
    pub pressure: f64,
    /// 0 upright to 1 flat.
    pub tilt: f64,
}

impl Pen {
    /// Full pressure, upright.
    pub const FULL: Self = Self { pressure: 1.0, tilt: 0.0 };

    fn towards(self, end: Self, share: f64) -> Self {
        Self {
            pressure: self.pressure + share * (end.pressure - self.pressure),
            tilt: self.tilt + share * (end.tilt - self.tilt),
        }
    }
}

/// Where an instance lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedSample {
    /// In samples of the terrain.
    pub position: [f64; 2],
    /// How the pen is held there.
    pub pen: Pen,
    /// Which way the stroke goes, of length 1; along x for one that never moves.
    pub direction: [f64; 2],
    /// Which one of the stroke, from 0.
    pub index: u32,
    /// For how long it stands, where it was given in time rather than along the way.
    pub rested_s: Option<f64>,
}

/// Turns pointer samples into places at equal arc length. The first place is known with the second point; a piece of the curve
/// is settled when the point after its end is known, or the stroke ends; what is left of one piece carries into the next. So
/// feeding a stroke whole or sample by sample gives the same places.
///
/// An airbrush also gives places in time while the pointer rests. A point at which it does so ends its piece of the curve, so
/// that these places are known at once; the stroke goes on from there as from a first point.
#[derive(Debug, Clone)]
pub struct StrokeSampler {
    spacing: f64,
    spacing_m: f64,
    is_airbrush: bool,
    /// The first point, until its place is given.
    first: Option<Point>,
    /// The place of the second.
    second: Option<[f64; 2]>,
    /// The last points of the curve, distinct, oldest first: at most the three that the next piece needs before its end.
    recent: VecDeque<Point>,
    settled: VecDeque<Settled>,
    /// The oldest settled piece, measured, while places lie on it.
    current: Option<(Piece, CurveSegment)>,
    /// Distance from the start of the current piece to the next place.
    until_next: f64,
    /// Which way the last place went.
    direction: [f64; 2],
    /// Seconds of rest since the last place that was given for resting.
    rested_s: f64,
    last_time_s: Option<f64>,
    num_placed: u32,
    num_points: u32,
    /// Sum of the distances between successive points, which the curve is no shorter than.
    least_length: f64,
    is_finished: bool,
}

#[derive(Debug, Clone, Copy)]
struct Point {
    position: [f64; 2],
    pen: Pen,
}

/// What places come from.
#[derive(Debug, Clone, Copy)]
enum Settled {
    Piece(Piece),
    /// Places given for resting at a point.
    Rest {
        point: Point,
        count: u32,
    },
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
            is_airbrush: false,
            first: None,
            second: None,
            recent: VecDeque::new(),
            settled: VecDeque::new(),
            current: None,
            until_next: 0.0,
            direction: [1.0, 0.0],
            rested_s: 0.0,
            last_time_s: None,
            num_placed: 0,
            num_points: 0,
            least_length: 0.0,
            is_finished: false,
        }
    }

    /// The same, giving places in time too.
    #[must_use]
    pub const fn as_airbrush(mut self) -> Self {
        self.is_airbrush = true;
        self
    }

    /// The next pointer sample: its place in samples, how the pen is held, and when, where that is known.
    ///
    /// # Errors
    /// [`Error::TooManyInstances`] when the stroke becomes too long; it goes on without the sample.
    pub fn push(&mut self, position: [f64; 2], pen: Pen, time_s: Option<f64>) -> Result<()> {
        let next = Point { position, pen };
        let elapsed_s = match (self.last_time_s, time_s) {
            (Some(before), Some(now)) => (now - before).max(0.0),
            _ => 0.0,
        };
        if let Some(last) = self.recent.back_mut() {
            let step = distance(last.position, position);
            if step < SAME_PLACE {
                last.pen = pen;
                // An airbrush's first place was given with the first sample.
                if self.num_points == 1 && !self.is_airbrush {
                    self.first = self.first.map(|first| Point { pen, ..first });
                }
                self.last_time_s = time_s.or(self.last_time_s);
                return self.rest(elapsed_s);
            }
            if (self.least_length + step) / self.spacing > f64::from(MAX_INSTANCES) {
                return Err(self.too_many());
            }
            self.least_length += step;
            self.second.get_or_insert(position);
        } else {
            self.first = Some(next);
        }
        self.last_time_s = time_s.or(self.last_time_s);
        self.num_points += 1;
        self.settle(Some(position));
        self.recent.push_back(next);
        if self.recent.len() > 3 {
            self.recent.pop_front();
        }
        Ok(())
    }

    /// The pointer has rested at the last point for a while.
    fn rest(&mut self, elapsed_s: f64) -> Result<()> {
        if !self.is_airbrush {
            return Ok(());
        }
        self.rested_s += elapsed_s;
        let count = (self.rested_s / REST_INTERVAL_S).floor();
        if count < 1.0 {
            return Ok(());
        }
        if count > f64::from(MAX_INSTANCES) {
            return Err(self.too_many());
        }
        self.rested_s -= count * REST_INTERVAL_S;
        self.settle(None);
        if let Some(point) = self.recent.pop_back() {
            self.recent.clear();
            self.recent.push_back(point);
            self.settled.push_back(Settled::Rest { point, count: count as u32 });
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

    /// Whether it was told that no more samples come.
    #[must_use]
    pub const fn is_finished(&self) -> bool {
        self.is_finished
    }

    /// Settles the piece between the last two points, now that the point after them, or that there is none, is known.
    fn settle(&mut self, after: Option<[f64; 2]>) {
        let mut newest = self.recent.iter().rev();
        if let (Some(end), Some(start)) = (newest.next(), newest.next()) {
            let before = newest.next().map(|point| point.position);
            self.settled.push_back(Settled::Piece(Piece { before, start: *start, end: *end, after }));
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
        let is_first_known = self.num_points > 1 || self.is_finished || self.is_airbrush;
        if let Some(first) = self.first.take_if(|_| is_first_known) {
            self.until_next = self.spacing;
            // An airbrush's first place is given before it is known which way the stroke goes.
            if let Some(second) = self.second.filter(|_| !self.is_airbrush) {
                self.direction = unit([first.position, second]).unwrap_or(self.direction);
            }
            return self.place(first.position, first.pen, None).map(Some);
        }
        loop {
            if let Some(Settled::Rest { point, count }) = self.settled.front_mut()
                && self.current.is_none()
            {
                let point = *point;
                *count -= 1;
                if *count == 0 {
                    self.settled.pop_front();
                }
                return self.place(point.position, point.pen, Some(REST_INTERVAL_S)).map(Some);
            }
            let Some((piece, curve)) = self.take_current() else { return Ok(None) };
            let length = curve.length();
            // The end of the last piece belongs to the stroke; that of any other is the start of the next.
            if self.until_next < length || (self.until_next <= length && self.is_last_piece()) {
                let u = curve.parameter_at(self.until_next);
                let pen = piece.start.pen.towards(piece.end.pen, u);
                let position = curve.point(u);
                self.direction = curve.direction(u).unwrap_or(self.direction);
                self.current = Some((piece, curve));
                self.until_next += self.spacing;
                return self.place(position, pen, None).map(Some);
            }
            self.until_next -= length;
        }
    }

    /// The piece that places lie on, measured; the next settled one where the last is used up.
    fn take_current(&mut self) -> Option<(Piece, CurveSegment)> {
        self.current.take().or_else(|| match self.settled.pop_front()? {
            Settled::Piece(piece) => Some((
                piece,
                CurveSegment::new(piece.before, piece.start.position, piece.end.position, piece.after),
            )),
            Settled::Rest { .. } => None,
        })
    }

    fn is_last_piece(&self) -> bool {
        self.is_finished && !self.settled.iter().any(|settled| matches!(settled, Settled::Piece(_)))
    }

    fn place(&mut self, position: [f64; 2], pen: Pen, rested_s: Option<f64>) -> Result<PlacedSample> {
        if self.num_placed >= MAX_INSTANCES {
            return Err(self.too_many());
        }
        let index = self.num_placed;
        self.num_placed += 1;
        Ok(PlacedSample { position, pen, direction: self.direction, index, rested_s })
    }

    const fn too_many(&self) -> Error {
        Error::TooManyInstances { limit: MAX_INSTANCES, spacing_m: self.spacing_m }
    }
}

/// The way from one place to another, of length 1; none where they are the same.
pub(crate) fn unit([[ax, az], [bx, bz]]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let (x, z) = (bx - ax, bz - az);
    let length = x.hypot(z);
    (length > 0.0).then(|| [x / length, z / length])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pressed(pressure: f64) -> Pen {
        Pen { pressure, tilt: 0.0 }
    }

    fn placed(position: [f64; 2], pressure: f64) -> PlacedSample {
        PlacedSample { position, pen: pressed(pressure), direction: [1.0, 0.0], index: 0, rested_s: None }
    }

    #[test]
    fn places_know_which_way_the_stroke_goes() {
        let mut sampler = StrokeSampler::new(1.0, 1.0);
        for position in [[0.0, 0.0], [0.0, 8.0], [8.0, 8.0]] {
            sampler.push(position, Pen::FULL, None).unwrap();
        }
        sampler.finish();
        let places = all_places(&mut sampler);
        assert_eq!(places[0].direction, [0.0, 1.0]);
        let [x, z] = places.last().unwrap().direction;
        assert!(x > 0.9 && z.abs() < 0.4, "{x} {z}");
        assert!(
            places.iter().all(|place| (place.direction[0].hypot(place.direction[1]) - 1.0).abs() < 1.0e-9)
        );
    }

    #[test]
    fn a_resting_airbrush_gives_places_in_time_at_once() {
        let mut sampler = StrokeSampler::new(3.0, 3.0).as_airbrush();
        sampler.push([5.0, 5.0], Pen::FULL, Some(0.0)).unwrap();
        assert_eq!(all_places(&mut sampler).len(), 1, "the dab that it begins with");
        sampler.push([5.0, 5.0], Pen::FULL, Some(0.5)).unwrap();
        let rested = all_places(&mut sampler);
        assert_eq!(rested.len(), 30);
        assert!(rested.iter().all(|place| place.rested_s == Some(REST_INTERVAL_S)));
        sampler.push([11.5, 5.0], Pen::FULL, Some(0.6)).unwrap();
        sampler.finish();
        assert_eq!(all_places(&mut sampler).len(), 2, "one after 3 and one after 6 samples");
        // Without times, and without an airbrush, resting is nothing.
        let mut plain = StrokeSampler::new(3.0, 3.0);
        plain.push([5.0, 5.0], Pen::FULL, Some(0.0)).unwrap();
        plain.push([5.0, 5.0], Pen::FULL, Some(9.0)).unwrap();
        plain.finish();
        assert_eq!(all_places(&mut plain).len(), 1);
    }

    fn all_places(sampler: &mut StrokeSampler) -> Vec<PlacedSample> {
        std::iter::from_fn(|| sampler.next_place().unwrap()).collect()
    }

    #[test]
    fn a_straight_stroke_has_places_at_equal_distances_and_carries_the_rest() {
        let mut sampler = StrokeSampler::new(3.0, 3.0);
        for x in [0.0, 4.0, 5.0, 12.5] {
            sampler.push([x, 7.0], Pen::FULL, None).unwrap();
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
        sampler.push([5.0, 5.0], pressed(0.25), None).unwrap();
        assert_eq!(sampler.next_place().unwrap(), None, "not settled before the end");
        sampler.push([5.0005, 5.0], pressed(0.75), None).unwrap();
        sampler.finish();
        assert!(!sampler.has_moved());
        let places = all_places(&mut sampler);
        assert_eq!(places, [placed([5.0, 5.0], 0.75)]);
    }

    #[test]
    fn the_first_place_is_known_with_the_second_point() {
        let mut sampler = StrokeSampler::new(3.0, 3.0);
        sampler.push([5.0, 5.0], pressed(0.25), None).unwrap();
        sampler.push([9.0, 5.0], Pen::FULL, None).unwrap();
        let places = all_places(&mut sampler);
        assert_eq!(places, [placed([5.0, 5.0], 0.25)]);
    }

    #[test]
    fn a_stroke_that_would_not_end_is_refused_before_anything_is_placed() {
        let mut sampler = StrokeSampler::new(0.5, 0.5);
        sampler.push([0.0, 0.0], Pen::FULL, None).unwrap();
        let err = sampler.push([1.0e9, 0.0], Pen::FULL, None).unwrap_err();
        assert!(matches!(err, Error::TooManyInstances { limit: MAX_INSTANCES, .. }));
        sampler.push([1.0, 0.0], Pen::FULL, None).unwrap();
        sampler.finish();
        assert_eq!(all_places(&mut sampler).len(), 3);
    }

    proptest! {
        #[test]
        fn however_the_samples_arrive_the_places_are_the_same(
            points in prop::collection::vec(((-50.0_f64..50.0, -50.0_f64..50.0), 0.0_f64..=1.0, any::<bool>()), 1..25),
            spacing in 0.5_f64..20.0,
            is_airbrush: bool,
        ) {
            let sampler = StrokeSampler::new(spacing, spacing);
            let mut whole = if is_airbrush { sampler.as_airbrush() } else { sampler };
            let mut live = whole.clone();
            let mut time_s = 0.0;
            let mut live_places = Vec::new();
            for ((x, z), pressure, doubled) in points {
                let x = if doubled { x.round() } else { x };
                time_s += pressure;
                whole.push([x, z], pressed(pressure), Some(time_s)).unwrap();
                live.push([x, z], pressed(pressure), Some(time_s)).unwrap();
                live_places.extend(all_places(&mut live));
                if doubled {
                    time_s += 0.3 * pressure;
                    whole.push([x, z + 1.0e-4], pressed(pressure / 2.0), Some(time_s)).unwrap();
                    live.push([x, z + 1.0e-4], pressed(pressure / 2.0), Some(time_s)).unwrap();
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
                sampler.push([x, z], Pen::FULL, None).unwrap();
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
