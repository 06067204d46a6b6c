//! Making a damaged terrain usable again, as far as what is left of it allows.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use orogeny_field::PageKey;

use crate::cache::Content;
use crate::history::Tree;
use crate::pyramid::{self, Changed, Plane};
use crate::rows::PageInfo;
use crate::{EntryId, EntryState, Error, Result, Store, codec, content};

/// What [`Store::repair`] did, and what it could not do.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Repaired {
    /// The commit that the terrain stands at and the last one that was acknowledged, where commits were lost. The terrain goes
    /// on from the first.
    pub lost_commits: Option<(u64, u64)>,
    /// Pages that were made again from the history, bit for bit.
    pub pages_from_history: Vec<PageKey>,
    /// Pages that could not be made again: they stay damaged, and nothing can be painted there. Undoing to before them or a
    /// copy of the terrain may help; [`Store::salvage`] makes a terrain without damage of the rest.
    pub lost_pages: Vec<PageKey>,
    /// Whether the levels above full resolution were made anew.
    pub levels_made_anew: bool,
}

impl Store {
    /// Repairs a terrain: goes on from where it stands when commits were lost, makes damaged pages again from the history
    /// where that has them whole, and the levels above them.
    ///
    /// # Errors
    /// As [`Self::open`], but for [`Error::LostCommits`]. What could not be repaired is no error: it is listed.
    pub fn repair(path: &Path) -> Result<Repaired> {
        let (mut store, acknowledged) = Self::open_whatever_was_lost(path)?;
        let mut repaired = Repaired::default();
        match store.document.check_commit(store.path(), acknowledged.as_ref()) {
            Ok(()) => store.nothing_is_lost(),
            Err(Error::LostCommits { found, acknowledged, .. }) => {
                repaired.lost_commits = Some((found, acknowledged));
                store.accept_what_was_lost()?;
            }
            Err(err) => return Err(err),
        }
        let problems = store.check()?.problems;
        let (grid, layout) = (store.grid(), store.layout());
        let damaged: BTreeSet<PageKey> = problems
            .iter()
            .filter_map(|problem| match problem {
                Error::DamagedPage { key, .. } => Some(*key),
                _ => None,
            })
            .filter(|key| layout.has_page(&grid, key))
            .collect();
        if !problems.is_empty() {
            repaired = store.in_commit(|store, document, _| {
                store.repair_pages(&damaged, &mut repaired)?;
                document.history_bytes = store.db.history_bytes()?;
                Ok(repaired)
            })?;
        }
        store.close()?;
        Ok(repaired)
    }

    fn repair_pages(&self, damaged: &BTreeSet<PageKey>, repaired: &mut Repaired) -> Result<()> {
        for key in damaged.iter().filter(|key| key.level == 0) {
            match self.page_from_history(key)? {
                Some(content) => {
                    let Content { revision, bounds, error_m, page } = content;
                    let values = codec::ordered_from_page(&page);
                    let info = PageInfo { revision, bounds, error_m };
                    self.db.write_page(&content::encode_page(self.layout(), *key, info, &values)?)?;
                    repaired.pages_from_history.push(*key);
                }
                None => repaired.lost_pages.push(*key),
            }
        }
        self.db.cache.borrow_mut().clear();
        // Those that cannot be made again, since what is below them is lost, stay as they are: with those above them they are
        // all that is left of it. The keys come with the finer levels first.
        for key in damaged.iter().filter(|key| key.level > 0) {
            let plane =
                Plane { grid: self.grid(), layout: self.layout(), constant: self.stack.constant(key) };
            if pyramid::made_from_scratch(&self.db, &plane, *key).is_ok() {
                self.db.delete_page(key)?;
                repaired.levels_made_anew = true;
            }
        }
        self.db.cache.borrow_mut().clear();
        if !repaired.levels_made_anew && repaired.pages_from_history.is_empty() {
            return Ok(());
        }
        let (grid, layout) = (self.grid(), self.layout());
        let mut below = Changed::new();
        for field in self.stack.fields.keys() {
            let keys = self.db.page_keys_as_far_as_possible(*field, &mut Vec::new());
            below.extend(pyramid::all_of(&grid, layout, keys));
        }
        pyramid::refresh(&self.db, grid, layout, |key| self.stack.constant(key), below)
    }

    /// A page at full resolution, made from what the operations that show did to it; `None` where the history does not reach
    /// back to its beginning, or is damaged itself.
    pub(crate) fn page_from_history(&self, key: &PageKey) -> Result<Option<Content>> {
        let layout = self.layout();
        let states = Tree::load(&self.db)?.states(&self.db)?;
        let mut made: Option<(EntryId, Vec<u32>)> = None;
        for entry in self.db.entries_of_page(key)? {
            if states.get(&entry) != Some(&EntryState::Applied) {
                continue;
            }
            let Ok(delta) = self.db.delta(layout, entry, key) else { return Ok(None) };
            let Ok(change) = content::decode_delta(layout, entry, &delta) else { return Ok(None) };
            if delta.revision_before != made.as_ref().map(|(revision, _)| *revision) {
                return Ok(None);
            }
            let values = match made {
                Some((_, before)) => codec::sum(&before, &change),
                None => change,
            };
            made = Some((entry, values));
        }
        let Some((revision, values)) = made else { return Ok(None) };
        if content::check_ordered(*key, &values).is_err() {
            return Ok(None);
        }
        let page = content::page_from_ordered(layout, &values)?;
        let bounds = content::bounds_of(&self.grid(), layout, key, &page);
        Ok(Some(Content { revision, bounds, error_m: 0.0, page: Arc::new(page) }))
    }
}
