//! Single heights from before an operation, which planning asks for: the ground under a stroke's first point, or under each
//! instance of a ledge.

use std::num::NonZeroUsize;

use lru::LruCache;
use orogeny_field::{FieldId, Page, PageKey, TerrainGrid};

use crate::{Error, PageStore, Result};

/// Pages kept by a probe: a place reads at most four, and the next place lies near.
const NUM_KEPT_PAGES: NonZeroUsize = NonZeroUsize::new(8).unwrap();

/// Reads heights of one field as they were before the operation, keeping the last few pages that it met.
#[derive(Debug)]
pub struct HeightProbe {
    grid: TerrainGrid,
    field: FieldId,
    kept: LruCache<PageKey, Option<Page>>,
}

impl HeightProbe {
    /// A probe into one field.
    #[must_use]
    pub fn new(grid: TerrainGrid, field: FieldId) -> Self {
        Self { grid, field, kept: LruCache::new(NUM_KEPT_PAGES) }
    }

    /// The bilinear height in metres at a place in samples, which is clamped to the terrain.
    ///
    /// # Errors
    /// [`Error::Source`] when a page cannot be read.
    pub fn height_m(&mut self, store: &mut dyn PageStore, [x, z]: [f64; 2]) -> Result<f32> {
        let along = |place: f64, num_samples: u32| {
            let place = place.clamp(0.0, f64::from(num_samples - 1));
            let first = place.floor();
            ([first as u32, (first as u32 + 1).min(num_samples - 1)], place - first)
        };
        let (columns, share_x) = along(x, self.grid.width());
        let (rows, share_z) = along(z, self.grid.depth());
        let mut row_heights = [0.0; 2];
        for (row_height, row) in row_heights.iter_mut().zip(rows) {
            let mut ends = [0.0; 2];
            for (end, column) in ends.iter_mut().zip(columns) {
                *end = f64::from(self.sample_m(store, column, row)?);
            }
            let [west, east] = ends;
            *row_height = west + share_x * (east - west);
        }
        let [north, south] = row_heights;
        Ok((north + share_z * (south - north)) as f32)
    }

    fn sample_m(&mut self, store: &mut dyn PageStore, x: u32, z: u32) -> Result<f32> {
        let size = store.layout().size();
        let key = PageKey::full_resolution(self.field, x / size, z / size);
        let page = self.kept.try_get_or_insert(key, || store.load_before(&key)).map_err(Error::Source)?;
        let height_m =
            page.as_ref().and_then(|page| page.row(z % size, x % size, x % size + 1)?.first().copied());
        Ok(height_m.unwrap_or_else(|| store.constant(self.field)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MemoryPages;
    use orogeny_field::PageLayout;

    #[test]
    fn a_plane_is_read_exactly_across_page_borders_and_clamped_outside() {
        let layout = PageLayout::new(64).unwrap();
        let grid = TerrainGrid::new(100, 70, 2.0).unwrap();
        let mut store = MemoryPages::new(layout, 0.0);
        let mut pages = Vec::new();
        for (x, z) in layout.pages_in(grid.bounds()) {
            let key = PageKey::full_resolution(FieldId(3), x, z);
            let origin = layout.page_rect(&key);
            let heights =
                (0..64 * 64).map(|k| ((origin.x0 + k % 64) * 10 + (origin.z0 + k / 64)) as f32).collect();
            pages.push((key, Page::from_samples(layout, heights).unwrap()));
        }
        store.save(pages).unwrap();
        store.commit();
        let mut probe = HeightProbe::new(grid, FieldId(3));
        for ([x, z], expected) in [
            ([0.0, 0.0], 0.0),
            ([63.5, 63.25], 698.25),
            ([98.75, 68.5], 1056.0),
            ([99.0, 69.0], 1059.0),
            ([500.0, 500.0], 1059.0),
            ([-5.0, 10.5], 10.5),
        ] {
            assert_eq!(probe.height_m(&mut store, [x, z]).unwrap(), expected, "{x}, {z}");
        }
    }
}
