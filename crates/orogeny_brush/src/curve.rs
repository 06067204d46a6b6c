//! One piece of the curve through pointer samples: centripetal Catmull-Rom.

/// Chords into which a piece is cut to measure its length: doubled from the first to the last until the length settles.
const MIN_CHORDS: usize = 32;
const MAX_CHORDS: usize = 1024;
/// The length has settled when doubling the chords changes it by less than this share; the specification asks for 1 %.
const LENGTH_TOLERANCE: f64 = 1.0e-4;

/// The piece between two successive points, measured along its length. In samples.
#[derive(Debug, Clone)]
pub struct CurveSegment {
    start: [f64; 2],
    end: [f64; 2],
    start_tangent: [f64; 2],
    end_tangent: [f64; 2],
    /// Length from the start to each chord's end.
    lengths: Vec<f64>,
}

impl CurveSegment {
    /// The piece from `start` to `end` of the curve through `before`, `start`, `end`, `after`; where there is no point
    /// before or after, the other end is mirrored. Successive points are distinct.
    ///
    /// Centripetal (alpha = 1/2): knots lie at the square roots of the distances (Yuksel, Schaefer & Keyser 2011), so that
    /// the curve has no cusp or loop within a piece.
    #[must_use]
    pub fn new(before: Option<[f64; 2]>, start: [f64; 2], end: [f64; 2], after: Option<[f64; 2]>) -> Self {
        let before = before.unwrap_or_else(|| mirrored(end, start));
        let after = after.unwrap_or_else(|| mirrored(start, end));
        let knots = [interval(before, start), interval(start, end), interval(end, after)];
        let [first, middle, last] = knots;
        // The derivative at a point, of the curve through it and its neighbours, times the knot interval of this piece.
        let tangent = |a: [f64; 2], b: [f64; 2], c: [f64; 2], ab: f64, bc: f64| -> [f64; 2] {
            std::array::from_fn(|axis| {
                let (a, b, c) = (at(a, axis), at(b, axis), at(c, axis));
                middle * ((b - a) / ab - (c - a) / (ab + bc) + (c - b) / bc)
            })
        };
        let start_tangent = tangent(before, start, end, first, middle);
        let end_tangent = tangent(start, end, after, middle, last);
        let mut segment = Self { start, end, start_tangent, end_tangent, lengths: Vec::new() };
        segment.measure();
        segment
    }

    fn measure(&mut self) {
        let mut num_chords = MIN_CHORDS;
        self.lengths = self.chord_lengths(num_chords);
        while num_chords < MAX_CHORDS {
            num_chords *= 2;
            let finer = self.chord_lengths(num_chords);
            let (coarse_length, fine_length) = (self.length(), finer.last().copied().unwrap_or_default());
            self.lengths = finer;
            if fine_length - coarse_length <= LENGTH_TOLERANCE * fine_length {
                break;
            }
        }
    }

    fn chord_lengths(&self, num_chords: usize) -> Vec<f64> {
        let mut last = self.start;
        let mut length = 0.0;
        (1..=num_chords)
            .map(|chord| {
                let next = self.point(chord as f64 / num_chords as f64);
                length += distance(last, next);
                last = next;
                length
            })
            .collect()
    }

    /// The place at parameter `u` in 0..1.
    #[must_use]
    pub fn point(&self, u: f64) -> [f64; 2] {
        let (u2, u3) = (u * u, u * u * u);
        std::array::from_fn(|axis| {
            at(self.start, axis) * (2.0 * u3 - 3.0 * u2 + 1.0)
                + at(self.start_tangent, axis) * (u3 - 2.0 * u2 + u)
                + at(self.end, axis) * (3.0 * u2 - 2.0 * u3)
                + at(self.end_tangent, axis) * (u3 - u2)
        })
    }

    /// Arc length.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or_default()
    }

    /// The parameter at which `length` along the piece is reached; within 0..1.
    #[must_use]
    pub fn parameter_at(&self, length: f64) -> f64 {
        let num_chords = self.lengths.len() as f64;
        let chord = self.lengths.partition_point(|end| *end < length);
        let chord_end = self.lengths.get(chord).copied().unwrap_or_else(|| self.length());
        let chord_start =
            chord.checked_sub(1).and_then(|last| self.lengths.get(last)).copied().unwrap_or_default();
        let chord_length = chord_end - chord_start;
        if chord_length <= 0.0 {
            return ((chord + 1) as f64 / num_chords).min(1.0);
        }
        // Along a chord the speed is taken as linear, so the length is a quadratic of the parameter, solved in the form that
        // does not cancel.
        let share = ((length - chord_start) / chord_length).clamp(0.0, 1.0);
        let start_speed = self.speed(chord as f64 / num_chords);
        let end_speed = self.speed((chord + 1) as f64 / num_chords);
        let speed =
            (start_speed * start_speed + (end_speed * end_speed - start_speed * start_speed) * share).sqrt();
        let sum = start_speed + speed;
        let within = if sum > 0.0 { share * (start_speed + end_speed) / sum } else { share };
        ((chord as f64 + within) / num_chords).clamp(0.0, 1.0)
    }

    /// Which way the curve goes at parameter `u`, of length 1; none where it stands still.
    #[must_use]
    pub fn direction(&self, u: f64) -> Option<[f64; 2]> {
        let [x, z] = self.derivative(u);
        let length = x.hypot(z);
        (length > 0.0).then(|| [x / length, z / length])
    }

    /// Length of the derivative at parameter `u`.
    fn speed(&self, u: f64) -> f64 {
        let [x, z] = self.derivative(u);
        x.hypot(z)
    }

    fn derivative(&self, u: f64) -> [f64; 2] {
        let u2 = u * u;
        std::array::from_fn(|axis| {
            (at(self.end, axis) - at(self.start, axis)) * (6.0 * u - 6.0 * u2)
                + at(self.start_tangent, axis) * (3.0 * u2 - 4.0 * u + 1.0)
                + at(self.end_tangent, axis) * (3.0 * u2 - 2.0 * u)
        })
    }
}

/// `from` seen in the mirror at `mirror`.
fn mirrored(from: [f64; 2], mirror: [f64; 2]) -> [f64; 2] {
    std::array::from_fn(|axis| 2.0 * at(mirror, axis) - at(from, axis))
}

fn interval(a: [f64; 2], b: [f64; 2]) -> f64 {
    distance(a, b).sqrt()
}

pub(crate) fn distance([ax, az]: [f64; 2], [bx, bz]: [f64; 2]) -> f64 {
    (bx - ax).hypot(bz - az)
}

#[expect(clippy::indexing_slicing, reason = "from_fn over two axes gives 0 and 1")]
const fn at(point: [f64; 2], axis: usize) -> f64 {
    point[axis]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_straight_piece_is_as_long_as_its_chord() {
        let segment = CurveSegment::new(None, [1.0, 2.0], [4.0, 6.0], None);
        assert!((segment.length() - 5.0).abs() < 1.0e-12);
        let [x, z] = segment.point(segment.parameter_at(2.5));
        assert!((x - 2.5).abs() < 1.0e-9 && (z - 4.0).abs() < 1.0e-9);
    }

    proptest! {
        /// Against the recursive definition of Barry & Goldman (1988), which shares no formula with the Hermite form.
        #[test]
        fn equals_the_pyramid_of_barry_and_goldman(
            points in prop::array::uniform4(prop::array::uniform2(-100.0_f64..100.0)), u in 0.0_f64..1.0,
        ) {
            let [p0, p1, p2, p3] = points;
            prop_assume!(distance(p0, p1) > 0.1 && distance(p1, p2) > 0.1 && distance(p2, p3) > 0.1);
            let t1 = interval(p0, p1);
            let t2 = t1 + interval(p1, p2);
            let t3 = t2 + interval(p2, p3);
            let t = t1 + u * (t2 - t1);
            let blend = |a: [f64; 2], b: [f64; 2], ta: f64, tb: f64| -> [f64; 2] {
                std::array::from_fn(|axis| ((tb - t) * a[axis] + (t - ta) * b[axis]) / (tb - ta))
            };
            let (a1, a2, a3) = (blend(p0, p1, 0.0, t1), blend(p1, p2, t1, t2), blend(p2, p3, t2, t3));
            let (b1, b2) = (blend(a1, a2, 0.0, t2), blend(a2, a3, t1, t3));
            let expected = blend(b1, b2, t1, t2);
            let found = CurveSegment::new(Some(p0), p1, p2, Some(p3)).point(u);
            prop_assert!(distance(found, expected) < 1.0e-6, "{:?} {:?}", found, expected);
        }

        #[test]
        fn the_length_is_right_to_one_percent_and_places_follow_it(
            points in prop::array::uniform4(prop::array::uniform2(-100.0_f64..100.0)),
        ) {
            let [p0, p1, p2, p3] = points;
            prop_assume!(distance(p0, p1) > 0.1 && distance(p1, p2) > 0.1 && distance(p2, p3) > 0.1);
            let segment = CurveSegment::new(Some(p0), p1, p2, Some(p3));
            let fine = segment.chord_lengths(1 << 16);
            let truth = *fine.last().unwrap();
            prop_assert!((segment.length() - truth).abs() <= 0.01 * truth);
            for share in [0.1, 0.5, 0.9] {
                let u = segment.parameter_at(share * segment.length());
                let walked = fine[((u * 65536.0) as usize).clamp(1, 65536) - 1];
                prop_assert!((walked - share * truth).abs() <= 0.01 * truth, "{} of {}", walked, truth);
            }
        }
    }
}
