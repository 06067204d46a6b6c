//! Samples where they lie, in pages or in a plane, read row by row, and layers joined over them.

use std::sync::Arc;

use orogeny_field::{Blend, Page, PageLayout, Plane, SampleRect};
use orogeny_reference::field::compose;
use orogeny_reference::field::compose::combine_row;
use rayon::prelude::*;

use super::content::row_part;

/// Rows that a thread takes at once.
const BAND_ROWS: usize = 32;

/// The samples of a rectangle.
pub(super) enum Samples {
    Plane(Plane),
    /// Pages, each with where it lies, and what is where none is.
    Pages {
        pages: Vec<(SampleRect, Arc<Page>)>,
        constant: f32,
    },
}

impl Samples {
    pub(super) const fn constant(constant: f32) -> Self {
        Self::Pages { pages: Vec::new(), constant }
    }

    /// Bytes of pages that are kept in memory by this.
    pub(super) fn size_in_bytes(&self) -> u64 {
        match self {
            Self::Plane(plane) => plane.size_in_bytes(),
            Self::Pages { pages, .. } => {
                pages.iter().map(|(_, page)| size_of_val(page.samples()) as u64).sum()
            }
        }
    }

    /// Samples `x0..x1` of a row; through the buffer where they do not lie side by side.
    fn row<'a>(&'a self, z: i32, x0: i32, x1: i32, buffer: &'a mut Vec<f32>) -> &'a [f32] {
        let (pages, constant) = match self {
            Self::Plane(plane) => return row_part(plane, z, x0, x1),
            Self::Pages { pages, constant } => (pages, *constant),
        };
        let of_row = pages.iter().filter(|(rect, _)| (rect.z0..rect.z1).contains(&z));
        let part = |rect: &SampleRect, page: &'a Page, x0: i32, x1: i32| {
            page.row(z.abs_diff(rect.z0), x0.abs_diff(rect.x0), x1.abs_diff(rect.x0)).unwrap_or_default()
        };
        if let Some((rect, page)) = of_row.clone().find(|(rect, _)| rect.x0 <= x0 && x1 <= rect.x1) {
            return part(rect, page, x0, x1);
        }
        buffer.clear();
        buffer.resize(x1.abs_diff(x0) as usize, constant);
        for (rect, page) in of_row {
            let (from, to) = (rect.x0.max(x0), rect.x1.min(x1));
            if from < to
                && let Some(buffer) = buffer.get_mut(from.abs_diff(x0) as usize..to.abs_diff(x0) as usize)
            {
                buffer.copy_from_slice(part(rect, page, from, to));
            }
        }
        buffer
    }

    /// Its memory, where that is a plane.
    pub(super) fn into_plane_there(self) -> Option<Plane> {
        if let Self::Plane(plane) = self { Some(plane) } else { None }
    }

    /// All of a rectangle, as a plane of it alone.
    pub(super) fn into_plane(self, layout: PageLayout, rect: SampleRect) -> Plane {
        match self {
            Self::Plane(plane) if plane.rect() == rect => plane,
            samples => joined(&samples, &[], layout, Plane::constant(rect, 0.0)),
        }
    }
}

/// How much a layer counts, sample by sample.
pub(super) enum Weights {
    /// Masks, multiplied, times the opacity.
    Masks { masks: Vec<Samples>, opacity: f32 },
    /// All of it worked out.
    Plane(Plane),
}

/// A layer that is joined to what is below it.
pub(super) struct Part {
    pub(super) heights: Samples,
    pub(super) weights: Weights,
    pub(super) blend: Blend,
}

impl Part {
    pub(super) fn size_in_bytes(&self) -> u64 {
        let of_weights = match &self.weights {
            Weights::Masks { masks, .. } => masks.iter().map(Samples::size_in_bytes).sum(),
            Weights::Plane(plane) => plane.size_in_bytes(),
        };
        self.heights.size_in_bytes() + of_weights
    }

    /// The memory of its planes.
    pub(super) fn into_planes(self) -> impl Iterator<Item = Plane> {
        let weights = if let Weights::Plane(plane) = self.weights { Some(plane) } else { None };
        self.heights.into_plane_there().into_iter().chain(weights)
    }

    /// Joins a row to what is below it.
    fn join(&self, below: &mut [f32], [x, z]: [i32; 2], buffers: &mut [Vec<f32>; 3]) {
        let [heights, weights, masks] = buffers;
        let end = x + below.len() as i32;
        let heights = self.heights.row(z, x, end, heights);
        let weights = match &self.weights {
            Weights::Plane(plane) => row_part(plane, z, x, end),
            Weights::Masks { masks: of, opacity } => {
                weights.clear();
                match of.split_first() {
                    None => weights.resize(below.len(), *opacity),
                    Some((first, others)) => {
                        weights.extend_from_slice(first.row(z, x, end, masks));
                        for mask in others {
                            let mask = mask.row(z, x, end, masks);
                            combine_row(weights, mask, orogeny_field::MaskCombine::Multiply);
                        }
                        if *opacity != 1.0 {
                            weights.iter_mut().for_each(|weight| *weight *= opacity);
                        }
                    }
                }
                weights
            }
        };
        compose::row(below, heights, weights, self.blend);
    }
}

/// Layers joined, from the lowest, to what is below them, over the rectangle of a plane, whatever it holds.
///
/// Page by page, row by row, layer by layer: so a row of a layer is one piece of memory, and only one page of each is read at a time.
pub(super) fn joined(below: &Samples, parts: &[Part], layout: PageLayout, mut plane: Plane) -> Plane {
    let (rect, side) = (plane.rect(), layout.size().cast_signed());
    let width = rect.width().max(1) as usize;
    let bands = plane.samples_mut().par_chunks_mut(width * BAND_ROWS).enumerate();
    bands.for_each_init(
        || [const { Vec::new() }; 3],
        |buffers, (number, band)| {
            let first_z = rect.z0 + (number * BAND_ROWS) as i32;
            let mut x = rect.x0;
            while x < rect.x1 {
                let end = (x.div_euclid(side) * side).saturating_add(side).min(rect.x1);
                let columns = x.abs_diff(rect.x0) as usize..end.abs_diff(rect.x0) as usize;
                for (z, row) in (first_z..).zip(band.chunks_mut(width)) {
                    let Some(row) = row.get_mut(columns.clone()) else { continue };
                    let [buffer, ..] = buffers;
                    let below = below.row(z, x, end, buffer);
                    if below.len() == row.len() {
                        row.copy_from_slice(below);
                    }
                    for part in parts {
                        part.join(row, [x, z], buffers);
                    }
                }
                x = end;
            }
        },
    );
    plane
}
