//! The weights of a whole stroke, worked out for a rectangle at once.

use orogeny_field::{Falloff, Instance, Page, Plane, SampleRect};
use orogeny_reference::field::weights;
use rayon::prelude::*;

use super::working_page::chord;
use crate::filter::Weights;

/// Rows that a thread takes at once: the instances that reach them are looked up together.
const BAND_ROWS: usize = 16;

/// Works out a plane of weights; `gate` has the pages of what is let through.
pub(super) fn fill(plane: &mut Plane, weights: &Weights, gate: &[(SampleRect, Page)]) {
    let rect = plane.rect();
    let width = rect.width() as usize;
    // The one instance of a fill is the same everywhere.
    let is_fill = weights.instances.len() == 1 && weights.footprint.falloff == Falloff::HARD_EDGE;
    let bands = plane.samples_mut().par_chunks_mut((BAND_ROWS * width).max(1)).enumerate();
    bands.for_each(|(number, band)| {
        let z0 = rect.z0 + (number * BAND_ROWS) as i32;
        let rows = SampleRect { z0, z1: (z0 + BAND_ROWS as i32).min(rect.z1), ..rect };
        let reaching: Vec<(&Instance, SampleRect)> = (weights.instances.iter().zip(&weights.bounds))
            .map(|(instance, bound)| (instance, bound.intersection(&rows)))
            .filter(|(_, bound)| !bound.is_empty())
            .collect();
        for (z, row) in (z0..).zip(band.chunks_mut(width)) {
            row.fill(0.0);
            for (instance, bound) in reaching.iter().filter(|(_, bound)| (bound.z0..bound.z1).contains(&z)) {
                let (x0, x1) = chord(instance, bound, z);
                let part = row.get_mut(x0.abs_diff(rect.x0) as usize..x1.abs_diff(rect.x0) as usize);
                let part = part.unwrap_or_default();
                if is_fill && instance.inverse_radius == 0.0 {
                    part.fill(instance.amplitude);
                    continue;
                }
                weights::gather_row(part, x0, z, instance, &weights.footprint);
            }
            let_through(row, &SampleRect::new(rect.x0, z, rect.x1, z + 1), gate);
        }
    });
}

/// Multiplies a row of weights by what a gate lets through; without pages nothing is gated.
fn let_through(row: &mut [f32], row_rect: &SampleRect, gate: &[(SampleRect, Page)]) {
    for (page_rect, page) in gate {
        let both = page_rect.intersection(row_rect);
        if both.is_empty() {
            continue;
        }
        let (x0, x1) = (both.x0.abs_diff(page_rect.x0), both.x1.abs_diff(page_rect.x0));
        let first = both.x0.abs_diff(row_rect.x0) as usize;
        let part = row.get_mut(first..first + both.width() as usize);
        if let (Some(part), Some(gate)) = (part, page.row(both.z0.abs_diff(page_rect.z0), x0, x1)) {
            orogeny_reference::amounts::let_through(part, gate);
        }
    }
}
