//! The composite: what the layer stack comes to, read row by row.
//!
//! Layers are added to those below, each with its opacity. The lowest visible one is taken as it is, so that a terrain of one
//! layer reads bit for bit as it was painted.

use orogeny_field::{Page, PageKey, PageLayout, SampleRect};
use orogeny_store::{Layer, Store};

use crate::Result;

/// What is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    /// All visible layers.
    Composite,
    /// One layer alone, by its id.
    Layer(u32),
}

/// A rectangle of heights on its way out, one row of pages in memory at a time.
pub(crate) struct Composite<'a> {
    store: &'a Store,
    layers: Vec<&'a Layer>,
    rect: SampleRect,
    next_z: i32,
    /// The pages that the rows being read cross, layer by layer; `None` where a page is absent.
    pages: Vec<Vec<Option<Page>>>,
    pages_z: Option<u32>,
}

impl<'a> Composite<'a> {
    /// The rectangle lies within the terrain.
    pub(crate) fn new(store: &'a Store, source: Source, rect: SampleRect) -> Self {
        let is_read = |layer: &&Layer| match source {
            Source::Composite => layer.visible,
            Source::Layer(id) => layer.id == id,
        };
        let layers = store.layers().iter().filter(is_read).collect();
        Self { store, layers, rect, next_z: rect.z0, pages: Vec::new(), pages_z: None }
    }

    /// Reads the next rows, as many as fit into `rows`, and returns how many; 0 at the end.
    pub(crate) fn read_rows(&mut self, rows: &mut [f32]) -> Result<usize> {
        let mut num_rows = 0;
        for row in rows.chunks_exact_mut((self.rect.width() as usize).max(1)) {
            if self.next_z >= self.rect.z1 {
                break;
            }
            self.read_row(row)?;
            self.next_z += 1;
            num_rows += 1;
        }
        Ok(num_rows)
    }

    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        let layout = self.store.layout();
        let z = self.next_z.unsigned_abs();
        if self.pages_z != Some(z / layout.size()) {
            self.load_pages(layout, z / layout.size())?;
        }
        row.fill(0.0);
        for (place, (layer, pages)) in self.layers.iter().zip(&self.pages).enumerate() {
            let mut x = self.rect.x0.unsigned_abs();
            let mut rest = &mut *row;
            for page in pages {
                let local_x = x % layout.size();
                let length = (layout.size() - local_x).min(rest.len() as u32);
                let (part, after) = std::mem::take(&mut rest).split_at_mut(length as usize);
                let samples =
                    page.as_ref().and_then(|page| page.row(z % layout.size(), local_x, local_x + length));
                let height_m = |k: usize| samples.and_then(|s| s.get(k)).copied().unwrap_or(layer.constant_m);
                for (k, height) in part.iter_mut().enumerate() {
                    *height = if place == 0 { height_m(k) } else { *height + layer.opacity * height_m(k) };
                }
                rest = after;
                x += length;
            }
        }
        Ok(())
    }

    fn load_pages(&mut self, layout: PageLayout, pages_z: u32) -> Result<()> {
        let columns: Vec<_> = layout
            .pages_in(SampleRect::new(self.rect.x0, self.next_z, self.rect.x1, self.next_z + 1))
            .map(|(x, _)| x)
            .collect();
        self.pages.clear();
        for layer in &self.layers {
            let load = |x: &u32| self.store.load_page(&PageKey::full_resolution(layer.heights, *x, pages_z));
            self.pages.push(columns.iter().map(load).collect::<Result<_, _>>()?);
        }
        self.pages_z = Some(pages_z);
        Ok(())
    }
}
