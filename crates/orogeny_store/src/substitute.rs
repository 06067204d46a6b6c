//! What to show where a page is damaged: the last level that is whole there.

use std::sync::Arc;

use orogeny_field::{Page, PageKey};

use crate::{Error, Result, Store};

impl Store {
    /// A page as [`Self::load_page`] reads it, or, where that is damaged, as the finest whole level above it shows it. The
    /// level comes second: that of the page for a whole one.
    ///
    /// # Errors
    /// When the file cannot be read; damage is no error here unless no level is whole.
    pub fn load_page_or_coarser(&self, key: &PageKey) -> Result<(Option<Arc<Page>>, u8)> {
        let damage = match self.load_page(key) {
            Ok(page) => return Ok((page, key.level)),
            Err(err @ Error::DamagedPage { .. }) => err,
            Err(err) => return Err(err),
        };
        let mut above = key.parent();
        while above.level <= self.layout().top_level(&self.grid()) {
            match self.load_page(&above) {
                // It covers a page that is there, so it is there, or was lost.
                Ok(Some(page)) => {
                    return Ok((Some(Arc::new(self.stretched(key, &above, &page))), above.level));
                }
                Ok(None) | Err(Error::DamagedPage { .. }) => above = above.parent(),
                Err(err) => return Err(err),
            }
        }
        Err(damage)
    }

    /// The part of a coarser page that covers `key`, bilinear between its samples.
    fn stretched(&self, key: &PageKey, above: &PageKey, coarse: &Page) -> Page {
        let layout = self.layout();
        let steps = 1_i32 << (above.level - key.level).min(30);
        let (fine_rect, coarse_rect) = (layout.page_rect(key), layout.page_rect(above));
        let last = layout.size() - 1;
        let along = |place: i32, start: i32| {
            let first = place.div_euclid(steps).abs_diff(start).min(last);
            (first, (first + 1).min(last), place.rem_euclid(steps) as f32 / steps as f32)
        };
        let sample = |x: u32, z: u32| coarse.row(z, x, x + 1).and_then(|row| row.first().copied());
        let mut page = Page::constant(layout, self.stack.constant(key));
        for (row, z) in page.samples_mut().chunks_exact_mut(layout.size() as usize).zip(fine_rect.z0..) {
            let (north, south, share_z) = along(z, coarse_rect.z0);
            for (height_m, x) in row.iter_mut().zip(fine_rect.x0..) {
                let (west, east, share_x) = along(x, coarse_rect.x0);
                let across = |z: u32| {
                    let (west, east) = (sample(west, z)?, sample(east, z)?);
                    Some(west + share_x * (east - west))
                };
                if let (Some(north), Some(south)) = (across(north), across(south)) {
                    *height_m = north + share_z * (south - north);
                }
            }
        }
        page
    }
}
