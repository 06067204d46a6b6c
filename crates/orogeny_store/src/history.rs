//! The history: a tree of entries with a place in it.
//!
//! Undo goes to the parent, redo to the child last come from. A new operation after an undo starts a branch: the
//! undone entries stay, and redo no longer leads to them.

use std::collections::BTreeMap;
use std::fmt;

use orogeny_field::{PageKey, PageLayout};
use rayon::prelude::*;

use crate::database::Database;
use crate::rows::{DeltaRow, EntryLinks, EntryRow, PageRow};
use crate::store::Stack;
use crate::{Error, Result, Store, codec, content};

/// The number of a history entry; later ones are higher, none is used twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
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
    /// Entries that show.
    pub num_applied: u64,
    /// Entries that redo comes to.
    pub num_undone: u64,
    /// Entries left behind.
    pub num_branch: u64,
    /// What all of them take in the file, in bytes, operations not counted.
    pub delta_bytes: u64,
}

/// What an undo or redo of one entry changed.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Change {
    /// The entry that was undone or redone.
    pub entry: EntryId,
    /// The pages that changed, in the order of their keys.
    #[serde(skip)]
    pub pages: Vec<PageKey>,
    /// Whether [`Store::layers`] changed.
    pub layers_changed: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Direction {
    Undo,
    Redo,
}

/// How all entries hang together.
struct Tree(BTreeMap<EntryId, EntryLinks>);

impl Store {
    /// Undoes up to `count` operations, all of them or on an error none; fewer where the history begins. What they did
    /// is exactly gone, bit for bit. One entry of the answer for each, in the order they were undone.
    ///
    /// # Errors
    /// [`Error::DamagedHistory`] or [`Error::DamagedPage`] when something needed for it cannot be trusted;
    /// [`Error::Busy`], [`Error::DiskFull`] and the like. The terrain is then as it was.
    pub fn undo(&mut self, count: u32) -> Result<Vec<Change>> {
        self.travel(Direction::Undo, count)
    }

    /// Redoes up to `count` undone operations, as [`Self::undo`] undoes them.
    ///
    /// # Errors
    /// As for [`Self::undo`].
    pub fn redo(&mut self, count: u32) -> Result<Vec<Change>> {
        self.travel(Direction::Redo, count)
    }

    /// All entries, oldest first, whether they show or not.
    ///
    /// # Errors
    /// [`Error::DamagedHistory`] for an entry that fails its checksum.
    pub fn log(&self) -> Result<Vec<Entry>> {
        self.db.in_snapshot(|| {
            let states = Tree::load(&self.db)?.states(&self.db)?;
            let mut log = Vec::new();
            self.db.for_each_entry(|row| {
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

    /// The history in numbers, without reading the operations.
    ///
    /// # Errors
    /// When the history cannot be read.
    pub fn history_summary(&self) -> Result<HistorySummary> {
        self.db.in_snapshot(|| {
            let tree = Tree::load(&self.db)?;
            let mut summary = HistorySummary::default();
            for (entry, state) in tree.states(&self.db)? {
                match state {
                    EntryState::Applied => summary.num_applied += 1,
                    EntryState::Undone => summary.num_undone += 1,
                    EntryState::Branch => summary.num_branch += 1,
                }
                summary.delta_bytes += tree.0.get(&entry).map_or(0, |links| links.delta_bytes);
            }
            Ok(summary)
        })
    }

    fn travel(&mut self, direction: Direction, count: u32) -> Result<Vec<Change>> {
        self.db.begin()?;
        let result = self.travel_in_transaction(direction, count);
        if result.is_err() {
            self.db.rollback();
        }
        result
    }

    fn travel_in_transaction(&mut self, direction: Direction, count: u32) -> Result<Vec<Change>> {
        self.refresh()?;
        let mut document = self.document.clone();
        let mut changes = Vec::new();
        for _ in 0..count {
            let step = match direction {
                Direction::Undo => self.db.entry(document.head)?.parent.map(|to| (document.head, to)),
                Direction::Redo => self.db.next_of(document.head)?.map(|to| (to, to)),
            };
            let Some((entry, arrival)) = step else { break };
            changes.push(step_over(&self.db, document.layout, entry, direction)?);
            document.head = arrival;
        }
        self.db.update_document(&document)?;
        let stack = Stack::load(&self.db)?;
        self.db.commit()?;
        self.document = document;
        self.stack = stack;
        Ok(changes)
    }
}

/// Undoes or redoes one entry: pages, then layers.
fn step_over(db: &Database, layout: PageLayout, entry: EntryId, direction: Direction) -> Result<Change> {
    let EntryRow { num_pages, .. } = db.entry(entry)?;
    let pages = db.delta_keys(entry)?;
    if pages.len() != num_pages as usize {
        let detail = format!("it changed {num_pages} pages, the history has {} of them", pages.len());
        return Err(Error::DamagedHistory { entry, page: None, detail });
    }
    for batch in pages.chunks(content::pages_per_batch(layout)) {
        let read = |key: &PageKey| Ok((db.delta(layout, entry, key)?, db.page(layout, key)?));
        let rows = batch.iter().map(read).collect::<Result<Vec<_>>>()?;
        let results = rows
            .into_par_iter()
            .map(|(delta, page)| page_after_step(layout, entry, direction, &delta, page))
            .collect::<Result<Vec<_>>>()?;
        for (key, page) in batch.iter().zip(results) {
            match page {
                Some(page) => db.write_page(&page)?,
                None => db.delete_page(key)?,
            }
        }
    }
    let layer_changes = db.layer_changes(entry)?;
    for change in &layer_changes {
        let state = if direction == Direction::Undo { &change.before } else { &change.after };
        db.set_layer(change.layer, state.as_deref())?;
    }
    Ok(Change { entry, pages, layers_changed: !layer_changes.is_empty() })
}

/// What a page holds once `delta` is taken away or added; `None` where it is then absent.
fn page_after_step(
    layout: PageLayout,
    entry: EntryId,
    direction: Direction,
    delta: &DeltaRow,
    page: Option<PageRow>,
) -> Result<Option<PageRow>> {
    let key = delta.key;
    let expected = match direction {
        Direction::Undo => Some(entry),
        Direction::Redo => delta.revision_before,
    };
    let found = page.as_ref().map(|page| page.revision);
    if found != expected {
        let name =
            |revision: Option<EntryId>| revision.map_or("no entry".to_owned(), |r| format!("entry {r}"));
        let detail =
            format!("it holds the state of {}, the history wants that of {}", name(found), name(expected));
        return Err(Error::damaged_page(key, detail));
    }
    let change = content::decode_delta(layout, entry, delta)?;
    let now = page.map(|page| content::decode_page(layout, &page)).transpose()?;
    let (values, revision) = match (direction, now, delta.revision_before) {
        (Direction::Undo, Some(now), Some(before)) => (codec::difference(&now, Some(&change)), before),
        (Direction::Undo, ..) => return Ok(None),
        (Direction::Redo, Some(now), _) => (codec::sum(&now, &change), entry),
        (Direction::Redo, None, _) => (change, entry),
    };
    content::check_ordered(key, &values)?;
    content::encode_page(layout, key, revision, &values).map(Some)
}

impl Tree {
    fn load(db: &Database) -> Result<Self> {
        let links = db.entry_links()?;
        Ok(Self(links.into_iter().map(|links| (links.id, links)).collect()))
    }

    /// Of all entries but the creation.
    fn states(&self, db: &Database) -> Result<BTreeMap<EntryId, EntryState>> {
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
            if next <= at || !self.0.contains_key(&next) {
                return Err(damaged(at, "what redo would go to is missing"));
            }
            states.insert(next, EntryState::Undone);
            at = next;
        }
        Ok(states)
    }
}
