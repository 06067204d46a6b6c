//! What the history says was done, as something that can be done again.

use std::collections::HashMap;
use std::path::Path;

use orogeny_store::{BlobHash, Entry};

use crate::import::{ImportRequest, RecordedImport};
use crate::{LayerReference, Operation, Result};

/// An entry of the history.
#[expect(clippy::large_enum_variant, reason = "few are in memory at once")]
pub(crate) enum Recorded {
    Operation(Operation),
    Import(RecordedImport),
}

impl Recorded {
    /// # Errors
    /// What cannot be understood, for people.
    pub(crate) fn of(entry: &Entry) -> std::result::Result<Self, String> {
        let value: serde_json::Value =
            serde_json::from_str(&entry.operation_json).map_err(|err| err.to_string())?;
        if value.get("op").and_then(serde_json::Value::as_str) == Some(RecordedImport::OP) {
            return serde_json::from_value(value).map(Self::Import).map_err(|err| err.to_string());
        }
        Operation::from_json(value).map(Self::Operation).map_err(|err| err.to_string())
    }

    /// Names the layers by the ids that they have now.
    ///
    /// # Errors
    /// Which layer there is not, for people.
    pub(crate) fn name_layers(
        &mut self,
        id_of: impl Fn(u32) -> Option<u32>,
    ) -> std::result::Result<(), String> {
        let unknown = |layer: &dyn std::fmt::Debug| format!("its layer {layer:?} does not exist");
        match self {
            Self::Operation(operation) => {
                for layer in operation.layers_mut() {
                    let id = match layer {
                        LayerReference::Id(id) => id_of(*id),
                        LayerReference::Name(_) => None,
                    };
                    *layer = LayerReference::Id(id.ok_or_else(|| unknown(layer))?);
                }
            }
            // One that it makes is not there yet.
            Self::Import(import) if import.new_layer.is_some() => {}
            Self::Import(import) => {
                import.layer = id_of(import.layer).ok_or_else(|| unknown(&import.layer))?;
            }
        }
        Ok(())
    }

    /// The id that was recorded of the layer that it made.
    pub(crate) const fn made_layer(&self) -> Option<u32> {
        match self {
            Self::Operation(operation) => operation.recorded_id(),
            Self::Import(RecordedImport { new_layer: Some(_), layer, .. }) => Some(*layer),
            Self::Import(_) => None,
        }
    }
}

/// New ids of layers, by those that the history knows them by.
pub(crate) type LayerIds = HashMap<u32, u32>;

impl RecordedImport {
    /// The import from a file in a folder, to which `read` writes the data of that name.
    ///
    /// # Errors
    /// Why it cannot be done again, for people.
    pub(crate) fn request(
        self,
        folder: &Path,
        layer: String,
        read: impl FnOnce(BlobHash, std::fs::File) -> Result<()>,
    ) -> std::result::Result<ImportRequest, String> {
        let hash = BlobHash::from_hex(&self.blake3).ok_or("its data has no name")?;
        // The name is only there for its ending; a folder in it has no business here.
        let name = Path::new(&self.file).file_name().unwrap_or_else(|| "data".as_ref());
        let file = folder.join(name);
        let content = std::fs::File::create(&file).map_err(|err| err.to_string())?;
        read(hash, content).map_err(|err| err.to_string())?;
        Ok(ImportRequest { file, options: self.options, layer: Some(layer), at_m: self.at })
    }
}
