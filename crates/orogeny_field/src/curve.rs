//! A user's curve: control points, a monotone cubic through them, and the table that kernels read.

use crate::{Error, Result};

/// Entries of a [`CurveTable`].
pub const CURVE_TABLE_LENGTH: usize = 256;

/// The most control points.
pub const MAX_CURVE_POINTS: usize = 64;

/// Control points with rising `x`, joined by a monotone cubic: between two points it never leaves the range of their `y`.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    points: Vec<[f64; 2]>,
    /// The derivative at each point.
    slopes: Vec<f64>,
}

/// A curve as kernels take it: its value at [`CURVE_TABLE_LENGTH`] places at equal distances, between which it is linear.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveTable {
    /// The values, first and last at the ends of the domain.
    pub values: [f32; CURVE_TABLE_LENGTH],
    /// The smallest `x`.
    pub low: f32,
    /// Entries a unit of `x`: `(CURVE_TABLE_LENGTH - 1) / (high - low)`.
    pub entries_per_unit: f32,
}

impl Curve {
    /// A curve through control points; outside them it keeps their first and last `y`.
    ///
    /// # Errors
    /// [`Error::Curve`], naming `what`, for fewer than 2 or more than [`MAX_CURVE_POINTS`] points, a number that is not
    /// finite, or an `x` that is not above the one before it.
    pub fn new(what: &str, points: Vec<[f64; 2]>) -> Result<Self> {
        let refused = |reason: String| Err(Error::Curve { what: what.to_owned(), reason });
        if !(2..=MAX_CURVE_POINTS).contains(&points.len()) {
            return refused(format!("it has {} points, it must have 2 to {MAX_CURVE_POINTS}", points.len()));
        }
        if let Some([x, y]) = points.iter().find(|point| !point.iter().all(|number| number.is_finite())) {
            return refused(format!("[{x}, {y}] is no point"));
        }
        for pair in points.windows(2) {
            if let [[before, _], [x, _]] = pair
                && x <= before
            {
                return refused(format!("its x must rise from point to point, and {x} follows {before}"));
            }
        }
        let slopes = monotone_slopes(&points);
        Ok(Self { points, slopes })
    }

    /// The control points.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The smallest and the largest `y`: the curve stays between them.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        let ys = self.points.iter().map(|[_, y]| *y);
        (ys.clone().fold(f64::INFINITY, f64::min), ys.fold(f64::NEG_INFINITY, f64::max))
    }

    /// The value at `x`.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        let after = self.points.partition_point(|[place, _]| *place <= x);
        let point = |index: usize| Some((*self.points.get(index)?, *self.slopes.get(index)?));
        match (after.checked_sub(1).and_then(point), point(after)) {
            (Some(([x0, y0], slope0)), Some(([x1, y1], slope1))) => {
                // Cubic Hermite.
                let width = x1 - x0;
                let t = (x - x0) / width;
                let (t2, t3) = (t * t, t * t * t);
                y0 * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + slope0 * width * (t3 - 2.0 * t2 + t)
                    + y1 * (3.0 * t2 - 2.0 * t3)
                    + slope1 * width * (t3 - t2)
            }
            (Some(([_, y], _)), None) | (None, Some(([_, y], _))) => y,
            (None, None) => 0.0,
        }
    }

    /// The table over the domain `low ..= high`.
    #[must_use]
    pub fn table(&self, low: f64, high: f64) -> CurveTable {
        let step = (high - low) / (CURVE_TABLE_LENGTH - 1) as f64;
        CurveTable {
            values: std::array::from_fn(|index| self.value(low + index as f64 * step) as f32),
            low: low as f32,
            entries_per_unit: (1.0 / step) as f32,
        }
    }
}

/// Slopes that keep the cubic monotone between points (Fritsch & Butland, "A Method for Constructing Local Monotone Piecewise
/// Cubic Interpolants", 1984): the weighted harmonic mean of the chords' slopes, 0 where these change sign; one-sided
/// three-point slopes at the ends, limited likewise.
fn monotone_slopes(points: &[[f64; 2]]) -> Vec<f64> {
    let chords: Vec<(f64, f64)> = points
        .windows(2)
        .filter_map(|pair| match pair {
            [[x0, y0], [x1, y1]] => Some((x1 - x0, (y1 - y0) / (x1 - x0))),
            _ => None,
        })
        .collect();
    let end = |near: Option<&(f64, f64)>, far: Option<&(f64, f64)>| match (near, far) {
        (Some((width, slope)), Some((far_width, far_slope))) => {
            let three_point = ((2.0 * width + far_width) * slope - width * far_slope) / (width + far_width);
            if three_point * slope <= 0.0 {
                0.0
            } else if slope * far_slope <= 0.0 && three_point.abs() > 3.0 * slope.abs() {
                3.0 * slope
            } else {
                three_point
            }
        }
        (Some((_, slope)), None) => *slope,
        _ => 0.0,
    };
    let mut slopes = vec![end(chords.first(), chords.get(1))];
    slopes.extend(chords.windows(2).map(|pair| match pair {
        [(left_width, left), (right_width, right)] if left * right > 0.0 => {
            let (w1, w2) = (2.0 * right_width + left_width, right_width + 2.0 * left_width);
            (w1 + w2) / (w1 / left + w2 / right)
        }
        _ => 0.0,
    }));
    let mut backwards = chords.iter().rev();
    slopes.push(end(backwards.next(), backwards.next()));
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_curve_goes_through_its_points_and_keeps_its_ends() {
        let curve = Curve::new("a test", vec![[0.0, 1.0], [0.25, 0.5], [1.0, 0.0]]).unwrap();
        for (x, y) in [(0.0, 1.0), (0.25, 0.5), (1.0, 0.0), (-3.0, 1.0), (7.0, 0.0)] {
            assert!((curve.value(x) - y).abs() < 1.0e-12, "{x}");
        }
        let table = curve.table(0.0, 1.0);
        assert_eq!((table.values[0], table.values[255], table.entries_per_unit), (1.0, 0.0, 255.0));
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        for points in [
            vec![[0.0, 1.0]],
            vec![[0.0, 1.0], [0.0, 2.0]],
            vec![[1.0, 1.0], [0.0, 2.0]],
            vec![[0.0, f64::NAN], [1.0, 2.0]],
            (0..65).map(|k| [f64::from(k), 0.0]).collect(),
        ] {
            let err = Curve::new("the transfer", points).unwrap_err().to_string();
            assert!(err.contains("the transfer"), "{err}");
        }
    }

    /// SciPy's `PchipInterpolator([0, .1, .5, .6, 1], [0, .8, .7, .7, 1])` at 0.05, 0.3, 0.55, 0.7, 0.9.
    #[test]
    fn agrees_with_scipy() {
        let points = vec![[0.0, 0.0], [0.1, 0.8], [0.5, 0.7], [0.6, 0.7], [1.0, 1.0]];
        let curve = Curve::new("a test", points).unwrap();
        for (x, expected) in PCHIP {
            assert!((curve.value(x) - expected).abs() < 1.0e-12, "{x}: {} {expected}", curve.value(x));
        }
    }

    const PCHIP: [(f64, f64); 5] = [
        (0.05, 0.5206250000000001),
        (0.3, 0.75),
        (0.55, 0.7),
        (0.7, 0.7215624999999999),
        (0.9, 0.8771875000000001),
    ];

    proptest! {
        #[test]
        fn between_two_points_it_stays_between_them(
            steps in prop::collection::vec((0.01_f64..1.0, -1.0_f64..1.0), 2..10), share in 0.0_f64..1.0,
        ) {
            let mut x = 0.0;
            let points: Vec<_> = steps.iter().map(|(step, y)| { x += step; [x, *y] }).collect();
            let curve = Curve::new("a test", points.clone()).unwrap();
            for pair in points.windows(2) {
                let value = curve.value(pair[0][0] + share * (pair[1][0] - pair[0][0]));
                let (low, high) = (pair[0][1].min(pair[1][1]), pair[0][1].max(pair[1][1]));
                prop_assert!((low - 1.0e-12..=high + 1.0e-12).contains(&value), "{} not in {}..{}", value, low, high);
            }
        }
    }
}
