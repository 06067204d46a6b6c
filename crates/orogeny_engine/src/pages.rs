//! The pages of a running operation, as an executor sees them.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use orogeny_field::{FieldId, Page, PageKey, PageLayout};
use orogeny_pages::{BoxError, PageStore};
use orogeny_store::{Recording, Store};

use crate::seen::{SEEN, Seen};

/// Pages of a recording, with a note of those that were changed.
pub(crate) struct RecordedPages<'a, 'recorder> {
    recording: &'a mut Recording<'recorder>,
    layout: PageLayout,
    constants: HashMap<FieldId, f32>,
    saved: BTreeSet<PageKey>,
    /// The terrain as it is seen, where that is looked at.
    seen: Option<Seen<'a>>,
}

impl<'a, 'recorder> RecordedPages<'a, 'recorder> {
    pub(crate) fn new(recording: &'a mut Recording<'recorder>, layout: PageLayout) -> Self {
        let heights = recording.layers().iter().map(|layer| (layer.heights, layer.constant_m));
        let masks = recording.layers().iter().filter_map(|layer| Some((layer.mask?, layer.mask_constant)));
        // What is in neither is the selection: nothing.
        let constants = heights.chain(masks).collect();
        Self { recording, layout, constants, saved: BTreeSet::new(), seen: None }
    }

    /// With the terrain as it is seen, as a field of its own.
    pub(crate) fn with_seen(self, seen: Option<Seen<'a>>) -> Self {
        Self { seen, ..self }
    }

    /// What they are pages of.
    pub(crate) const fn recording(&mut self) -> &mut Recording<'recorder> {
        self.recording
    }

    /// The pages that were saved, and those of what is seen that were asked for.
    pub(crate) fn into_saved(self) -> (Vec<PageKey>, Vec<PageKey>) {
        (self.saved.into_iter().collect(), self.seen.map(Seen::into_asked_for).unwrap_or_default())
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
        if let Some(seen) = self.seen.as_mut().filter(|_| key.field == SEEN) {
            return Ok(Some(seen.load(key, self.recording)?));
        }
        Ok(self.recording.load_page(key)?.map(Arc::unwrap_or_clone))
    }

    fn load_before(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        if let Some(seen) = self.seen.as_mut().filter(|_| key.field == SEEN) {
            return Ok(Some(seen.load_before(key, self.recording)?));
        }
        Ok(self.recording.load_page_before(key)?.map(Arc::unwrap_or_clone))
    }

    fn save(&mut self, pages: Vec<(PageKey, Page)>) -> Result<(), BoxError> {
        let (of_seen, mut pages): (Vec<_>, Vec<_>) =
            pages.into_iter().partition(|(key, _)| key.field == SEEN);
        if let Some(seen) = self.seen.as_mut().filter(|_| !of_seen.is_empty()) {
            pages.extend(seen.save(of_seen, self.recording)?);
        }
        self.saved.extend(pages.iter().map(|(key, _)| *key));
        Ok(self.recording.write_pages(pages)?)
    }
}

/// Pages of what is on disk, to be looked at.
pub(crate) struct SettledPages<'a>(pub(crate) &'a Store);

impl PageStore for SettledPages<'_> {
    fn layout(&self) -> PageLayout {
        self.0.layout()
    }

    fn constant(&self, field: FieldId) -> f32 {
        self.0.fields().get(&field).map_or(0.0, |field| field.constant)
    }

    fn load(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        Ok(self.0.load_page(key)?.map(Arc::unwrap_or_clone))
    }

    fn load_before(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        self.load(key)
    }

    fn save(&mut self, pages: Vec<(PageKey, Page)>) -> Result<(), BoxError> {
        // No operation is under way that could have changed any.
        Err(format!("{} pages were changed that were only looked at", pages.len()).into())
    }
}
