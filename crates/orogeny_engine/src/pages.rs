//! The pages of a running operation, as an executor sees them.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use orogeny_field::{FieldId, Page, PageKey, PageLayout};
use orogeny_pages::{BoxError, PageStore};
use orogeny_store::Recording;

/// Pages of a recording, with a note of those that were changed.
pub(crate) struct RecordedPages<'a, 'recorder> {
    recording: &'a mut Recording<'recorder>,
    layout: PageLayout,
    constants: HashMap<FieldId, f32>,
    saved: BTreeSet<PageKey>,
}

impl<'a, 'recorder> RecordedPages<'a, 'recorder> {
    pub(crate) fn new(recording: &'a mut Recording<'recorder>, layout: PageLayout) -> Self {
        let heights = recording.layers().iter().map(|layer| (layer.heights, layer.constant_m));
        let masks = recording.layers().iter().filter_map(|layer| Some((layer.mask?, layer.mask_constant)));
        // What is in neither is the selection: nothing.
        let constants = heights.chain(masks).collect();
        Self { recording, layout, constants, saved: BTreeSet::new() }
    }

    /// The pages that were saved.
    pub(crate) fn into_saved(self) -> Vec<PageKey> {
        self.saved.into_iter().collect()
    }
}

impl PageStore for RecordedPages<'_, '_> {
    fn layout(&self) -> PageLayout {
        self.layout
    }

    fn constant(&self, field: FieldId) -> f32 {
        self.constants.get(&field).copied().unwrap_or_default()
    }

    fn load(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        Ok(self.recording.load_page(key)?.map(Arc::unwrap_or_clone))
    }

    fn load_before(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        Ok(self.recording.load_page_before(key)?.map(Arc::unwrap_or_clone))
    }

    fn save(&mut self, pages: Vec<(PageKey, Page)>) -> Result<(), BoxError> {
        self.saved.extend(pages.iter().map(|(key, _)| *key));
        Ok(self.recording.write_pages(pages)?)
    }
}
