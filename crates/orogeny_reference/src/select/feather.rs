//! Soft edges: a Gaussian over both axes, each directly.

use orogeny_field::{Plane, SampleRect, gaussian_weights};

use crate::field::convolve;

/// Columns that are worked at once. Rows of so many samples do not fall onto the same few lines of a first-level cache.
const STRIP: i32 = 320;

/// How many samples away a value still counts.
#[must_use]
pub fn reach(sigma: f64) -> u32 {
    if sigma > 0.0 { gaussian_weights(sigma).len() as u32 } else { 0 }
}

/// A plane under a Gaussian of standard deviation `sigma` samples, 0 and more, cut at four of them. It is smaller by
/// [`reach`] on each side.
#[must_use]
pub fn feathered(plane: &Plane, sigma: f64) -> Plane {
    let weights = if sigma > 0.0 { gaussian_weights(sigma) } else { Vec::new() };
    let radius = weights.len() as i32;
    let rect = plane.rect();
    let mut target = Plane::constant(rect.grown(-radius), 0.0);
    let SampleRect { x0, z0, x1, z1 } = target.rect();
    let mut along_x = Plane::constant(SampleRect::EMPTY, 0.0);
    for first in (x0..x1).step_by(STRIP as usize) {
        let strip = SampleRect::new(first, rect.z0, x1.min(first + STRIP), rect.z1);
        let source_length = convolve::source_length(strip.width() as usize, weights.len(), 1);
        let from = (first - radius).abs_diff(rect.x0) as usize;
        along_x = along_x.reused(strip, 1);
        for z in rect.z0..rect.z1 {
            let source = plane.row(z).and_then(|row| row.get(from..from + source_length));
            if let (Some(source), Some(row)) = (source, along_x.row_mut(z)) {
                convolve::row_along_x(row, source, &weights, 1);
            }
        }
        let columns = first.abs_diff(x0) as usize..strip.x1.abs_diff(x0) as usize;
        for z in z0..z1 {
            let rows: Vec<_> = (z - radius..=z + radius).filter_map(|z| along_x.row(z)).collect();
            if let Some(row) = target.row_mut(z).and_then(|row| row.get_mut(columns.clone())) {
                convolve::row_along_z(row, &rows, &weights);
                // Rounding may leave the range by a unit in the last place.
                row.iter_mut().for_each(|value| *value = value.clamp(0.0, 1.0));
            }
        }
    }
    target
}
