//! The composite, or a part of it, row by row.

use std::cell::RefCell;

use orogeny_field::{LayerReference, PageKey, Plane, SampleRect};
use orogeny_store::{Layer, Store};

use super::content::row_part;
use super::node::{node, selection};
use super::{Compositor, Look, StorePages};
use crate::Result;
use crate::access::band_rows;

/// What is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    /// All visible layers.
    Composite,
    /// One layer alone, by its id: what it is made of.
    Layer(u32),
    /// How much a layer counts, by its id: its mask and that of its groups, 0..1.
    Mask(u32),
    /// What is selected, 0..1.
    Selection,
}

/// Columns that are worked out at once: of a wide terrain never a whole row of pages.
const BLOCK_COLUMNS: u32 = 4096;

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
    compositor: &'a RefCell<Compositor>,
    source: Source,
    level: u8,
    rect: SampleRect,
    next_z: i32,
    /// Rows up to `band_end`, from `band_start` in it on.
    band: Vec<f32>,
    band_start: i32,
    band_end: i32,
    max_band_rows: i32,
    pages: StorePages<'a>,
}

impl<'a> Composite<'a> {
    /// The rectangle lies within the terrain, in samples of the level. The band takes no more than `max_band_bytes`, but at
    /// least a row; where that is less than a row of pages, pages are decoded more than once.
    pub(crate) fn new(
        store: &'a Store,
        compositor: &'a RefCell<Compositor>,
        source: Source,
        level: u8,
        rect: SampleRect,
        max_band_bytes: u64,
    ) -> Self {
        Self {
            store,
            compositor,
            source,
            level,
            rect,
            next_z: rect.z0,
            band: Vec::new(),
            band_start: rect.z0,
            band_end: rect.z0,
            max_band_rows: band_rows(rect.width(), max_band_bytes),
            pages: StorePages::new(store),
        }
    }

    /// Shows a coarser level where a page is damaged, instead of failing.
    pub(crate) fn show_damage(mut self) -> Self {
        self.pages = StorePages::showing_damage(self.store);
        self
    }

    /// The damaged pages met so far.
    pub(crate) fn damaged(&self) -> &[PageKey] {
        &self.pages.damaged
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
        let (rect, width) = (self.rect, self.rect.width() as usize);
        self.band.resize(width * z1.abs_diff(z0) as usize, 0.0);
        let mut x0 = rect.x0;
        while x0 < rect.x1 {
            // Blocks end where pages do.
            let x1 =
                (x0.div_euclid(size) * size).saturating_add_unsigned(BLOCK_COLUMNS.max(size.unsigned_abs()));
            let block = SampleRect::new(x0, z0, x1.min(rect.x1), z1);
            let plane = self.load(block)?;
            let first = block.x0.abs_diff(rect.x0) as usize;
            for (z, row) in (z0..z1).zip(self.band.chunks_exact_mut(width)) {
                if let Some(to) = row.get_mut(first..first + block.width() as usize) {
                    to.copy_from_slice(row_part(&plane, z, block.x0, block.x1));
                }
            }
            x0 = block.x1;
        }
        (self.band_start, self.band_end) = (z0, z1);
        Ok(())
    }

    fn load(&mut self, rect: SampleRect) -> Result<Plane> {
        let mut look = Look::new(self.store.grid(), self.level, &mut self.pages)?;
        read(&mut self.compositor.borrow_mut(), self.store.layers(), &mut look, self.source, rect)
    }
}

/// A rectangle of the composite, or of a part of it, at the level that is looked at.
pub(crate) fn read(
    compositor: &mut Compositor,
    layers: &[Layer],
    look: &mut Look<'_>,
    source: Source,
    rect: SampleRect,
) -> Result<Plane> {
    let nodes = compositor.nodes(layers, look.pages)?;
    let id = match source {
        Source::Composite => return compositor.heights(look, &nodes, rect),
        Source::Selection => {
            let Some(field) = look.pages.selection()? else { return Ok(Plane::constant(rect, 0.0)) };
            return super::stored(look, &selection(field), rect);
        }
        Source::Layer(id) | Source::Mask(id) => id,
    };
    let layer = crate::terrain::find_layer(layers, Some(&LayerReference::Id(id)))?;
    // One that is hidden is read as if it were not, over what is below it.
    let place = |id: u32| layers.iter().position(|layer| layer.id == id);
    let num_below = nodes.iter().take_while(|node| place(node.id) < place(id)).count();
    let below = nodes.get(..num_below).unwrap_or_default();
    let node = node(layers, layer, look.pages)?;
    match source {
        Source::Mask(_) => compositor.layer_weights(look, below, &node.opaque(), rect),
        _ => compositor.layer_heights(look, below, &node, rect),
    }
}
