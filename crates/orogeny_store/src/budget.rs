//! How much of the file the history may take, and what goes when it takes more.
//!
//! What was left behind goes first, the oldest branch before the others; then the oldest operations that show, which can no
//! longer be undone but stay in the terrain; last what could be redone, from its far end. Nothing goes without being named.

use std::collections::BTreeMap;

use crate::database::Database;
use crate::history::Tree;
use crate::rows::Document;
use crate::{EntryId, EntryState, Result, Store};

/// What had to go from the history.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct Dropped {
    /// The entries, in the order in which they went.
    pub entries: Vec<EntryId>,
    /// What they took in the file, in bytes.
    pub size_in_bytes: u64,
}

impl Store {
    /// Sets how many bytes of the file the history may take; `None`: whatever it comes to. Drops what is over it at once.
    ///
    /// # Errors
    /// When the file cannot be written; nothing is changed then.
    pub fn set_history_budget(&mut self, budget_in_bytes: Option<u64>) -> Result<Dropped> {
        self.drop_history(|db, document| {
            document.history_budget = budget_in_bytes;
            keep(db, document)
        })
    }

    /// Drops everything that was undone and left behind by a later operation.
    ///
    /// # Errors
    /// When the file cannot be written; nothing is changed then.
    pub fn drop_branches(&mut self) -> Result<Dropped> {
        self.drop_history(|db, document| {
            let mut history = Droppable::load(db)?;
            let mut dropped = Dropped::default();
            while let Some(branch) = history.last_branch() {
                history.drop_entry(db, document, branch, &mut dropped)?;
            }
            Ok(dropped)
        })
    }

    /// Gives back the space that dropped and shortened rows left in the file, and tells its size in bytes before and after.
    /// Needs as much free space as the file takes.
    ///
    /// # Errors
    /// When the file cannot be rewritten; nothing is changed then.
    pub fn compact(&mut self) -> Result<(u64, u64)> {
        self.refuse_unless_writable()?;
        self.db.checkpoint()?;
        let before = self.file_size_in_bytes()?;
        self.db.vacuum()?;
        self.db.checkpoint()?;
        Ok((before, self.file_size_in_bytes()?))
    }

    fn drop_history(
        &mut self,
        choose: impl FnOnce(&Database, &mut Document) -> Result<Dropped>,
    ) -> Result<Dropped> {
        self.refuse_unless_writable()?;
        self.db.begin()?;
        let mut document = self.document.clone();
        match choose(&self.db, &mut document) {
            Ok(dropped) => {
                let stack = self.stack.clone();
                self.commit(document, stack)?;
                Ok(dropped)
            }
            Err(err) => {
                self.db.rollback();
                Err(err)
            }
        }
    }
}

/// Drops what the history takes over its budget, in the running transaction.
pub(crate) fn keep(db: &Database, document: &mut Document) -> Result<Dropped> {
    let mut dropped = Dropped::default();
    let Some(budget) = document.history_budget else { return Ok(dropped) };
    if document.history_bytes <= budget {
        return Ok(dropped);
    }
    // The new place in the history, as the entries are to be seen from it.
    db.update_document(document)?;
    let mut history = Droppable::load(db)?;
    // Somewhat more than must be, so that the next operations need not look through the history again.
    let enough = budget - budget / 16;
    while document.history_bytes > enough
        && let Some(entry) = history.next()
    {
        history.drop_entry(db, document, entry, &mut dropped)?;
    }
    Ok(dropped)
}

/// The entries that are left, and how they hang together.
struct Droppable {
    states: BTreeMap<EntryId, EntryState>,
    parents: BTreeMap<EntryId, EntryId>,
}

impl Droppable {
    fn load(db: &Database) -> Result<Self> {
        let tree = Tree::load(db)?;
        let states = tree.states(db)?;
        let parents = tree.0.values().filter_map(|links| Some((links.id, links.parent?))).collect();
        Ok(Self { states, parents })
    }

    /// The last entry of the oldest branch.
    fn last_branch(&self) -> Option<EntryId> {
        let is_branch = |(id, state): (&EntryId, &EntryState)| (*state == EntryState::Branch).then_some(*id);
        let oldest = self.states.iter().find_map(is_branch)?;
        // The last child of it, of that, and so on: nothing hangs on what has no child.
        let mut last = oldest;
        while let Some((child, _)) = self.parents.iter().rfind(|(_, parent)| **parent == last) {
            last = *child;
        }
        Some(last)
    }

    fn next(&self) -> Option<EntryId> {
        let first_applied = self.states.iter().find(|(_, state)| **state == EntryState::Applied);
        let last_undone = || self.states.iter().rfind(|(_, state)| **state == EntryState::Undone);
        self.last_branch().or_else(|| first_applied.or_else(last_undone).map(|(id, _)| *id))
    }

    fn drop_entry(
        &mut self,
        db: &Database,
        document: &mut Document,
        entry: EntryId,
        dropped: &mut Dropped,
    ) -> Result<()> {
        let size_in_bytes = db.entry_bytes(entry)?;
        if self.states.get(&entry) == Some(&EntryState::Applied) {
            // It becomes part of where undoing ends. Its branches are gone, so the one child it may have is the next to show
            // or to be redone.
            db.fold_layer_changes(entry, EntryId::CREATION)?;
            let children = db.children_of(entry)?;
            for child in &children {
                db.set_parent(*child, EntryId::CREATION)?;
                self.parents.insert(*child, EntryId::CREATION);
            }
            let next = db.next_of(entry)?;
            if document.head == entry {
                document.head = EntryId::CREATION;
                db.update_document(document)?;
            }
            db.set_next(EntryId::CREATION, next)?;
            document.floor = entry;
        }
        db.delete_entry(entry)?;
        document.history_bytes = document.history_bytes.saturating_sub(size_in_bytes);
        self.states.remove(&entry);
        self.parents.remove(&entry);
        dropped.entries.push(entry);
        dropped.size_in_bytes += size_in_bytes;
        Ok(())
    }
}
