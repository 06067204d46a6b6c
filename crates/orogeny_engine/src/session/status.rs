//! What a window shows of a terrain beside its ground.

use std::collections::BTreeMap;

use orogeny_field::{PageLayout, TerrainGrid};
use orogeny_geomip::{PagePlace, PageSummary};
use orogeny_store::{EntryId, EntryState, Layer};

use crate::{LayerDescription, MemoryUse, Operation, Result, Terrain};

/// A terrain as it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Status {
    /// Size and spacing.
    pub grid: TerrainGrid,
    /// How planes are cut into pages.
    pub layout: PageLayout,
    /// The layers, from the bottom.
    pub layers: Vec<Layer>,
    /// The same for people.
    pub descriptions: Vec<LayerDescription>,
    /// The history, oldest first.
    pub history: Vec<HistoryItem>,
    /// The composite where nothing is painted, metres.
    pub unpainted_m: f32,
    /// What is known of all of the terrain.
    pub root: (PagePlace, PageSummary),
    /// What it takes in memory.
    pub memory: MemoryUse,
    /// Bytes on disk.
    pub file_size_in_bytes: u64,
}

/// An entry of the history, for people.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HistoryItem {
    /// Its number.
    pub id: EntryId,
    /// The entry it was done on top of.
    pub parent: EntryId,
    /// What was done: `stroke raise`, `add_layer`.
    pub label: String,
    /// Who did it.
    pub author: String,
    /// When, in milliseconds since 1970.
    pub time_unix_ms: i64,
    /// Whether it shows.
    pub state: EntryState,
    /// How many pages it changed.
    pub num_pages: u32,
}

/// The history as it was last told, so that only what is new of it is read again.
#[derive(Debug, Default)]
pub(super) struct KnownHistory(BTreeMap<EntryId, HistoryItem>);

impl KnownHistory {
    /// The last entry of an author that shows.
    pub(super) fn last_of(&self, author: &str) -> Option<EntryId> {
        let mut own = self.0.values().rev();
        let last = own.find(|item| item.state == EntryState::Applied && item.author == author);
        last.map(|item| item.id)
    }

    /// The entry that redo comes to, if it is of that author.
    pub(super) fn next_of(&self, author: &str) -> Option<EntryId> {
        let next = self.0.values().find(|item| item.state == EntryState::Undone);
        next.filter(|item| item.author == author).map(|item| item.id)
    }

    pub(super) fn shows(&self, entry: EntryId) -> bool {
        self.0.get(&entry).is_some_and(|item| item.state == EntryState::Applied)
    }

    /// The history as it is now.
    fn refresh(&mut self, terrain: &Terrain) -> Result<Vec<HistoryItem>> {
        let store = terrain.settled()?;
        // Numbers are used once: what is known of one, but for these two, stays true.
        let states = store.entry_states()?;
        self.0.retain(|id, _| states.contains_key(id));
        let first_unknown = self.0.last_key_value().map_or(0, |(id, _)| id.0.saturating_add(1));
        for entry in store.log_from(EntryId(first_unknown))? {
            let item = HistoryItem {
                id: entry.id,
                parent: entry.parent,
                label: label(&entry.operation_json),
                author: entry.author,
                time_unix_ms: entry.time_unix_ms,
                state: entry.state,
                num_pages: entry.num_pages,
            };
            self.0.insert(entry.id, item);
        }
        for (id, item) in &mut self.0 {
            if let Some(&(parent, state)) = states.get(id) {
                (item.parent, item.state) = (parent, state);
            }
        }
        Ok(self.0.values().cloned().collect())
    }
}

impl Status {
    pub(super) fn of(
        terrain: &Terrain,
        root: (PagePlace, PageSummary),
        known: &mut KnownHistory,
    ) -> Result<Self> {
        let description = terrain.describe()?;
        let history = known.refresh(terrain)?;
        Ok(Self {
            grid: terrain.grid(),
            layout: terrain.store()?.layout(),
            layers: terrain.layers()?.to_vec(),
            descriptions: description.layers,
            history,
            unpainted_m: terrain.unpainted_height_m()?,
            root,
            memory: description.memory,
            file_size_in_bytes: description.file_size_in_bytes,
        })
    }

    /// The last entry that shows; [`EntryId::CREATION`] where none does.
    #[must_use]
    pub fn current_entry(&self) -> EntryId {
        let applied = self.history.iter().rev().find(|item| item.state == EntryState::Applied);
        applied.map_or(EntryId::CREATION, |item| item.id)
    }

    /// Whether there is something to undo, and to redo.
    #[must_use]
    pub fn can_undo_redo(&self) -> [bool; 2] {
        [EntryState::Applied, EntryState::Undone]
            .map(|state| self.history.iter().any(|item| item.state == state))
    }
}

/// What an entry did, as short as can be.
fn label(operation_json: &str) -> String {
    match Operation::from_json_text(operation_json) {
        Ok(operation) => operation.label(),
        // An import, or one of a later version.
        Err(_) => {
            let value: Option<serde_json::Value> = serde_json::from_str(operation_json).ok();
            let op = value.as_ref().and_then(|value| value.get("op")?.as_str());
            op.unwrap_or("an operation that cannot be read").to_owned()
        }
    }
}
