//! Doing again what the history says, on a new terrain: the same operations give the same heights.

use std::collections::HashMap;
use std::io::Write as _;
use std::path::Path;

use orogeny_store::{BlobHash, Entry, EntryState, NewLayer, NewTerrain, Store};

use crate::access::Access;
use crate::import::{ImportRequest, RecordedImport};
use crate::progress::report;
use crate::resources;
use crate::{Error, LayerReference, Observer, Operation, Result, Settings, Terrain};

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
        let mut layer_ids: HashMap<u32, u32> =
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
        layer_ids: &mut HashMap<u32, u32>,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        let cannot = |detail: String| Error::CannotReplay { entry: entry.id.0, detail };
        let value: serde_json::Value =
            serde_json::from_str(&entry.operation_json).map_err(|err| cannot(err.to_string()))?;
        if value.get("op").and_then(serde_json::Value::as_str) == Some(RecordedImport::OP) {
            let import: RecordedImport =
                serde_json::from_value(value).map_err(|err| cannot(err.to_string()))?;
            return self.replay_import(source, entry, import, layer_ids, observer);
        }
        let mut operation = Operation::from_json(value).map_err(|err| cannot(err.to_string()))?;
        for layer in operation.layers_mut() {
            let id = match layer {
                LayerReference::Id(id) => layer_ids.get(id).copied(),
                LayerReference::Name(_) => None,
            };
            let unknown = || cannot(format!("its layer {layer:?} does not exist"));
            *layer = LayerReference::Id(id.ok_or_else(unknown)?);
        }
        let folder = tempfile::tempdir().map_err(|err| cannot(err.to_string()))?;
        resources::unpack(operation.sources_mut(), source, folder.path())
            .map_err(|err| cannot(err.to_string()))?;
        let applied = self.submit(std::slice::from_ref(&operation), observer)?;
        let made = applied.into_iter().find_map(|applied| applied.made_layer);
        layer_ids.extend(operation.recorded_id().zip(made));
        Ok(())
    }

    fn replay_import(
        &mut self,
        source: &Store,
        entry: &Entry,
        import: RecordedImport,
        layer_ids: &mut HashMap<u32, u32>,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        let cannot = |detail: String| Error::CannotReplay { entry: entry.id.0, detail };
        let hash =
            BlobHash::from_hex(&import.blake3).ok_or_else(|| cannot("its data has no name".to_owned()))?;
        let folder = tempfile::tempdir().map_err(|err| cannot(err.to_string()))?;
        // The name is only there for its ending; a folder in it has no business here.
        let name = Path::new(&import.file).file_name().unwrap_or_else(|| "data".as_ref());
        let file = folder.path().join(name);
        let mut content = std::fs::File::create(&file).map_err(|err| cannot(err.to_string()))?;
        source.read_blob(&hash, &mut content).map_err(|err| cannot(err.to_string()))?;
        content.flush().map_err(|err| cannot(err.to_string()))?;
        drop(content);
        let layer = match import.new_layer {
            Some(name) => Some(name),
            None => {
                let id = layer_ids.get(&import.layer).copied();
                let id = id.ok_or_else(|| cannot(format!("its layer {} does not exist", import.layer)))?;
                Some(self.layer(Some(&LayerReference::Id(id)))?.name.clone())
            }
        };
        let request = ImportRequest { file, options: import.options, layer: layer.clone(), at_m: import.at };
        let done = self.import(&request, observer).map_err(|err| cannot(err.to_string()))?;
        let made = self.layer(Some(&LayerReference::Name(done.layer)))?.id;
        layer_ids.insert(import.layer, made);
        Ok(())
    }
}
