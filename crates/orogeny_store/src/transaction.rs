//! One operation on a terrain: pages, layers and the history entry become durable together, or not at all.

use std::collections::HashSet;
use std::time::{SystemTime, UNIX_EPOCH};

use orogeny_field::{MAX_HEIGHT_M, Page, PageKey, PageLayout, is_storable_height};
use rayon::prelude::*;

use crate::rows::{DeltaRow, Document, EntryRow, PageRow};
use crate::store::{Stack, load_page};
use crate::{EntryId, Error, Layer, NewLayer, Result, Store, codec, content};

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
    /// Something failed half-way: what was written is incomplete.
    is_failed: bool,
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
    Change { page: PageRow, delta: DeltaRow },
    /// It was changed before in this transaction and is again as it was.
    Restore(PageRow),
    /// As before, and it was absent.
    Remove(PageKey),
}

/// A page as it is in the transaction, with what the transaction did to it so far.
struct Stored {
    page: Option<PageRow>,
    delta: Option<DeltaRow>,
}

impl<'store> Transaction<'store> {
    pub(crate) fn start(store: &'store mut Store) -> Result<Self> {
        store.db.begin()?;
        let started = store.refresh().and_then(|()| {
            let mut document = store.document.clone();
            let entry = document.next_entry()?;
            Ok((document, entry))
        });
        match started {
            Ok((document, entry)) => {
                let stack = store.stack.clone();
                Ok(Self { store, document, stack, entry, is_failed: false })
            }
            Err(err) => {
                store.db.rollback();
                Err(err)
            }
        }
    }

    /// As [`Store::take_was_moved_by_others`].
    pub const fn take_was_moved_by_others(&mut self) -> bool {
        self.store.take_was_moved_by_others()
    }

    /// The layers, from the bottom, with those added here.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.stack.layers
    }

    /// Reads a page as this transaction left it; `None` where the field holds its constant.
    ///
    /// # Errors
    /// [`Error::DamagedPage`] when the page fails its checksum or does not decode.
    pub fn load_page(&self, key: &PageKey) -> Result<Option<Page>> {
        load_page(&self.store.db, self.layout(), key)
    }

    /// Reads a page as it was before this transaction; `None` where the field held its constant.
    ///
    /// # Errors
    /// [`Error::DamagedPage`] when the page fails its checksum or does not decode.
    pub fn load_page_before(&self, key: &PageKey) -> Result<Option<Page>> {
        let layout = self.layout();
        let before = self.stored(key)?.values_before(layout, self.entry)?;
        before.map(|ordered| content::page_from_ordered(layout, &ordered)).transpose()
    }

    /// Writes pages, coded on all cores. A page may be written again in a later call: the history holds the difference
    /// to what it was before the transaction, and nothing where that is none.
    ///
    /// # Errors
    /// [`Error::Height`], [`Error::PageOutside`], [`Error::PageSize`], [`Error::PageTwice`] or [`Error::UnknownField`]
    /// before anything is written; after any other error ([`Error::DiskFull`], [`Error::DamagedPage`] ...) the
    /// transaction can only be dropped.
    pub fn write_pages(&mut self, pages: &[(PageKey, Page)]) -> Result<()> {
        self.refuse_after_failure()?;
        self.check_pages(pages)?;
        let mut batches = pages.chunks(content::pages_per_batch(self.layout()));
        let result = batches.try_for_each(|batch| self.write_batch(batch));
        self.is_failed |= result.is_err();
        result
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
        self.is_failed |= result.is_err();
        result
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
        self.is_failed |= result.is_err();
        result
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
            time_unix_ms: now_unix_ms(),
            num_pages,
            delta_bytes,
        })?;
        db.set_next(parent, recorded)?;
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
    pub fn commit_recorded(mut self) -> Result<()> {
        self.refuse_after_failure()?;
        let db = &self.store.db;
        if db.delta_totals(self.entry)?.0 > 0 || !db.layer_changes(self.entry)?.is_empty() {
            return Err(Error::TransactionFailed);
        }
        // The number kept for a further entry is free again.
        self.document.last_entry = self.entry.0.saturating_sub(1);
        db.update_document(&self.document)?;
        db.commit()?;
        self.store.document = self.document.clone();
        self.store.stack = std::mem::take(&mut self.stack);
        Ok(())
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

    /// How planes are cut into pages.
    #[must_use]
    pub fn layout(&self) -> PageLayout {
        self.document.layout
    }

    fn refuse_after_failure(&self) -> Result<()> {
        if self.is_failed { Err(Error::TransactionFailed) } else { Ok(()) }
    }

    fn check_pages(&self, pages: &[(PageKey, Page)]) -> Result<()> {
        let expected = self.layout().size();
        let mut seen = HashSet::with_capacity(pages.len());
        for (key, page) in pages {
            if page.size() != expected {
                return Err(Error::PageSize { expected, actual: page.size() });
            }
            if !self.stack.constants.contains_key(&key.field) {
                return Err(Error::UnknownField { field: key.field });
            }
            let (columns, rows) = self.document.num_pages_at(key.level);
            if key.x >= columns || key.z >= rows {
                return Err(Error::PageOutside { key: *key, columns, rows });
            }
            if !seen.insert(*key) {
                return Err(Error::PageTwice { key: *key });
            }
        }
        pages.par_iter().try_for_each(|(key, page)| check_heights(key, page))
    }

    fn write_batch(&self, batch: &[(PageKey, Page)]) -> Result<()> {
        let layout = self.layout();
        let stored = batch.iter().map(|(key, _)| self.stored(key)).collect::<Result<Vec<_>>>()?;
        let (entry, constants) = (self.entry, &self.stack.constants);
        let constant = |key: &PageKey| constants.get(&key.field).copied().unwrap_or_default();
        let writes = batch
            .par_iter()
            .zip(stored)
            .map(|((key, page), stored)| stored.plan(layout, entry, *key, page, constant(key)))
            .collect::<Result<Vec<_>>>()?;
        let db = &self.store.db;
        for write in writes {
            match write {
                Write::Nothing => {}
                Write::Change { page, delta } => {
                    db.write_page(&page)?;
                    db.write_delta(self.entry, &delta)?;
                }
                Write::Restore(page) => {
                    db.write_page(&page)?;
                    db.delete_delta(self.entry, &page.key)?;
                }
                Write::Remove(key) => {
                    db.delete_page(&key)?;
                    db.delete_delta(self.entry, &key)?;
                }
            }
        }
        Ok(())
    }

    fn stored(&self, key: &PageKey) -> Result<Stored> {
        let db = &self.store.db;
        let page = db.page(self.layout(), key)?;
        let was_changed_here = page.as_ref().is_some_and(|page| page.revision == self.entry);
        let delta = was_changed_here.then(|| db.delta(self.layout(), self.entry, key)).transpose()?;
        Ok(Stored { page, delta })
    }
}

impl Drop for Transaction<'_> {
    fn drop(&mut self) {
        self.store.db.rollback();
    }
}

impl Stored {
    /// The ordered values before the transaction; `None` where there was no page.
    fn values_before(&self, layout: PageLayout, entry: EntryId) -> Result<Option<Vec<u32>>> {
        let Some(page) = &self.page else { return Ok(None) };
        let Some(delta) = &self.delta else { return content::decode_page(layout, page).map(Some) };
        if delta.revision_before.is_none() {
            return Ok(None);
        }
        let now = content::decode_page(layout, page)?;
        let change = content::decode_delta(layout, entry, delta)?;
        Ok(Some(codec::difference(&now, Some(&change))))
    }

    fn revision_before(&self) -> Option<EntryId> {
        match &self.delta {
            Some(delta) => delta.revision_before,
            None => self.page.as_ref().map(|page| page.revision),
        }
    }

    /// What it takes for the page to hold `after`, where absent pages hold `constant`.
    fn plan(
        &self,
        layout: PageLayout,
        entry: EntryId,
        key: PageKey,
        after: &Page,
        constant: f32,
    ) -> Result<Write> {
        let before = self.values_before(layout, entry)?;
        let after_values = codec::ordered_from_page(after);
        let is_as_before = match &before {
            Some(before) => *before == after_values,
            None => after.samples().iter().all(|height| height.to_bits() == constant.to_bits()),
        };
        let revision_before = self.revision_before();
        Ok(match (is_as_before, &self.delta, revision_before) {
            (true, None, _) => Write::Nothing,
            (true, Some(_), Some(revision)) => {
                Write::Restore(content::encode_page(layout, key, revision, &after_values)?)
            }
            (true, Some(_), None) => Write::Remove(key),
            (false, ..) => {
                let difference = codec::difference(&after_values, before.as_deref());
                Write::Change {
                    page: content::encode_page(layout, key, entry, &after_values)?,
                    delta: content::encode_delta(layout, key, revision_before, &difference)?,
                }
            }
        })
    }
}

impl Document {
    /// Columns and rows of pages of a level; none above the level that is one sample.
    fn num_pages_at(&self, level: u8) -> (u32, u32) {
        let longest = self.grid.width().max(self.grid.depth());
        if level > 0 && (longest - 1).checked_shr(u32::from(level) - 1).unwrap_or(0) == 0 {
            return (0, 0);
        }
        let side = 1_u64 << level.min(32);
        let along = |samples: u32| {
            let pages = u64::from(samples).div_ceil(side).div_ceil(self.layout.size().into());
            u32::try_from(pages).unwrap_or(u32::MAX)
        };
        (along(self.grid.width()), along(self.grid.depth()))
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

/// Milliseconds since 1970; 0 for a clock set before that. For people to read: nothing is ordered by it.
pub(crate) fn now_unix_ms() -> i64 {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since_1970.as_millis()).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use orogeny_field::TerrainGrid;

    use super::*;

    #[test]
    fn levels_end_with_one_sample() {
        let document = |width, depth| Document {
            grid: TerrainGrid::new(width, depth, 1.0).unwrap(),
            layout: PageLayout::new(64).unwrap(),
            head: EntryId(0),
            last_entry: 0,
            last_layer: 0,
            last_field: 0,
        };
        let oblong = document(200, 65);
        let sizes: Vec<_> = (0..11).map(|level| oblong.num_pages_at(level)).collect();
        // 200 x 65, 100 x 33, 50 x 17 ... 2 x 1, 1 x 1 at level 8.
        assert_eq!(sizes[..3], [(4, 2), (2, 1), (1, 1)]);
        assert_eq!(sizes[8], (1, 1));
        assert_eq!(sizes[9..], [(0, 0), (0, 0)]);
        assert_eq!(document(1 << 20, 1).num_pages_at(0), (1 << 14, 1));
        assert_eq!(document(1 << 20, 1).num_pages_at(20), (1, 1));
        assert_eq!(document(1, 1).num_pages_at(0), (1, 1));
        for level in [1, 21, 33, 64, 255] {
            assert_eq!(document(1, 1).num_pages_at(level), (0, 0), "level {level}");
        }
    }
}
