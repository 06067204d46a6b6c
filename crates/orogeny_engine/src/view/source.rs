//! The composite as the renderer asks for it: pages, and what is known of them without reading them.

use std::cell::RefCell;
use std::collections::HashMap;

use orogeny_field::{FieldId, HeightBounds, Page, PageKey, PageLayout};
use orogeny_geomip::{PagePlace, PageSummaries, PageSummary};
use orogeny_store::{Layer, Store};

use crate::Result;
use crate::composite::{Composite, Source};

/// A store's composite.
pub(super) struct CompositeSource<'a> {
    store: &'a Store,
    layers: Vec<&'a Layer>,
    known: RefCell<HashMap<PagePlace, PageSummary>>,
}

fn key(layer: &Layer, PagePlace { level, z, x }: PagePlace) -> PageKey {
    PageKey { field: layer.heights, level, z, x }
}

impl<'a> CompositeSource<'a> {
    pub(super) fn new(store: &'a Store) -> Self {
        let layers = store.layers().iter().filter(|layer| layer.visible).collect();
        Self { store, layers, known: RefCell::default() }
    }

    pub(super) fn layout(&self) -> PageLayout {
        self.store.layout()
    }

    /// A page of the composite; where one is damaged, of what is left of it.
    pub(super) fn page(&self, place: PagePlace) -> Result<Page> {
        let layout = self.store.layout();
        let page_key = PageKey { field: FieldId(0), level: place.level, z: place.z, x: place.x };
        let page_rect = layout.page_rect(&page_key);
        let rect = page_rect.intersection(&self.store.grid().bounds_at(place.level));
        let mut page = Page::constant(layout, 0.0);
        let mut rows =
            Composite::new(self.store, Source::Composite, place.level, rect, layout.size_in_bytes())
                .show_damage();
        for z in 0..rect.depth() {
            if let Some(row) = page.row_mut(z, 0, rect.width()) {
                rows.read_rows(row)?;
            }
        }
        Ok(page)
    }

    /// From the directory. A page of which that cannot be read counts as constant: the picture then lacks it, and reading it tells why.
    fn read_summary(&self, place: PagePlace) -> PageSummary {
        let mut bounds = HeightBounds::of(0.0);
        let (mut error_m, mut is_constant) = (0.0, true);
        for (index, layer) in self.layers.iter().enumerate() {
            let found = self.store.page_surface(&key(layer, place)).ok().flatten();
            is_constant &= found.is_none();
            let (of_layer, of_layer_error_m) = found.unwrap_or((HeightBounds::of(layer.constant_m), 0.0));
            // As the composite is: the lowest as it is, the others each by their opacity.
            let opacity = if index == 0 { 1.0 } else { layer.opacity };
            bounds.min_m += opacity * of_layer.min_m;
            bounds.max_m += opacity * of_layer.max_m;
            error_m += opacity * of_layer_error_m;
        }
        PageSummary { bounds, error_m, is_constant }
    }
}

impl PageSummaries for CompositeSource<'_> {
    fn summary(&self, place: PagePlace) -> PageSummary {
        *self.known.borrow_mut().entry(place).or_insert_with(|| self.read_summary(place))
    }
}
