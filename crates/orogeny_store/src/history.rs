//! The history: a tree of entries with a place in it.
//!
//! Undo goes to the parent, redo to the child last come from. A new operation after an undo starts a branch: the
//! undone entries stay, and redo no longer leads to them.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use orogeny_field::{Page, PageKey, SampleRect};
use rayon::prelude::*;

use crate::cache::Content;
use crate::database::Database;
use crate::pyramid::{self, Changed, Plane};
use crate::rows::{DeltaRow, Document, EntryLinks, EntryRow, PageInfo, PageRow};
use crate::stack::Stack;
use crate::{Error, Layer, Result, Store, codec, content};

/// The number of a history entry; later ones are higher, none is used twice.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(transparent)]
pub struct EntryId(pub u32);

impl EntryId {
    /// The terrain as it was made: where all undoing ends.
    pub const CREATION: Self = Self(0);
}

impl fmt::Display for EntryId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Whether the terrain shows what an entry did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EntryState {
    /// It does.
    Applied,
    /// It was undone; redo comes to it.
    Undone,
    /// It was undone and a later operation took another way.
    Branch,
}

/// An operation in the history.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Entry {
    /// Its number.
    pub id: EntryId,
    /// The entry it was done on top of; [`EntryId::CREATION`] for a first one.
    pub parent: EntryId,
    /// What was done, as JSON.
    pub operation_json: String,
    /// Who did it.
    pub author: String,
    /// When, in milliseconds since 1970, by the clock of the machine.
    pub time_unix_ms: i64,
    /// Whether it shows.
    pub state: EntryState,
    /// How many pages it changed.
    pub num_pages: u32,
    /// What it takes in the file to undo and redo it, in bytes.
    pub delta_bytes: u64,
}

/// The history in numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct HistorySummary {
    /// What all of it takes in the file, in bytes: deltas, operations, data from outside.
    pub size_in_bytes: u64,
    /// What it may take; the oldest entries go when it comes to more. `None`: there is no limit.
    pub budget_in_bytes: Option<u64>,
    /// The last entry that showed when it was dropped: it and those before it stay done. [`EntryId::CREATION`] where the
    /// history reaches back to the beginning.
    pub dropped_up_to: EntryId,
    /// Entries that show.
    pub num_applied: u64,
    /// Entries that redo comes to.
    pub num_undone: u64,
    /// Entries left behind.
    pub num_branch: u64,
}

/// What an undo or redo of one entry changed.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Change {
    /// The entry that was undone or redone.
    pub entry: EntryId,
    /// Which of the two.
    pub direction: Direction,
    /// The pages that changed, in the order of their keys.
    #[serde(skip)]
    pub pages: Vec<PageKey>,
    /// Whether [`Store::layers`] changed.
    pub layers_changed: bool,
}

/// A way through the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Back: the entry no longer shows.
    Undo,
    /// On: the entry shows again.
    Redo,
}

/// How all entries hang together.
pub(crate) struct Tree(pub(crate) BTreeMap<EntryId, EntryLinks>);

impl Store {
    /// Undoes up to `count` operations, all of them or on an error none; fewer where the history begins. What they did
    /// is exactly gone, bit for bit. One entry of the answer for each, in the order they were undone.
    ///
    /// # Errors
    /// [`Error::DamagedHistory`] or [`Error::DamagedPage`] when something needed for it cannot be trusted;
    /// [`Error::Busy`], [`Error::DiskFull`] and the like. The terrain is then as it was.
    pub fn undo(&mut self, count: u32) -> Result<Vec<Change>> {
        let mut steps = Vec::new();
        let mut at = self.document.head;
        while steps.len() < count as usize
            && let Some(parent) = self.db.entry(at)?.parent
        {
            steps.push((at, Direction::Undo));
            at = parent;
        }
        self.travel(&steps)
    }

    /// Redoes up to `count` undone operations, as [`Self::undo`] undoes them.
    ///
    /// # Errors
    /// As for [`Self::undo`].
    pub fn redo(&mut self, count: u32) -> Result<Vec<Change>> {
        let mut steps = Vec::new();
        let mut at = self.document.head;
        while steps.len() < count as usize
            && let Some(next) = self.db.next_of(at)?
        {
            // No checksum covers where redo leads, since that changes; the entry it leads to says what it was done on.
            if self.db.entry(next)?.parent != Some(at) {
                return Err(wrong_next(at, next));
            }
            steps.push((next, Direction::Redo));
            at = next;
        }
        self.travel(&steps)
    }

    /// Goes to an entry anywhere in the history, on a branch too: afterwards it is the last one that shows. One entry of the
    /// answer for each that was undone or redone on the way.
    ///
    /// # Errors
    /// [`Error::UnknownEntry`]; else as for [`Self::undo`].
    pub fn jump(&mut self, target: EntryId) -> Result<Vec<Change>> {
        let steps = Tree::load(&self.db)?.way(self.document.head, target)?;
        self.travel(&steps)
    }

    /// All entries, oldest first, whether they show or not.
    ///
    /// # Errors
    /// [`Error::DamagedHistory`] for an entry that fails its checksum.
    pub fn log(&self) -> Result<Vec<Entry>> {
        self.log_from(EntryId::CREATION)
    }

    /// The entries from one on, oldest first, whether they show or not.
    ///
    /// # Errors
    /// As [`Self::log`].
    pub fn log_from(&self, first: EntryId) -> Result<Vec<Entry>> {
        self.db.in_snapshot(|| {
            let states = Tree::load(&self.db)?.states(&self.db)?;
            let mut log = Vec::new();
            self.db.for_each_entry(first, |row| {
                let row = row?;
                if let (Some(parent), Some(&state)) = (row.parent, states.get(&row.id)) {
                    log.push(Entry {
                        id: row.id,
                        parent,
                        operation_json: row.operation,
                        author: row.author,
                        time_unix_ms: row.time_unix_ms,
                        state,
                        num_pages: row.num_pages,
                        delta_bytes: row.delta_bytes,
                    });
                }
                Ok(())
            })?;
            Ok(log)
        })
    }

    /// Of each entry, what it was done on and whether it shows, without reading what was done.
    ///
    /// # Errors
    /// When the history cannot be read or trusted.
    pub fn entry_states(&self) -> Result<BTreeMap<EntryId, (EntryId, EntryState)>> {
        self.db.in_snapshot(|| {
            let tree = Tree::load(&self.db)?;
            let states = tree.states(&self.db)?.into_iter().filter_map(|(id, state)| {
                let parent = tree.0.get(&id)?.parent?;
                Some((id, (parent, state)))
            });
            Ok(states.collect())
        })
    }

    /// The layers that the terrain had when it was made, from the bottom; `None` when the history does not reach back to that
    /// any more.
    ///
    /// # Errors
    /// When the history cannot be read or trusted.
    pub fn original_layers(&self) -> Result<Option<Vec<Layer>>> {
        if self.db.document()?.floor != EntryId::CREATION {
            return Ok(None);
        }
        let states = self.db.layer_changes(EntryId::CREATION)?.into_iter().filter_map(|change| change.after);
        let layers = states.map(|state| {
            let layer: Layer = serde_json::from_str(&state).map_err(|err| Error::DamagedHistory {
                entry: EntryId::CREATION,
                page: None,
                detail: err.to_string(),
            })?;
            let constant_m = self.stack.fields.get(&layer.heights).map_or(0.0, |field| field.constant);
            Ok(Layer { constant_m, ..layer })
        });
        let mut layers = layers.collect::<Result<Vec<_>>>()?;
        layers.sort_by_key(|layer| (layer.position, layer.id));
        Ok(Some(layers))
    }

    /// The history in numbers, without reading the operations.
    ///
    /// # Errors
    /// When the history cannot be read.
    pub fn history_summary(&self) -> Result<HistorySummary> {
        self.db.in_snapshot(|| {
            let document = self.db.document()?;
            let mut summary = HistorySummary {
                size_in_bytes: document.history_bytes,
                budget_in_bytes: document.history_budget,
                dropped_up_to: document.floor,
                ..HistorySummary::default()
            };
            for state in Tree::load(&self.db)?.states(&self.db)?.values() {
                match state {
                    EntryState::Applied => summary.num_applied += 1,
                    EntryState::Undone => summary.num_undone += 1,
                    EntryState::Branch => summary.num_branch += 1,
                }
            }
            Ok(summary)
        })
    }

    fn travel(&mut self, steps: &[(EntryId, Direction)]) -> Result<Vec<Change>> {
        if steps.is_empty() {
            return Ok(Vec::new());
        }
        self.in_commit(|store, document, stack| {
            let changes = store.step_over_all(steps, document, stack)?;
            for (entry, direction) in steps {
                if *direction == Direction::Redo {
                    // Where it came from a branch, redo leads there from now on.
                    let parent = store.db.entry(*entry)?.parent.unwrap_or(EntryId::CREATION);
                    store.db.set_next(parent, Some(*entry))?;
                }
            }
            Ok(changes)
        })
    }

    /// Shows a reader that holds a state of the file the terrain as it was after an entry.
    pub(crate) fn go_back_without_writing(&mut self, target: EntryId) -> Result<()> {
        let steps = Tree::load(&self.db)?.way(self.document.head, target)?;
        if steps.is_empty() {
            return Ok(());
        }
        let (mut document, mut stack) = (self.document.clone(), self.stack.clone());
        self.db.in_past(|| {
            self.step_over_all(&steps, &mut document, &mut stack)?;
            self.db.write_document(&document)
        })?;
        (self.document, self.stack) = (document, stack);
        Ok(())
    }

    /// Undoes or redoes entries, with the levels above full resolution.
    fn step_over_all(
        &self,
        steps: &[(EntryId, Direction)],
        document: &mut Document,
        stack: &mut Stack,
    ) -> Result<Vec<Change>> {
        let mut changes = Vec::with_capacity(steps.len());
        let mut changed = Changed::new();
        for (entry, direction) in steps {
            changes.push(self.step_over(*entry, *direction, &mut changed)?);
            document.head = match direction {
                Direction::Undo => self.db.entry(*entry)?.parent.unwrap_or(EntryId::CREATION),
                Direction::Redo => *entry,
            };
        }
        *stack = Stack::load(&self.db)?;
        pyramid::refresh(&self.db, document.grid, document.layout, |key| stack.constant(key), changed)?;
        Ok(changes)
    }

    /// Undoes all entries after `target`, in the transaction that is running, and gives the pages that changed.
    pub(crate) fn step_back(
        &self,
        document: &mut Document,
        target: EntryId,
        changed: &mut Changed,
    ) -> Result<Vec<PageKey>> {
        let mut pages = BTreeSet::new();
        while document.head != target {
            let parent = self.db.entry(document.head)?.parent;
            let parent = parent.ok_or(Error::UnknownEntry { entry: target })?;
            pages.extend(self.step_over(document.head, Direction::Undo, changed)?.pages);
            document.head = parent;
        }
        Ok(pages.into_iter().collect())
    }

    /// Undoes or redoes one entry: pages, then layers.
    fn step_over(&self, entry: EntryId, direction: Direction, changed: &mut Changed) -> Result<Change> {
        let (db, stack) = (&self.db, &self.stack);
        let Document { grid, layout, .. } = self.document;
        let EntryRow { num_pages, .. } = db.entry(entry)?;
        let pages = db.delta_keys(entry)?;
        if pages.len() != num_pages as usize {
            let detail = format!("it changed {num_pages} pages, the history has {} of them", pages.len());
            return Err(Error::DamagedHistory { entry, page: None, detail });
        }
        for batch in pages.chunks(content::pages_per_batch(layout)) {
            let deltas = batch.iter().map(|key| db.delta(layout, entry, key)).collect::<Result<Vec<_>>>()?;
            let now = content::contents(db, layout, batch)?;
            let steps = deltas
                .into_par_iter()
                .zip(now)
                .map(|(delta, now)| {
                    let constant = stack.constant(&delta.key);
                    page_after_step(&Plane { grid, layout, constant }, entry, direction, &delta, now?)
                })
                .collect::<Result<Vec<_>>>()?;
            for (key, (page, rect)) in batch.iter().zip(steps) {
                let mut cache = db.cache.borrow_mut();
                if let Some((row, content)) = page {
                    db.write_page(&row)?;
                    cache.put(*key, content);
                } else {
                    db.delete_page(key)?;
                    cache.forget(key);
                }
                pyramid::note(changed, *key, &rect);
            }
        }
        let layer_changes = db.layer_changes(entry)?;
        for change in &layer_changes {
            let state = if direction == Direction::Undo { &change.before } else { &change.after };
            db.set_layer(change.layer, state.as_deref())?;
        }
        Ok(Change { entry, direction, pages, layers_changed: !layer_changes.is_empty() })
    }
}

fn wrong_next(entry: EntryId, next: EntryId) -> Error {
    let detail = format!("redo would lead from it to entry {next}, which was not done on it");
    Error::DamagedHistory { entry, page: None, detail }
}

/// What a page holds once `delta` is taken away or added, `None` where it is then absent; and which samples of it change.
fn page_after_step(
    plane: &Plane,
    entry: EntryId,
    direction: Direction,
    delta: &DeltaRow,
    now: Option<Content>,
) -> Result<(Option<(PageRow, Content)>, SampleRect)> {
    let Plane { grid, layout, constant } = *plane;
    let key = delta.key;
    let expected = match direction {
        Direction::Undo => Some(entry),
        Direction::Redo => delta.revision_before,
    };
    let found = now.as_ref().map(|content| content.revision);
    if found != expected {
        let name =
            |revision: Option<EntryId>| revision.map_or("no entry".to_owned(), |r| format!("entry {r}"));
        let detail =
            format!("it holds the state of {}, the history wants that of {}", name(found), name(expected));
        return Err(Error::damaged_page(key, detail));
    }
    let change = content::decode_delta(layout, entry, delta)?;
    let ordered_now = now.as_ref().map(|content| codec::ordered_from_page(&content.page));
    let after = match (direction, ordered_now, delta.revision_before) {
        (Direction::Undo, Some(now), Some(before)) => Some((codec::difference(&now, Some(&change)), before)),
        (Direction::Undo, ..) => None,
        (Direction::Redo, Some(now), _) => Some((codec::sum(&now, &change), entry)),
        (Direction::Redo, None, _) => Some((change, entry)),
    };
    let flat = Page::constant(layout, constant);
    let before = now.as_ref().map_or(&flat, |content| &content.page);
    let Some((values, revision)) = after else {
        return Ok((None, content::changed_rect(layout, &key, before.samples(), flat.samples())));
    };
    content::check_ordered(key, &values)?;
    let page = content::page_from_ordered(layout, &values)?;
    let rect = content::changed_rect(layout, &key, before.samples(), page.samples());
    let bounds = content::bounds_of(&grid, layout, &key, &page);
    let info = PageInfo { revision, bounds, error_m: 0.0 };
    let row = content::encode_page(layout, key, info, &values)?;
    let content = Content { revision, bounds, error_m: 0.0, page: page.into() };
    Ok((Some((row, content)), rect))
}

impl Tree {
    /// What to undo and redo, in order, to come from one entry to another.
    fn way(&self, from: EntryId, to: EntryId) -> Result<Vec<(EntryId, Direction)>> {
        let (mut at, mut down, mut back) = (to, Vec::new(), Vec::new());
        let mut up = from;
        if !self.0.contains_key(&to) {
            return Err(Error::UnknownEntry { entry: to });
        }
        // Parents come before their children, so the later of the two is never above the earlier one.
        while up != at {
            let later = up.max(at);
            let parent = self.0.get(&later).and_then(|links| links.parent).filter(|parent| *parent < later);
            let parent = parent.ok_or_else(|| Error::DamagedHistory {
                entry: later,
                page: None,
                detail: "what it was done on is missing".to_owned(),
            })?;
            if later == up {
                back.push((up, Direction::Undo));
                up = parent;
            } else {
                down.push((at, Direction::Redo));
                at = parent;
            }
        }
        back.extend(down.into_iter().rev());
        Ok(back)
    }

    pub(crate) fn load(db: &Database) -> Result<Self> {
        let links = db.entry_links()?;
        Ok(Self(links.into_iter().map(|links| (links.id, links)).collect()))
    }

    /// Of all entries but the creation.
    pub(crate) fn states(&self, db: &Database) -> Result<BTreeMap<EntryId, EntryState>> {
        let mut states: BTreeMap<_, _> = self
            .0
            .keys()
            .filter(|id| **id != EntryId::CREATION)
            .map(|id| (*id, EntryState::Branch))
            .collect();
        let damaged =
            |entry, detail: &str| Error::DamagedHistory { entry, page: None, detail: detail.to_owned() };
        let head = db.document()?.head;
        let mut at = head;
        while at != EntryId::CREATION {
            states.insert(at, EntryState::Applied);
            let parent = self.0.get(&at).and_then(|links| links.parent);
            // Parents come before their children; anything else would also never end.
            at = parent.filter(|p| *p < at).ok_or_else(|| damaged(at, "what it was done on is missing"))?;
        }
        at = head;
        while let Some(next) = self.0.get(&at).and_then(|links| links.next) {
            if self.0.get(&next).is_none_or(|links| links.parent != Some(at)) {
                return Err(wrong_next(at, next));
            }
            states.insert(next, EntryState::Undone);
            at = next;
        }
        Ok(states)
    }
}
