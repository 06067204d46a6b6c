//! One operation on a terrain: pages, layers and the history entry become durable together, or not at all.

use std::collections::HashSet;
use std::sync::Arc;

use orogeny_field::{MAX_HEIGHT_M, Page, PageKey, PageLayout, SampleRect, is_storable_height};
use rayon::prelude::*;

use crate::cache::Content;
use crate::database::Database;
use crate::error::unix_ms;
use crate::pyramid::{self, Changed};
use crate::rows::{DeltaRow, Document, EntryRow, LayerChange, PageInfo, PageRow};
use crate::stack::Stack;
use crate::{Dropped, EntryId, Error, Field, FieldKind, Layer, NewLayer, Result, Store};
use crate::{budget, codec, content};

/// The longest operation that the history records, in bytes of JSON: a stroke of a million points takes about 30 MB.
pub const MAX_OPERATION_BYTES: usize = 256 << 20;

/// Changes that are not there for anyone else until [`commit`](Self::commit); dropping it takes them back.
///
/// Pages go to the file as they are written, so that an operation of any size needs little memory.
pub struct Transaction<'store> {
    store: &'store mut Store,
    document: Document,
    stack: Stack,
    entry: EntryId,
    /// What of which pages was changed, for the levels above.
    changed: Changed,
    /// Something failed half-way: what was written is incomplete.
    is_failed: bool,
    /// It is on disk.
    is_committed: bool,
}

/// What a commit came to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Committed {
    /// The entries that it recorded, in order.
    pub entries: Vec<EntryId>,
    /// What had to go from the history to keep to its budget.
    pub dropped: Dropped,
}

impl std::fmt::Debug for Transaction<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Transaction").field("entry", &self.entry).finish_non_exhaustive()
    }
}

/// What writing a page comes to.
enum Write {
    /// It is as it was, and was never changed.
    Nothing,
    /// It changed.
    Change { page: PageRow, content: Content, delta: DeltaRow },
    /// It was changed before in this transaction and is again as it was.
    Restore { page: PageRow, content: Content },
    /// As before, and it was absent.
    Remove,
}

/// A page as it is in the transaction, with what the transaction did to it so far.
struct Stored {
    now: Option<Content>,
    delta: Option<DeltaRow>,
}

impl<'store> Transaction<'store> {
    pub(crate) fn start(store: &'store mut Store) -> Result<Self> {
        let mut document = store.document.clone();
        let entry = document.next_entry()?;
        store.begin_database()?;
        let (stack, changed) = (store.stack.clone(), Changed::new());
        Ok(Self { store, document, stack, entry, changed, is_failed: false, is_committed: false })
    }

    /// The layers, from the bottom, with those added here.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.stack.layers
    }

    /// Takes back the entries after `entry`, before anything else is done: what is recorded next is done on top of it. They are left
    /// behind as a branch. Gives the pages that changed.
    ///
    /// # Errors
    /// [`Error::UnknownEntry`] for one that is not among those that show; [`Error::TransactionFailed`] when something was written before;
    /// else as [`Store::undo`]. After any error the transaction can only be dropped.
    pub fn go_back_to(&mut self, entry: EntryId) -> Result<Vec<PageKey>> {
        self.refuse_after_failure()?;
        if !self.changed.is_empty() {
            return Err(Error::TransactionFailed);
        }
        let gone_back =
            self.store.step_back(&mut self.document, entry, &mut self.changed).and_then(|pages| {
                self.stack = Stack::load(&self.store.db)?;
                Ok(pages)
            });
        self.fail_with(gone_back)
    }

    /// Reads a page as this transaction left it; `None` where the field holds its constant.
    ///
    /// # Errors
    /// [`Error::DamagedPage`] when the page fails its checksum or does not decode.
    pub fn load_page(&self, key: &PageKey) -> Result<Option<Arc<Page>>> {
        self.store.load_page(key)
    }

    /// Reads a page of a level above full resolution as what was written so far makes it; `None` where the field holds its constant.
    ///
    /// # Errors
    /// As [`Self::load_page`]; after any error the transaction can only be dropped.
    pub fn load_coarse_page(&mut self, key: &PageKey) -> Result<Option<Arc<Page>>> {
        self.refuse_after_failure()?;
        let loaded = self.refresh_levels().and_then(|()| self.load_page(key));
        self.fail_with(loaded)
    }

    /// Makes the levels above what was changed since this was last done.
    fn refresh_levels(&mut self) -> Result<()> {
        let Document { grid, layout, .. } = self.document;
        let changed = std::mem::take(&mut self.changed);
        pyramid::refresh(&self.store.db, grid, layout, |key| self.stack.constant(key), changed)
    }

    /// Reads a page as it was before the entry that is [recorded](Self::record) next; `None` where the field held its
    /// constant.
    ///
    /// # Errors
    /// [`Error::DamagedPage`] when the page fails its checksum or does not decode.
    pub fn load_page_before(&self, key: &PageKey) -> Result<Option<Arc<Page>>> {
        let layout = self.layout();
        let stored = self.stored(key, content::content(self.database(), layout, key)?)?;
        if stored.delta.is_none() {
            return Ok(stored.now.map(|content| content.page));
        }
        let before = stored.values_before(layout, self.entry)?;
        before.map(|ordered| content::page_from_ordered(layout, &ordered).map(Arc::new)).transpose()
    }

    /// Writes pages, coded on all cores. A page may be written again in a later call: the history holds the difference
    /// to what it was before the transaction, and nothing where that is none.
    ///
    /// # Errors
    /// [`Error::Height`], [`Error::PageOutside`], [`Error::PageSize`], [`Error::PageTwice`], [`Error::DerivedPage`] or
    /// [`Error::UnknownField`] before anything is written; after any other error ([`Error::DiskFull`], [`Error::DamagedPage`] ...) the
    /// transaction can only be dropped.
    pub fn write_pages<P: AsRef<Page> + Sync>(&mut self, pages: &[(PageKey, P)]) -> Result<()> {
        self.refuse_after_failure()?;
        self.check_pages(pages)?;
        let mut batches = pages.chunks(content::pages_per_batch(self.layout()));
        let result = batches.try_for_each(|batch| self.write_batch(batch));
        self.fail_with(result)
    }

    /// Puts a layer on top of the stack.
    ///
    /// # Errors
    /// [`Error::LayerName`] or [`Error::Value`] when it cannot be; after any other error the transaction can only be
    /// dropped.
    pub fn add_layer(&mut self, new: &NewLayer) -> Result<Layer> {
        self.refuse_after_failure()?;
        let new = new.checked()?;
        let result = self.stack.add(&self.store.db, &mut self.document, self.entry, new);
        self.fail_with(result)
    }

    /// Makes a field that belongs to no layer yet: a mask, or a selection. It stays when the operation is undone, and then
    /// belongs to nothing.
    ///
    /// # Errors
    /// [`Error::Value`] when no field can have the constant; after any other error the transaction can only be dropped.
    pub fn add_field(&mut self, field: Field) -> Result<orogeny_field::FieldId> {
        self.refuse_after_failure()?;
        let constant = orogeny_field::check_height("the field", field.constant)?;
        let field = Field { constant, ..field };
        let result = self.stack.add_field(&self.store.db, &mut self.document, field);
        self.fail_with(result)
    }

    /// The field of the terrain's selection, made where there was none: nothing is selected then.
    ///
    /// # Errors
    /// As [`Self::add_field`].
    pub fn selection(&mut self) -> Result<orogeny_field::FieldId> {
        match self.known_selection() {
            Some(id) => Ok(id),
            None => self.add_field(Field { kind: FieldKind::Selection, constant: 0.0 }),
        }
    }

    /// The pages that a field has at full resolution.
    ///
    /// # Errors
    /// When the directory cannot be read.
    pub fn page_keys(&self, field: orogeny_field::FieldId) -> Result<Vec<PageKey>> {
        let mut keys = self.store.db.page_keys(field)?;
        keys.retain(|key| key.level == 0);
        Ok(keys)
    }

    /// The field of the terrain's selection, where there is one.
    #[must_use]
    pub fn known_selection(&self) -> Option<orogeny_field::FieldId> {
        let mut fields = self.stack.fields.iter();
        fields.find(|(_, field)| field.kind == FieldKind::Selection).map(|(id, _)| *id)
    }

    /// The layer with a mask, made where it had none: it counts everywhere then.
    ///
    /// # Errors
    /// As [`Self::add_field`] and [`Self::set_layer`].
    pub fn with_mask(&mut self, layer: &Layer) -> Result<Layer> {
        if layer.mask.is_some() {
            return Ok(layer.clone());
        }
        let mask = self.add_field(Field { kind: FieldKind::Mask, constant: 1.0 })?;
        let masked = Layer { mask: Some(mask), mask_constant: 1.0, ..layer.clone() };
        self.set_layer(&masked)?;
        Ok(masked)
    }

    /// Changes a layer: all of it but its id.
    ///
    /// # Errors
    /// [`Error::UnknownLayer`] where there is none of that id; [`Error::LayerName`]; [`Error::UnknownField`] for heights or a
    /// mask that are no field of such; after any other error the transaction can only be dropped.
    pub fn set_layer(&mut self, layer: &Layer) -> Result<()> {
        self.refuse_after_failure()?;
        crate::layer::check_name(&layer.name)?;
        if let Some(mask) = layer.mask
            && self.stack.fields.get(&mask).is_none_or(|field| field.kind != FieldKind::Mask)
        {
            return Err(Error::UnknownField { field: mask });
        }
        let heights = self.stack.fields.get(&layer.heights).filter(|field| field.kind == FieldKind::Heights);
        let Some(Field { constant: constant_m, .. }) = heights.copied() else {
            return Err(Error::UnknownField { field: layer.heights });
        };
        let known = self.stack.layers.iter().position(|known| known.id == layer.id);
        let Some(known) = known.and_then(|place| self.stack.layers.get_mut(place)) else {
            return Err(Error::UnknownLayer { layer: layer.id });
        };
        let mask_constant =
            layer.mask.and_then(|mask| self.stack.fields.get(&mask)).map(|field| field.constant);
        let after = Layer { constant_m, mask_constant: mask_constant.unwrap_or_default(), ..layer.clone() };
        let before = std::mem::replace(known, after);
        let result = self.write_layer_change(&before, layer);
        self.stack.layers.sort_by_key(|layer| (layer.position, layer.id));
        self.fail_with(result)
    }

    /// Takes a layer out of the stack. Its pages stay in the file, since the history leads back to them.
    ///
    /// # Errors
    /// [`Error::UnknownLayer`] where there is none of that id; after any other error the transaction can only be dropped.
    pub fn remove_layer(&mut self, id: u32) -> Result<Layer> {
        self.refuse_after_failure()?;
        let Some(place) = self.stack.layers.iter().position(|layer| layer.id == id) else {
            return Err(Error::UnknownLayer { layer: id });
        };
        let removed = self.stack.layers.remove(place);
        let result = self.write_layer_state(&removed, None);
        self.fail_with(result)?;
        Ok(removed)
    }

    fn write_layer_change(&self, before: &Layer, after: &Layer) -> Result<()> {
        self.write_layer_state(before, Some(after.to_state()?))
    }

    /// Writes a layer as it is now, `None` where it is gone, and what the entry did to it.
    fn write_layer_state(&self, before: &Layer, after: Option<String>) -> Result<()> {
        let db = &self.store.db;
        let layer = before.id;
        db.set_layer(layer, after.as_deref())?;
        let made_here = db.layer_changes(self.entry)?.into_iter().find(|change| change.layer == layer);
        let before = match made_here {
            Some(change) => change.before,
            None => Some(before.to_state()?),
        };
        db.set_layer_change(self.entry, &LayerChange { layer, before, after })
    }

    /// Ends what was done since the last record as one entry of the history, on which later changes of this transaction
    /// stand. `operation_json` says what was done, so that it can be replayed; `author` who did it. Nothing is durable
    /// before [`commit_recorded`](Self::commit_recorded).
    ///
    /// # Errors
    /// [`Error::Operation`] unless the operation is JSON within [`MAX_OPERATION_BYTES`]; [`Error::TransactionFailed`]
    /// after an earlier failure; after any other error the transaction can only be dropped.
    pub fn record(&mut self, operation_json: &str, author: &str) -> Result<EntryId> {
        self.refuse_after_failure()?;
        check_operation(operation_json)?;
        let result = self.insert_entry(operation_json, author);
        self.fail_with(result)
    }

    fn insert_entry(&mut self, operation_json: &str, author: &str) -> Result<EntryId> {
        let recorded = self.entry;
        let parent = std::mem::replace(&mut self.document.head, recorded);
        let db = &self.store.db;
        let (num_pages, delta_bytes) = db.delta_totals(recorded)?;
        db.insert_entry(&EntryRow {
            id: recorded,
            parent: Some(parent),
            operation: operation_json.to_owned(),
            author: author.to_owned(),
            time_unix_ms: unix_ms((self.store.clock)()),
            num_pages,
            delta_bytes,
        })?;
        db.set_next(parent, Some(recorded))?;
        self.document.history_bytes += db.entry_bytes(recorded)?;
        self.entry = self.document.next_entry()?;
        Ok(recorded)
    }

    /// Makes all recorded entries durable, after which the terrain stands at the last of them. When this returns they are
    /// on disk. Changes after the last record belong to no entry, so there must be none.
    ///
    /// # Errors
    /// [`Error::TransactionFailed`] after an earlier failure, or when something was changed since the last record;
    /// [`Error::DiskFull`] and the like when it did not reach the disk. The terrain is then as it was before the
    /// transaction.
    pub fn commit_recorded(mut self) -> Result<Committed> {
        self.refuse_after_failure()?;
        let first = EntryId(self.store.document.last_entry.saturating_add(1));
        let db = &self.store.db;
        if db.delta_totals(self.entry)?.0 > 0 || !db.layer_changes(self.entry)?.is_empty() {
            return Err(Error::TransactionFailed);
        }
        let entries = (first.0..self.entry.0).map(EntryId).collect();
        // The number kept for a further entry is free again.
        self.document.last_entry = self.entry.0.saturating_sub(1);
        self.refresh_levels()?;
        let dropped = budget::keep(&self.store.db, &mut self.document)?;
        self.store.commit(self.document.clone(), std::mem::take(&mut self.stack))?;
        self.is_committed = true;
        Ok(Committed { entries, dropped })
    }

    /// Records everything as one entry of the history and makes it durable: [`record`](Self::record) and
    /// [`commit_recorded`](Self::commit_recorded).
    ///
    /// # Errors
    /// As both; the terrain is then as it was before the transaction.
    pub fn commit(mut self, operation_json: &str, author: &str) -> Result<EntryId> {
        let entry = self.record(operation_json, author)?;
        self.commit_recorded()?;
        Ok(entry)
    }

    /// The number that the entry recorded next will have.
    #[must_use]
    pub const fn entry(&self) -> EntryId {
        self.entry
    }

    pub(crate) const fn database(&self) -> &Database {
        &self.store.db
    }

    /// Remembers that something failed.
    pub(crate) fn fail_with<T>(&mut self, result: Result<T>) -> Result<T> {
        self.is_failed |= result.is_err();
        result
    }

    /// How planes are cut into pages.
    #[must_use]
    pub fn layout(&self) -> PageLayout {
        self.document.layout
    }

    pub(crate) const fn store(&self) -> &Store {
        self.store
    }

    pub(crate) fn refuse_after_failure(&self) -> Result<()> {
        if self.is_failed { Err(Error::TransactionFailed) } else { Ok(()) }
    }

    fn check_pages<P: AsRef<Page> + Sync>(&self, pages: &[(PageKey, P)]) -> Result<()> {
        let Document { grid, layout, .. } = &self.document;
        let expected = layout.size();
        let mut seen = HashSet::with_capacity(pages.len());
        for (key, page) in pages {
            let actual = page.as_ref().size();
            if actual != expected {
                return Err(Error::PageSize { expected, actual });
            }
            if !self.stack.fields.contains_key(&key.field) {
                return Err(Error::UnknownField { field: key.field });
            }
            let (columns, rows) = layout.num_pages_at(grid, key.level);
            if key.x >= columns || key.z >= rows {
                return Err(Error::PageOutside { key: *key, columns, rows });
            }
            if key.level > 0 {
                return Err(Error::DerivedPage { key: *key });
            }
            if !seen.insert(*key) {
                return Err(Error::PageTwice { key: *key });
            }
        }
        pages.par_iter().try_for_each(|(key, page)| check_heights(key, page.as_ref()))
    }

    fn write_batch<P: AsRef<Page> + Sync>(&mut self, batch: &[(PageKey, P)]) -> Result<()> {
        let layout = self.layout();
        let keys: Vec<_> = batch.iter().map(|(key, _)| *key).collect();
        let contents = content::contents(self.database(), layout, &keys)?;
        let stored = keys
            .iter()
            .zip(contents)
            .map(|(key, content)| self.stored(key, content?))
            .collect::<Result<Vec<_>>>()?;
        let (entry, document, stack) = (self.entry, &self.document, &self.stack);
        let pace = &*self.store.db.pace;
        let writes = batch
            .par_iter()
            .zip(stored)
            .map(|((key, page), stored)| {
                pace.wait();
                stored.plan(document, entry, *key, page.as_ref(), stack.constant(key))
            })
            .collect::<Result<Vec<_>>>()?;
        let db = &self.store.db;
        for (key, (write, rect)) in keys.into_iter().zip(writes) {
            pace.wait();
            let mut cache = db.cache.borrow_mut();
            match write {
                Write::Nothing => continue,
                Write::Change { page, content, delta } => {
                    db.write_page(&page)?;
                    db.write_delta(self.entry, &delta)?;
                    cache.put(key, content);
                }
                Write::Restore { page, content } => {
                    db.write_page(&page)?;
                    db.delete_delta(self.entry, &key)?;
                    cache.put(key, content);
                }
                Write::Remove => {
                    db.delete_page(&key)?;
                    db.delete_delta(self.entry, &key)?;
                    cache.forget(&key);
                }
            }
            pyramid::note(&mut self.changed, key, &rect);
        }
        Ok(())
    }

    fn stored(&self, key: &PageKey, now: Option<Content>) -> Result<Stored> {
        let was_changed_here = now.as_ref().is_some_and(|content| content.revision == self.entry);
        let delta =
            was_changed_here.then(|| self.database().delta(self.layout(), self.entry, key)).transpose()?;
        Ok(Stored { now, delta })
    }
}

impl Drop for Transaction<'_> {
    fn drop(&mut self) {
        if !self.is_committed {
            self.store.db.rollback();
        }
    }
}

impl Stored {
    /// The ordered values before the entry; `None` where there was no page.
    fn values_before(&self, layout: PageLayout, entry: EntryId) -> Result<Option<Vec<u32>>> {
        let Some(now) = &self.now else { return Ok(None) };
        let now = codec::ordered_from_page(&now.page);
        let Some(delta) = &self.delta else { return Ok(Some(now)) };
        if delta.revision_before.is_none() {
            return Ok(None);
        }
        let change = content::decode_delta(layout, entry, delta)?;
        Ok(Some(codec::difference(&now, Some(&change))))
    }

    fn revision_before(&self) -> Option<EntryId> {
        match &self.delta {
            Some(delta) => delta.revision_before,
            None => self.now.as_ref().map(|content| content.revision),
        }
    }

    /// What it takes for the page to hold `after`, where absent pages hold `constant`; and which samples of it change.
    fn plan(
        &self,
        document: &Document,
        entry: EntryId,
        key: PageKey,
        after: &Page,
        constant: f32,
    ) -> Result<(Write, SampleRect)> {
        let Document { grid, layout, .. } = *document;
        let rect = match &self.now {
            Some(now) => content::changed_rect(layout, &key, now.page.samples(), after.samples()),
            None => {
                let flat = Page::constant(layout, constant);
                content::changed_rect(layout, &key, flat.samples(), after.samples())
            }
        };
        let before = self.values_before(layout, entry)?;
        let after_values = codec::ordered_from_page(after);
        let is_as_before = match &before {
            Some(before) => *before == after_values,
            None => after.samples().iter().all(|height| height.to_bits() == constant.to_bits()),
        };
        let revision_before = self.revision_before();
        let bounds = content::bounds_of(&grid, layout, &key, after);
        let page_of = |revision: EntryId| {
            let content = Content { revision, bounds, error_m: 0.0, page: Arc::new(after.clone()) };
            let info = PageInfo { revision, bounds, error_m: 0.0 };
            let page = content::encode_page(layout, key, info, &after_values)?;
            Ok::<_, Error>((page, content))
        };
        let write = match (is_as_before, &self.delta, revision_before) {
            (true, None, _) => Write::Nothing,
            (true, Some(_), Some(revision)) => {
                let (page, content) = page_of(revision)?;
                Write::Restore { page, content }
            }
            (true, Some(_), None) => Write::Remove,
            (false, ..) => {
                let (page, content) = page_of(entry)?;
                let difference = codec::difference(&after_values, before.as_deref());
                let delta = content::encode_delta(layout, key, revision_before, &difference)?;
                Write::Change { page, content, delta }
            }
        };
        Ok((write, rect))
    }
}

fn check_heights(key: &PageKey, page: &Page) -> Result<()> {
    let Some(index) = page.samples().iter().position(|&height| !is_storable_height(height)) else {
        return Ok(());
    };
    let side = page.size() as usize;
    let height_m = page.samples().get(index).copied().unwrap_or_default();
    Err(Error::Height { key: *key, x: index % side, z: index / side, height_m, limit_m: MAX_HEIGHT_M })
}

fn check_operation(operation_json: &str) -> Result<()> {
    if operation_json.len() > MAX_OPERATION_BYTES {
        let detail = format!("it has {} bytes, {MAX_OPERATION_BYTES} are allowed", operation_json.len());
        return Err(Error::Operation { detail });
    }
    serde_json::from_str::<serde::de::IgnoredAny>(operation_json)
        .map(|_| ())
        .map_err(|err| Error::Operation { detail: format!("it is no JSON: {err}") })
}
