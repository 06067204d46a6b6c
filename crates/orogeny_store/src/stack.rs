//! The layers and fields of a terrain, in memory and in the file.

use std::collections::BTreeMap;

use orogeny_field::{Blend, FieldId, LayerContent, LayerTransform, PageKey};

use crate::database::Database;
use crate::rows::{Document, LayerChange};
use crate::{EntryId, Error, Field, FieldKind, Layer, NewLayer, Result};

/// The layers, and all fields.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stack {
    pub(crate) layers: Vec<Layer>,
    pub(crate) fields: BTreeMap<FieldId, Field>,
}

impl Stack {
    pub(crate) fn load(db: &Database) -> Result<Self> {
        let fields = db.fields()?;
        let mut layers = Vec::new();
        for saved in db.saved_layers()? {
            let wrong = |detail: String| Error::damaged(db.path(), format!("layer {}: {detail}", saved.id));
            let mut layer: Layer =
                serde_json::from_str(&saved.state).map_err(|err| wrong(err.to_string()))?;
            let field = |id: FieldId, kind: FieldKind| {
                fields
                    .get(&id)
                    .filter(|field| field.kind == kind)
                    .ok_or_else(|| wrong(format!("its field {} does not exist", id.0)))
            };
            layer.constant_m = field(layer.heights, FieldKind::Heights)?.constant;
            if let Some(mask) = layer.mask {
                layer.mask_constant = field(mask, FieldKind::Mask)?.constant;
            }
            layers.push(layer);
        }
        layers.sort_by_key(|layer| (layer.position, layer.id));
        Ok(Self { layers, fields })
    }

    /// What a field holds where it has no page; 0 for one that does not exist.
    pub(crate) fn constant(&self, key: &PageKey) -> f32 {
        self.fields.get(&key.field).map_or(0.0, |field| field.constant)
    }

    /// Makes a field, here and in the file.
    pub(crate) fn add_field(
        &mut self,
        db: &Database,
        document: &mut Document,
        field: Field,
    ) -> Result<FieldId> {
        let id = document.next_field()?;
        db.insert_field(id, field)?;
        self.fields.insert(id, field);
        Ok(id)
    }

    /// Puts a new layer on top, here and in the file, as a change that `entry` makes.
    pub(crate) fn add(
        &mut self,
        db: &Database,
        document: &mut Document,
        entry: EntryId,
        new: NewLayer,
    ) -> Result<Layer> {
        let heights = Field { kind: FieldKind::Heights, constant: new.constant_m };
        let layer = Layer {
            id: document.next_layer()?,
            position: self.layers.last().map_or(0, |top| top.position.saturating_add(1)),
            name: new.name,
            content: LayerContent::Heights,
            heights: self.add_field(db, document, heights)?,
            constant_m: new.constant_m,
            mask: None,
            mask_constant: 0.0,
            mask_terms: Vec::new(),
            visible: true,
            locked: false,
            opacity: 1.0,
            blend: Blend::default(),
            transform: LayerTransform::default(),
            group: None,
            made_of: None,
            made_mask: None,
        };
        let state = layer.to_state()?;
        db.set_layer(layer.id, Some(&state))?;
        db.insert_layer_change(entry, &LayerChange { layer: layer.id, before: None, after: Some(state) })?;
        self.layers.push(layer.clone());
        Ok(layer)
    }
}
