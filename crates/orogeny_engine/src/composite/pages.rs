//! Where the stored pages of layers and masks come from.

use std::sync::Arc;

use orogeny_field::{FieldId, Page, PageKey, PageLayout};
use orogeny_store::{BlobHash, FieldKind, Recorder, Recording, Store};

use crate::Result;

/// The stored pages of a terrain, at all levels.
pub(crate) trait FieldPages {
    /// How planes are cut.
    fn layout(&self) -> PageLayout;

    /// The field of the terrain's selection, where there is one.
    fn selection(&mut self) -> Result<Option<FieldId>>;

    /// Pages, each `None` where the field holds its constant.
    fn load(&mut self, keys: &[PageKey]) -> Result<Vec<Option<Arc<Page>>>>;

    /// Data from outside that a layer is made of.
    fn blob(&mut self, hash: BlobHash) -> Result<Vec<u8>>;
}

/// What is on disk.
pub(crate) struct StorePages<'a> {
    store: &'a Store,
    shows_damage: bool,
    /// Damaged pages of which a coarser level was shown.
    pub(crate) damaged: Vec<PageKey>,
}

impl<'a> StorePages<'a> {
    /// Fails where a page is damaged.
    pub(crate) const fn new(store: &'a Store) -> Self {
        Self { store, shows_damage: false, damaged: Vec::new() }
    }

    /// Shows a coarser level there instead.
    pub(crate) const fn showing_damage(store: &'a Store) -> Self {
        Self { store, shows_damage: true, damaged: Vec::new() }
    }
}

impl FieldPages for StorePages<'_> {
    fn layout(&self) -> PageLayout {
        self.store.layout()
    }

    fn selection(&mut self) -> Result<Option<FieldId>> {
        let mut fields = self.store.fields().iter();
        Ok(fields.find(|(_, field)| field.kind == FieldKind::Selection).map(|(id, _)| *id))
    }

    fn load(&mut self, keys: &[PageKey]) -> Result<Vec<Option<Arc<Page>>>> {
        let mut pages = Vec::with_capacity(keys.len());
        for (key, page) in keys.iter().zip(self.store.load_pages(keys)?) {
            pages.push(match page {
                Err(_) if self.shows_damage => {
                    self.damaged.push(*key);
                    // Where no level is whole, what is left is the ground before painting.
                    self.store.load_page_or_coarser(key).map_or(None, |(page, _)| page)
                }
                page => page?,
            });
        }
        Ok(pages)
    }

    fn blob(&mut self, hash: BlobHash) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.store.read_blob(&hash, &mut bytes)?;
        Ok(bytes)
    }
}

/// What was painted last, whether it is on disk yet or still on its way; of full resolution only.
pub(crate) struct RecorderPages<'a>(pub(crate) &'a Recorder);

impl FieldPages for RecorderPages<'_> {
    fn layout(&self) -> PageLayout {
        self.0.on_disk().map(Store::layout).unwrap_or_default()
    }

    fn selection(&mut self) -> Result<Option<FieldId>> {
        StorePages::new(self.0.on_disk()?).selection()
    }

    fn load(&mut self, keys: &[PageKey]) -> Result<Vec<Option<Arc<Page>>>> {
        self.0.load_pages(keys)?.into_iter().map(|page| Ok(page?)).collect()
    }

    fn blob(&mut self, hash: BlobHash) -> Result<Vec<u8>> {
        StorePages::new(self.0.on_disk()?).blob(hash)
    }
}

/// What an operation left so far. Coarser levels, which are else made when it ends, are made when they are asked for.
pub(crate) struct RecordingPages<'a, 'recorder> {
    recording: &'a mut Recording<'recorder>,
    layout: PageLayout,
    is_before: bool,
}

impl<'a, 'recorder> RecordingPages<'a, 'recorder> {
    pub(crate) fn new(recording: &'a mut Recording<'recorder>) -> Result<Self> {
        let layout = recording.layout()?;
        Ok(Self { recording, layout, is_before: false })
    }

    /// Pages as they were before the running operation.
    pub(crate) fn before(recording: &'a mut Recording<'recorder>) -> Result<Self> {
        Ok(Self { is_before: true, ..Self::new(recording)? })
    }
}

impl FieldPages for RecordingPages<'_, '_> {
    fn layout(&self) -> PageLayout {
        self.layout
    }

    fn selection(&mut self) -> Result<Option<FieldId>> {
        Ok(self.recording.known_selection()?)
    }

    fn load(&mut self, keys: &[PageKey]) -> Result<Vec<Option<Arc<Page>>>> {
        let mut load = |key: &PageKey| match (key.level, self.is_before) {
            (0, true) => self.recording.load_page_before(key),
            (0, false) => self.recording.load_page(key),
            _ => self.recording.load_coarse_page(key),
        };
        keys.iter().map(|key| Ok(load(key)?)).collect()
    }

    fn blob(&mut self, hash: BlobHash) -> Result<Vec<u8>> {
        Ok(self.recording.with_transaction(move |transaction| {
            let mut bytes = Vec::new();
            transaction.read_blob(&hash, &mut bytes)?;
            Ok(bytes)
        })?)
    }
}
