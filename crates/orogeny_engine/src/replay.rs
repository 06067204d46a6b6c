//! Doing again what the history says, on a new terrain: the same operations give the same heights.

use std::path::Path;

use orogeny_store::{Entry, EntryState, NewLayer, NewTerrain, Store};

use crate::access::Access;
use crate::progress::report;
use crate::recorded::{LayerIds, Recorded};
use crate::resources;
use crate::{Error, LayerReference, Observer, Result, Settings, Terrain};

/// What a replay did.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Replayed {
    /// Operations that were done again.
    pub num_operations: u64,
    /// Operations of the history that do not show, and were left out.
    pub num_left_out: u64,
}

impl Terrain {
    /// Makes a new terrain at `to` by doing again every operation that shows, in order, with the data from outside that the
    /// history keeps. Its heights are those of this terrain, bit for bit, on the same back end.
    ///
    /// # Errors
    /// [`Error::CannotReplay`] when the history does not reach back to the beginning, or an operation of it cannot be done
    /// again; [`Error::Store`] when there is a file at `to` already; [`Error::Cancelled`]. Nothing is left behind then.
    pub fn replay(&self, to: &Path, settings: Settings, observer: &mut dyn Observer) -> Result<Replayed> {
        let store = self.settled()?;
        let original = store.original_layers()?.ok_or_else(|| Error::CannotReplay {
            entry: 0,
            detail: "its oldest operations were dropped from the history".to_owned(),
        })?;
        let new = NewTerrain {
            grid: store.grid(),
            layout: store.layout(),
            layers: original
                .iter()
                .map(|layer| NewLayer { name: layer.name.clone(), constant_m: layer.constant_m })
                .collect(),
        };
        let mut copy =
            Self::of(Access::writing(Store::create(to, &new)?, settings.page_budget_in_bytes)?, settings)?;
        let done = copy.replay_log(store, observer);
        match done {
            Ok(replayed) => {
                copy.close()?;
                Ok(replayed)
            }
            Err(err) => {
                copy.remove();
                Err(err)
            }
        }
    }

    fn replay_log(&mut self, source: &Store, observer: &mut dyn Observer) -> Result<Replayed> {
        let log = source.log()?;
        // Ids are given out once: those of layers that were undone are missing in the source.
        let original = source.original_layers()?.unwrap_or_default();
        let mut layer_ids: LayerIds =
            original.iter().map(|layer| layer.id).zip(self.layers()?.iter().map(|layer| layer.id)).collect();
        let applied: Vec<&Entry> = log.iter().filter(|entry| entry.state == EntryState::Applied).collect();
        for (done, entry) in applied.iter().enumerate() {
            self.replay_entry(source, entry, &mut layer_ids, observer)?;
            report(observer, "replaying", done as u64 + 1, applied.len() as u64)?;
        }
        self.flush()?;
        let num_operations = applied.len() as u64;
        Ok(Replayed { num_operations, num_left_out: log.len() as u64 - num_operations })
    }

    fn replay_entry(
        &mut self,
        source: &Store,
        entry: &Entry,
        layer_ids: &mut LayerIds,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        let cannot = |detail: String| Error::CannotReplay { entry: entry.id.0, detail };
        let mut recorded = Recorded::of(entry).map_err(cannot)?;
        let made_layer = recorded.made_layer();
        recorded.name_layers(|id| layer_ids.get(&id).copied()).map_err(cannot)?;
        let folder = tempfile::tempdir().map_err(|err| cannot(err.to_string()))?;
        let mut operation = match recorded {
            Recorded::Operation(operation) => operation,
            Recorded::Import(import) => {
                let layer = match &import.new_layer {
                    Some(name) => name.clone(),
                    None => self.layer(Some(&LayerReference::Id(import.layer)))?.name.clone(),
                };
                let read = |hash, mut file: std::fs::File| Ok(source.read_blob(&hash, &mut file)?);
                let request = import.request(folder.path(), layer, read).map_err(cannot)?;
                let done = self.import(&request, observer).map_err(|err| cannot(err.to_string()))?;
                let made = self.layer(Some(&LayerReference::Name(done.layer)))?.id;
                layer_ids.extend(made_layer.map(|before| (before, made)));
                return Ok(());
            }
        };
        resources::unpack(operation.sources_mut(), source, folder.path())
            .map_err(|err| cannot(err.to_string()))?;
        let applied = self.submit(std::slice::from_ref(&operation), observer)?;
        let made = applied.into_iter().find_map(|applied| applied.made_layer);
        layer_ids.extend(made_layer.zip(made));
        Ok(())
    }
}
