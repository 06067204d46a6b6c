//! The composite: what the layer stack comes to, read row by row.
//!
//! Layers are added to those below, each with its opacity. The lowest visible one is taken as it is, so that a terrain of one
//! layer reads bit for bit as it was painted. A coarser level is the stack of the layers' own coarser levels.

use std::sync::Arc;

use orogeny_field::{Page, PageKey, SampleRect};
use orogeny_store::{Layer, Store};

use crate::Result;
use crate::access::{PAGES_AT_ONCE, band_rows};

/// What is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    /// All visible layers.
    Composite,
    /// One layer alone, by its id.
    Layer(u32),
}

/// What is said of a damaged page that a picture has to do without.
pub(crate) fn damage_notice(key: &PageKey) -> String {
    let PageKey { level, x, z, .. } = key;
    format!(
        "the page at column {x} row {z} of level {level} is damaged; a coarser level is shown, or the bare ground"
    )
}

/// A rectangle of heights of one level on its way out, a band of rows in memory at a time.
pub(crate) struct Composite<'a> {
    store: &'a Store,
    layers: Vec<&'a Layer>,
    level: u8,
    rect: SampleRect,
    next_z: i32,
    /// Rows `next_z..band_end`, from `band_start` in it on.
    band: Vec<f32>,
    band_start: i32,
    band_end: i32,
    max_band_rows: i32,
    shows_damage: bool,
    /// Damaged pages of which a coarser level was shown.
    damaged: Vec<PageKey>,
}

impl<'a> Composite<'a> {
    /// The rectangle lies within the terrain, in samples of the level. The band takes no more than `max_band_bytes`, but at
    /// least a row; where that is less than a row of pages, pages are decoded more than once.
    pub(crate) fn new(
        store: &'a Store,
        source: Source,
        level: u8,
        rect: SampleRect,
        max_band_bytes: u64,
    ) -> Self {
        let is_read = |layer: &&Layer| match source {
            Source::Composite => layer.visible,
            Source::Layer(id) => layer.id == id,
        };
        let layers = store.layers().iter().filter(is_read).collect();
        Self {
            store,
            layers,
            level,
            rect,
            next_z: rect.z0,
            band: Vec::new(),
            band_start: rect.z0,
            band_end: rect.z0,
            max_band_rows: band_rows(rect.width(), max_band_bytes),
            shows_damage: false,
            damaged: Vec::new(),
        }
    }

    /// Shows a coarser level where a page is damaged, instead of failing.
    pub(crate) const fn show_damage(mut self) -> Self {
        self.shows_damage = true;
        self
    }

    /// The damaged pages met so far.
    pub(crate) fn damaged(&self) -> &[PageKey] {
        &self.damaged
    }

    /// Reads the next rows, as many as fit into `rows`, and returns how many; 0 at the end.
    pub(crate) fn read_rows(&mut self, rows: &mut [f32]) -> Result<usize> {
        let width = (self.rect.width() as usize).max(1);
        let mut num_rows = 0;
        for row in rows.chunks_exact_mut(width) {
            if self.next_z >= self.rect.z1 {
                break;
            }
            if self.next_z >= self.band_end {
                self.load_band()?;
            }
            let start = self.next_z.abs_diff(self.band_start) as usize * width;
            if let Some(from) = self.band.get(start..start + width) {
                row.copy_from_slice(from);
            }
            self.next_z += 1;
            num_rows += 1;
        }
        Ok(num_rows)
    }

    /// Reads the rows from `next_z` on, to the end of the row of pages or as many as fit.
    fn load_band(&mut self) -> Result<()> {
        let size = self.store.layout().size().cast_signed();
        let z0 = self.next_z;
        let page_end = (z0.div_euclid(size) + 1) * size;
        let z1 = page_end.min(self.rect.z1).min(z0.saturating_add(self.max_band_rows));
        let band = SampleRect::new(self.rect.x0, z0, self.rect.x1, z1);
        self.band.resize(usize::try_from(band.area()).unwrap_or_default(), 0.0);
        self.band.fill(0.0);
        for (place, layer) in self.layers.clone().into_iter().enumerate() {
            let keys: Vec<_> = self
                .store
                .layout()
                .pages_in(band)
                .map(|(x, z)| PageKey { field: layer.heights, level: self.level, z, x })
                .collect();
            for keys in keys.chunks(PAGES_AT_ONCE) {
                for (key, page) in keys.iter().zip(self.store.load_pages(keys)?) {
                    let page = match page {
                        Err(_) if self.shows_damage => {
                            self.damaged.push(*key);
                            // Where no level is whole, what is left is the ground before painting.
                            self.store.load_page_or_coarser(key).map_or(None, |(page, _)| page)
                        }
                        page => page?,
                    };
                    self.add(place, layer, key, page.as_ref(), &band);
                }
            }
        }
        (self.band_start, self.band_end) = (z0, z1);
        Ok(())
    }

    /// Adds a layer's page to the band.
    fn add(
        &mut self,
        place: usize,
        layer: &Layer,
        key: &PageKey,
        page: Option<&Arc<Page>>,
        band: &SampleRect,
    ) {
        let page_rect = self.store.layout().page_rect(key);
        let part = page_rect.intersection(band);
        let width = band.width() as usize;
        for z in part.z0..part.z1 {
            let start = z.abs_diff(band.z0) as usize * width + part.x0.abs_diff(band.x0) as usize;
            let Some(row) = self.band.get_mut(start..start + part.width() as usize) else { continue };
            let columns = (part.x0.abs_diff(page_rect.x0), part.x1.abs_diff(page_rect.x0));
            let samples = page.and_then(|page| page.row(z.abs_diff(page_rect.z0), columns.0, columns.1));
            let height_m = |k: usize| samples.and_then(|s| s.get(k)).copied().unwrap_or(layer.constant_m);
            for (k, height) in row.iter_mut().enumerate() {
                *height = if place == 0 { height_m(k) } else { *height + layer.opacity * height_m(k) };
            }
        }
    }
}
