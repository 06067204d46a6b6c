//! How much of the file the history may take, and what goes when it takes more.
//!
//! What was left behind goes first, the oldest branch before the others; then the oldest operations that show, which can no
//! longer be undone but stay in the terrain; last what could be redone, from its far end. Nothing goes without being named.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::database::Database;
use crate::history::Tree;
use crate::rows::Document;
use crate::{EntryId, EntryState, Error, Result, Store};

/// What had to go from the history.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct Dropped {
    /// The entries, in the order in which they went.
    pub entries: Vec<EntryId>,
    /// Those among them that show: they stay done, and can no longer be undone. The others are gone for good.
    pub applied: Vec<EntryId>,
    /// What they took in the file, in bytes.
    pub size_in_bytes: u64,
}

impl Dropped {
    /// Adds what went later.
    pub(crate) fn extend(&mut self, later: Self) {
        self.entries.extend(later.entries);
        self.applied.extend(later.applied);
        self.size_in_bytes += later.size_in_bytes;
    }
}

impl Store {
    /// Sets how many bytes of the file the history may take; `None`: whatever it comes to. Drops what is over it at once.
    ///
    /// # Errors
    /// When the file cannot be written; nothing is changed then.
    pub fn set_history_budget(&mut self, budget_in_bytes: Option<u64>) -> Result<Dropped> {
        self.in_commit(|store, document, _| {
            document.history_budget = budget_in_bytes;
            keep(&store.db, document)
        })
    }

    /// Drops everything that was undone and left behind by a later operation.
    ///
    /// # Errors
    /// When the file cannot be written; nothing is changed then.
    pub fn drop_branches(&mut self) -> Result<Dropped> {
        self.in_commit(|store, document, _| {
            let db = &store.db;
            let mut dropped = Dropped::default();
            let is_branch = |(_, state): &(EntryId, EntryState)| *state == EntryState::Branch;
            for entry in order(db)?.into_iter().filter(is_branch) {
                drop_entry(db, document, entry, &mut dropped)?;
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
        if let Err(err) = self.db.vacuum().and_then(|()| self.db.checkpoint()) {
            self.note_disk_failure(&err)?;
            return Err(err);
        }
        Ok((before, self.file_size_in_bytes()?))
    }
}

/// Drops what the history takes over its budget, in the running transaction. What is damaged stays, and the history over its
/// budget with it: painting goes on.
pub(crate) fn keep(db: &Database, document: &mut Document) -> Result<Dropped> {
    let mut dropped = Dropped::default();
    let Some(budget) = document.history_budget else { return Ok(dropped) };
    if document.history_bytes <= budget {
        return Ok(dropped);
    }
    // The new place in the history, as the entries are to be seen from it.
    db.write_document(document)?;
    // Somewhat more than must be, so that the next operations need not look through the history again.
    let enough = budget - budget / 16;
    let entries = match order(db) {
        Err(Error::DamagedHistory { .. }) => return Ok(dropped),
        entries => entries?,
    };
    for entry in entries {
        if document.history_bytes <= enough {
            break;
        }
        let before = (document.clone(), dropped.clone());
        db.run("SAVEPOINT drop_entry")?;
        match drop_entry(db, document, entry, &mut dropped) {
            Ok(()) => db.run("RELEASE drop_entry")?,
            Err(Error::DamagedHistory { .. }) => {
                db.run("ROLLBACK TO drop_entry; RELEASE drop_entry")?;
                (*document, dropped) = before;
                break;
            }
            Err(err) => return Err(err),
        }
    }
    Ok(dropped)
}

/// The entries in the order in which they go.
fn order(db: &Database) -> Result<Vec<(EntryId, EntryState)>> {
    let tree = Tree::load(db)?;
    let states = tree.states(db)?;
    let is_branch = |id: &EntryId| states.get(id) == Some(&EntryState::Branch);
    // The first entry of the branch that each one lies on. Parents come before their children.
    let mut branches: BTreeMap<EntryId, EntryId> = BTreeMap::new();
    for links in tree.0.values().filter(|links| is_branch(&links.id)) {
        let first = links.parent.and_then(|parent| branches.get(&parent).copied()).unwrap_or(links.id);
        branches.insert(links.id, first);
    }
    let mut branches: Vec<_> = branches.into_iter().collect();
    // The oldest branch first, each from its far end: nothing hangs on what goes.
    branches.sort_by_key(|(id, first)| (*first, Reverse(*id)));
    let of_state = |wanted: EntryState| {
        let entries = states.iter().filter(move |(_, state)| **state == wanted);
        entries.map(|(id, state)| (*id, *state))
    };
    let branches = branches.into_iter().map(|(id, _)| (id, EntryState::Branch));
    Ok(branches.chain(of_state(EntryState::Applied)).chain(of_state(EntryState::Undone).rev()).collect())
}

fn drop_entry(
    db: &Database,
    document: &mut Document,
    (entry, state): (EntryId, EntryState),
    dropped: &mut Dropped,
) -> Result<()> {
    if state == EntryState::Applied {
        db.fold_layer_changes(entry, EntryId::CREATION)?;
    }
    // Without the data that is needed on.
    let size_in_bytes = db.entry_bytes(entry)?;
    if state == EntryState::Applied {
        // It becomes part of where undoing ends. Its branches are gone, so the one child it may have is the next to show or
        // to be redone.
        for child in db.children_of(entry)? {
            db.set_parent(child, EntryId::CREATION)?;
        }
        let next = db.next_of(entry)?;
        if document.head == entry {
            document.head = EntryId::CREATION;
            db.write_document(document)?;
        }
        db.set_next(EntryId::CREATION, next)?;
        document.floor = entry;
    }
    db.delete_entry(entry)?;
    document.history_bytes = document.history_bytes.saturating_sub(size_in_bytes);
    dropped.entries.push(entry);
    dropped.applied.extend((state == EntryState::Applied).then_some(entry));
    dropped.size_in_bytes += size_in_bytes;
    Ok(())
}
