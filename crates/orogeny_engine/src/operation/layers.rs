//! The layer stack as operations.

use orogeny_field::{
    Blend, DataSource, LayerContent, LayerReference, LayerTransform, MaskSource, MaskTerm, Procedure,
};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::not_understood;
use crate::resources;
use crate::{Presets, Result};

/// A layer is made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AddLayer {
    /// What it is called; no other layer of the terrain is called so.
    pub name: String,
    /// What it is made of.
    #[serde(default)]
    pub content: LayerContent,
    /// Of heights: what they are before anything is painted, in metres.
    #[serde(default)]
    pub height: f32,
    /// The layer that it comes to lie on; `None`: the uppermost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<LayerReference>,
    /// The group that it is in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<LayerReference>,
    /// How it joins what is below; `None`: `replace` for an effect, else `add`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blend: Option<Blend>,
    /// How much it counts, 0..1.
    #[serde(default = "opaque")]
    pub opacity: f32,
    /// Whether it counts.
    #[serde(default = "yes")]
    pub visible: bool,
    /// Whether it is protected from being painted on.
    #[serde(default)]
    pub locked: bool,
    /// Where its heights lie.
    #[serde(default, skip_serializing_if = "LayerTransform::is_identity")]
    pub transform: LayerTransform,
    /// Where it counts, worked out from what lies below.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mask: Vec<MaskTerm>,
    /// Of an effect that is kept: whether it is not worked out yet, but by `refresh_layer`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub deferred: bool,
    /// Recorded: the id that it was given. Not looked at when it is done again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<u32>,
}

const fn opaque() -> f32 {
    1.0
}

const fn yes() -> bool {
    true
}

/// A layer is changed: all that is given of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SetLayer {
    /// Which one.
    pub layer: LayerReference,
    /// Its new name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Whether it counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visible: Option<bool>,
    /// Whether it is protected from being painted on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub locked: Option<bool>,
    /// How much it counts, 0..1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opacity: Option<f32>,
    /// How it joins what is below.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blend: Option<Blend>,
    /// Where its heights lie.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transform: Option<LayerTransform>,
    /// What it is made of, of the same type as before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<LayerContent>,
    /// Of an effect that is kept and gets another content: whether it is not worked out yet, but by `refresh_layer`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub deferred: bool,
}

/// A layer, or a group with its layers, is moved within the stack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MoveLayer {
    /// Which one.
    pub layer: LayerReference,
    /// The layer that it comes to lie on; `None`: it becomes the lowest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<LayerReference>,
    /// The group that it is in then; `None`: in none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<LayerReference>,
}

/// A layer is taken out of the stack; what was in a group is in the group's own group then.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RemoveLayer {
    /// Which one.
    pub layer: LayerReference,
    /// Of a group: whether its layers go too.
    #[serde(default)]
    pub members: bool,
}

/// A layer is copied, with its heights and its mask, on top of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DuplicateLayer {
    /// Which one.
    pub layer: LayerReference,
    /// What the copy is called; `None`: as the layer, with `copy` after it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Recorded: the id that the copy was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<u32>,
}

/// What a layer shows is baked into its heights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CollapseLayer {
    /// Which one.
    pub layer: LayerReference,
    /// Whether all that is below goes into it too: it is the lowest layer then, alone, and shows what all of them came to.
    #[serde(default)]
    pub below: bool,
}

/// What a mask is painted with anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MaskFrom {
    /// It stays as it is painted.
    #[default]
    Keep,
    /// It counts everywhere.
    All,
    /// It counts nowhere.
    Nothing,
    /// It counts where something is selected.
    Selection,
}

/// A layer's mask is changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SetMask {
    /// Whose.
    pub layer: LayerReference,
    /// What it is painted with.
    #[serde(default)]
    pub from: MaskFrom,
    /// A brush for masks that paints it, over a mask that counts nowhere, as a fill of the whole terrain: where water gathers, say.
    /// What it came to is kept, and can be refreshed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub brush: Option<Procedure>,
    /// Whether what is painted is inverted then.
    #[serde(default)]
    pub invert: bool,
    /// What it is multiplied by then, 0..1: less fades the layer.
    #[serde(default = "whole")]
    pub scale: f32,
    /// Where it counts besides, worked out from what lies below; `None`: as before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub terms: Option<Vec<MaskTerm>>,
}

const fn whole() -> f32 {
    1.0
}

/// An effect that is kept is worked out anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RefreshLayer {
    /// Which one.
    pub layer: LayerReference,
}

/// What is done to the layer stack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub enum LayerOperation {
    /// A layer is made.
    AddLayer(AddLayer),
    /// A layer is changed.
    SetLayer(SetLayer),
    /// A layer is moved within the stack.
    MoveLayer(MoveLayer),
    /// A layer is taken out of the stack.
    RemoveLayer(RemoveLayer),
    /// A layer is copied.
    DuplicateLayer(DuplicateLayer),
    /// What a layer shows is baked into its heights.
    CollapseLayer(CollapseLayer),
    /// A layer's mask is changed.
    SetMask(SetMask),
    /// An effect that is kept is worked out anew.
    RefreshLayer(RefreshLayer),
}

impl LayerOperation {
    /// The `op`s that it reads.
    pub(super) const NAMES: [&str; 8] = [
        "add_layer",
        "set_layer",
        "move_layer",
        "remove_layer",
        "duplicate_layer",
        "collapse_layer",
        "set_mask",
        "refresh_layer",
    ];

    /// Reads one whose brush may name any of these presets.
    ///
    /// # Errors
    /// As [`super::Operation::from_json_with`].
    pub(super) fn from_json_with(mut value: Value, presets: &Presets) -> Result<Self> {
        for place in ["/content/brush", "/brush/brush"] {
            if let Some(brush) = value.pointer_mut(place)
                && let Value::Object(object) = brush
            {
                *brush = Value::Object(presets.brush(object)?.to_json());
            }
        }
        let operation: Self =
            serde_json::from_value(value).map_err(|err| not_understood("the operation", &err))?;
        if let Some(content) = operation.content() {
            content.check()?;
        }
        Ok(operation)
    }

    /// Its `op`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::AddLayer(_) => "add_layer",
            Self::SetLayer(_) => "set_layer",
            Self::MoveLayer(_) => "move_layer",
            Self::RemoveLayer(_) => "remove_layer",
            Self::DuplicateLayer(_) => "duplicate_layer",
            Self::CollapseLayer(_) => "collapse_layer",
            Self::SetMask(_) => "set_mask",
            Self::RefreshLayer(_) => "refresh_layer",
        }
    }

    /// The layer that it is for; none of one that is made.
    #[must_use]
    pub const fn layer(&self) -> Option<&LayerReference> {
        match self {
            Self::AddLayer(_) => None,
            Self::SetLayer(SetLayer { layer, .. })
            | Self::MoveLayer(MoveLayer { layer, .. })
            | Self::RemoveLayer(RemoveLayer { layer, .. })
            | Self::DuplicateLayer(DuplicateLayer { layer, .. })
            | Self::CollapseLayer(CollapseLayer { layer, .. })
            | Self::SetMask(SetMask { layer, .. })
            | Self::RefreshLayer(RefreshLayer { layer }) => Some(layer),
        }
    }

    /// All layers that it names.
    pub(crate) fn layers_mut(&mut self) -> Vec<&mut LayerReference> {
        let mut layers: Vec<&mut LayerReference> = Vec::new();
        let terms: &mut [MaskTerm] = match self {
            Self::AddLayer(AddLayer { above, group, mask, .. }) => {
                layers.extend(above.iter_mut().chain(group));
                mask
            }
            Self::MoveLayer(MoveLayer { layer, above, group }) => {
                layers.push(layer);
                layers.extend(above.iter_mut().chain(group));
                &mut []
            }
            Self::SetMask(SetMask { layer, terms, .. }) => {
                layers.push(layer);
                terms.as_deref_mut().unwrap_or_default()
            }
            Self::SetLayer(SetLayer { layer, .. })
            | Self::RemoveLayer(RemoveLayer { layer, .. })
            | Self::DuplicateLayer(DuplicateLayer { layer, .. })
            | Self::CollapseLayer(CollapseLayer { layer, .. })
            | Self::RefreshLayer(RefreshLayer { layer }) => {
                layers.push(layer);
                &mut []
            }
        };
        layers.extend(terms.iter_mut().filter_map(|term| term.source.layer_mut()));
        layers
    }

    /// The id that was recorded of the layer that it made.
    pub(crate) const fn recorded_id(&self) -> Option<u32> {
        match self {
            Self::AddLayer(AddLayer { id, .. }) | Self::DuplicateLayer(DuplicateLayer { id, .. }) => *id,
            _ => None,
        }
    }

    /// What the layer is to be made of.
    #[must_use]
    pub const fn content(&self) -> Option<&LayerContent> {
        match self {
            Self::AddLayer(AddLayer { content, .. }) => Some(content),
            Self::SetLayer(SetLayer { content, .. }) => content.as_ref(),
            _ => None,
        }
    }

    /// All data from outside that it names.
    pub(super) fn sources_mut(&mut self) -> Vec<&mut DataSource> {
        let mut of_mask = None;
        let (content, terms): (Option<&mut LayerContent>, &mut [MaskTerm]) = match self {
            Self::AddLayer(AddLayer { content, mask, .. }) => (Some(content), mask),
            Self::SetLayer(SetLayer { content, .. }) => (content.as_mut(), &mut []),
            Self::SetMask(SetMask { brush, terms, .. }) => {
                of_mask = brush.as_mut().map(|procedure| &mut *procedure.brush);
                (None, terms.as_deref_mut().unwrap_or_default())
            }
            _ => (None, &mut []),
        };
        let brush = content.and_then(|content| Some(&mut *content.procedure_mut()?.brush)).or(of_mask);
        let of_terms = terms.iter_mut().filter_map(|term| match &mut term.source {
            MaskSource::Gate(gate) => resources::image_of(Some(gate)),
            MaskSource::Heights { .. } | MaskSource::Mask(_) => None,
        });
        brush.into_iter().flat_map(resources::sources).chain(of_terms).collect()
    }

    /// Writes it as the history records it.
    ///
    /// # Errors
    /// [`crate::Error::Operation`] should a number in it have no JSON form.
    pub(crate) fn to_json(&self) -> Result<String> {
        serde_json::to_string(self).map_err(|err| not_understood("the operation", &err))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_recorded_reads_back_and_every_name_is_read() {
        let texts = [
            r#"{"op": "add_layer", "name": "Ridges", "content": {"type": "procedural", "brush": {"type": "noise"}},
                "mask": [{"gate": {"slope": {"min": 10, "max": 90}}}], "opacity": 0.5, "blend": "max"}"#,
            r#"{"op": "set_layer", "layer": 3, "visible": false, "transform": {"move": [10, 0], "rotate": 30}}"#,
            r#"{"op": "move_layer", "layer": "Ridges", "above": "Base"}"#,
            r#"{"op": "remove_layer", "layer": "Ridges"}"#,
            r#"{"op": "duplicate_layer", "layer": "Ridges"}"#,
            r#"{"op": "collapse_layer", "layer": "Ridges", "below": true}"#,
            r#"{"op": "set_mask", "layer": "Ridges", "brush": {"brush": {"type": "flow_mask"}}, "invert": true, "scale": 0.5}"#,
            r#"{"op": "refresh_layer", "layer": 9}"#,
        ];
        for (text, name) in texts.into_iter().zip(LayerOperation::NAMES) {
            let value = serde_json::from_str(text).unwrap();
            let operation = LayerOperation::from_json_with(value, Presets::factory()).unwrap();
            assert_eq!(operation.name(), name);
            let again = serde_json::from_str(&operation.to_json().unwrap()).unwrap();
            assert_eq!(LayerOperation::from_json_with(again, Presets::factory()).unwrap(), operation);
        }
    }
}
