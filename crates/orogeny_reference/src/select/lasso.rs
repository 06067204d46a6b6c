//! Polygons, row by row, by the even-odd rule: a sample is inside where as many edges pass on both sides of it, an odd number.
//!
//! As of a rectangle, what lies on a near edge is inside and what lies on a far one is not, so that a polygon around a rectangle has
//! its samples, and polygons side by side share none.

use std::ops::Range;

use orogeny_field::{Plane, SampleRect};

use super::ON_A_SAMPLE;

/// A closed polygon on a grid of samples.
#[derive(Debug, Clone)]
pub struct Lasso {
    /// By their first rows.
    edges: Vec<Edge>,
    bounds: SampleRect,
}

/// An edge that passes at least one row.
#[derive(Debug, Clone)]
struct Edge {
    rows: Range<i32>,
    /// Its northern end, `[x, z]` in samples.
    north: [f64; 2],
    south: [f64; 2],
}

impl Lasso {
    /// A polygon through points `[x, z]` in samples, finite, within ±2^30; it goes on from the last to the first.
    #[must_use]
    pub fn new(points: &[[f64; 2]]) -> Self {
        let next = points.iter().cycle().skip(1);
        let mut edges: Vec<_> =
            points.iter().zip(next).filter_map(|(from, to)| Edge::new(*from, *to)).collect();
        edges.sort_unstable_by_key(|edge| edge.rows.start);
        let along = |axis: fn(&[f64; 2]) -> f64| {
            let places = || points.iter().map(axis);
            (first(places().fold(f64::MAX, f64::min)), first(places().fold(f64::MIN, f64::max)))
        };
        let ((x0, x1), (z0, z1)) = (along(|[x, _]| *x), along(|[_, z]| *z));
        Self { edges, bounds: SampleRect::new(x0, z0, x1, z1) }
    }

    /// A rectangle with all samples inside; empty where there are none.
    #[must_use]
    pub const fn bounds(&self) -> SampleRect {
        self.bounds
    }

    /// Makes the samples inside 1, and leaves all others as they are.
    pub fn fill(&self, plane: &mut Plane) {
        let rect = plane.rect();
        let num_begun = self.edges.partition_point(|edge| edge.rows.start < rect.z0);
        let (begun, mut to_come) = self.edges.split_at(num_begun);
        let mut passing: Vec<&Edge> = begun.iter().collect();
        let mut columns = Vec::new();
        for z in rect.z0..rect.z1.min(self.bounds.z1) {
            let num_begun = to_come.partition_point(|edge| edge.rows.start <= z);
            let (begun, rest) = to_come.split_at(num_begun);
            passing.extend(begun);
            to_come = rest;
            passing.retain(|edge| edge.rows.contains(&z));
            columns.clear();
            columns.extend(passing.iter().map(|edge| first(edge.x_at(z))));
            columns.sort_unstable();
            let Some(row) = plane.row_mut(z) else { continue };
            for pair in columns.chunks_exact(2) {
                let &[from, to] = pair else { continue };
                let (from, to) = (from.clamp(rect.x0, rect.x1), to.clamp(rect.x0, rect.x1));
                let within = from.abs_diff(rect.x0) as usize..to.abs_diff(rect.x0) as usize;
                if let Some(samples) = row.get_mut(within) {
                    samples.fill(1.0);
                }
            }
        }
    }
}

impl Edge {
    fn new(from: [f64; 2], to: [f64; 2]) -> Option<Self> {
        let ([_, from_z], [_, to_z]) = (from, to);
        // The same edge walked either way passes at the same places.
        let (north, south) = if from_z <= to_z { (from, to) } else { (to, from) };
        let rows = first(from_z.min(to_z))..first(from_z.max(to_z));
        (!rows.is_empty()).then_some(Self { rows, north, south })
    }

    /// Where it passes a row.
    fn x_at(&self, z: i32) -> f64 {
        let ([north_x, north_z], [south_x, south_z]) = (self.north, self.south);
        let share = ((f64::from(z) - north_z) / (south_z - north_z)).clamp(0.0, 1.0);
        north_x + share * (south_x - north_x)
    }
}

/// The first sample on a place or after it.
fn first(place: f64) -> i32 {
    (place - ON_A_SAMPLE).ceil() as i32
}
