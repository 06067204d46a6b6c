//! Operations: what changes a terrain, as JSON and as values.

mod brush;
mod layers;
pub(crate) mod select;

use std::path::Path;

use orogeny_field::{Brush, DataSource, LayerReference, Selecting};
use serde::Deserialize;
use serde_json::Value;

pub use brush::{BrushOperation, Target};
pub use layers::{
    AddLayer, CollapseLayer, DuplicateLayer, LayerOperation, MaskFrom, MoveLayer, RefreshLayer, RemoveLayer,
    SetLayer, SetMask,
};

use crate::resources;
use crate::{Error, Presets, Result};

/// Something that changes a terrain.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "most operations are brushes, and few are in memory at once")]
pub enum Operation {
    /// A brush is applied.
    Brush(BrushOperation),
    /// The layer stack, or a layer's mask, is changed.
    Layers(LayerOperation),
    /// The terrain's selection is changed.
    Select(Selecting),
}

impl Operation {
    /// Reads an operation from JSON text. Its brush may name a preset that comes with the program.
    ///
    /// # Errors
    /// As [`Self::from_json_with`].
    pub fn from_json_text(text: &str) -> Result<Self> {
        let value = serde_json::from_str(text).map_err(|err| not_understood("the operation", &err))?;
        Self::from_json(value)
    }

    /// Reads an operation. Its brush may name a preset that comes with the program.
    ///
    /// # Errors
    /// As [`Self::from_json_with`].
    pub fn from_json(value: Value) -> Result<Self> {
        Self::from_json_with(value, Presets::factory())
    }

    /// Reads an operation whose brush may name any of these presets. The operation holds the whole brush then: what becomes
    /// of the preset does not matter to it.
    ///
    /// # Errors
    /// [`Error::Operation`] or [`Error::Field`], naming the field; [`Error::UnknownPreset`].
    pub fn from_json_with(value: Value, presets: &Presets) -> Result<Self> {
        let name = value.get("op").and_then(Value::as_str).unwrap_or_default();
        if BrushOperation::NAMES.contains(&name) {
            return Ok(Self::Brush(BrushOperation::from_json_with(value, presets)?));
        }
        if LayerOperation::NAMES.contains(&name) {
            return Ok(Self::Layers(LayerOperation::from_json_with(value, presets)?));
        }
        if name == select::NAME {
            return Ok(Self::Select(select::from_json(value)?));
        }
        let known: Vec<_> = BrushOperation::NAMES
            .iter()
            .chain(&LayerOperation::NAMES)
            .chain([&select::NAME])
            .map(|name| format!("`{name}`"))
            .collect();
        Err(Error::Operation {
            place: "the operation".to_owned(),
            detail: format!("`op` is `{name}`, it must be one of {}", known.join(", ")),
        })
    }

    /// Its `op`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Brush(operation) => operation.name(),
            Self::Layers(operation) => operation.name(),
            Self::Select(_) => select::NAME,
        }
    }

    /// What it does, as short as can be: `stroke raise`, `add_layer`.
    #[must_use]
    pub fn label(&self) -> String {
        match self.brush() {
            Some(brush) => format!("{} {}", self.name(), brush.brush_type.name()),
            None => self.name().to_owned(),
        }
    }

    /// What it is done with; of a layer, what it is to be made of.
    #[must_use]
    pub fn brush(&self) -> Option<&Brush> {
        match self {
            Self::Brush(operation) => Some(operation.brush()),
            Self::Layers(operation) => {
                operation.content().and_then(|content| Some(&*content.procedure()?.brush))
            }
            Self::Select(_) => None,
        }
    }

    /// All data from outside that it names.
    pub(crate) fn sources_mut(&mut self) -> Vec<&mut DataSource> {
        match self {
            Self::Brush(operation) => resources::sources(operation.brush_mut()).collect(),
            Self::Layers(operation) => operation.sources_mut(),
            Self::Select(selecting) => resources::image_of(selecting.gate_mut()).into_iter().collect(),
        }
    }

    /// Lets it read files of one folder alone, by names relative to it; of none for `None`. For operations that someone else gave, who is not
    /// to read what is not theirs. Links that lead out of the folder count as out of it.
    ///
    /// # Errors
    /// [`Error::FileNotAllowed`] for a name that leads elsewhere, or to nothing.
    pub fn keep_files_below(&mut self, folder: Option<&Path>) -> Result<()> {
        resources::keep_files_below(self.sources_mut(), folder)
    }

    /// The id that was recorded of the layer that it made.
    pub(crate) const fn recorded_id(&self) -> Option<u32> {
        match self {
            Self::Brush(_) | Self::Select(_) => None,
            Self::Layers(operation) => operation.recorded_id(),
        }
    }

    /// All layers that it names.
    pub(crate) fn layers_mut(&mut self) -> Vec<&mut LayerReference> {
        match self {
            Self::Brush(operation) => operation.layers_mut(),
            Self::Layers(operation) => operation.layers_mut(),
            Self::Select(selecting) => selecting.layer_mut().into_iter().collect(),
        }
    }

    /// The layer it is for; of a brush `None` is the lowest.
    #[must_use]
    pub const fn layer(&self) -> Option<&LayerReference> {
        match self {
            Self::Brush(operation) => operation.layer(),
            Self::Layers(operation) => operation.layer(),
            Self::Select(selecting) => selecting.layer(),
        }
    }
}

/// Operations to be run together: all of them, or on an error none.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// In order.
    pub operations: Vec<Operation>,
}

impl Recipe {
    /// Reads `{"operations": […]}`, whose brushes may name any of these presets.
    ///
    /// # Errors
    /// [`Error::Operation`] naming the operation and the field.
    pub fn from_json_text(text: &str, presets: &Presets) -> Result<Self> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Fields {
            operations: Vec<Value>,
        }
        let fields: Fields = serde_json::from_str(text).map_err(|err| not_understood("the recipe", &err))?;
        let count = fields.operations.len();
        let read = |(index, value)| {
            Operation::from_json_with(value, presets).map_err(|err| Error::Operation {
                place: format!("operation {} of {count} of the recipe", index + 1),
                detail: match err {
                    Error::Operation { detail, .. } => detail,
                    other => other.to_string(),
                },
            })
        };
        let operations = fields.operations.into_iter().enumerate().map(read).collect::<Result<_>>()?;
        Ok(Self { operations })
    }

    /// Takes relative names of files that its brushes use as relative to a folder: that of the recipe.
    pub fn resolve_files(&mut self, folder: &Path) {
        for operation in &mut self.operations {
            resources::resolve_files(operation.sources_mut(), folder);
        }
    }
}

pub(super) fn not_understood(place: &str, err: &serde_json::Error) -> Error {
    Error::Operation { place: place.to_owned(), detail: err.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_recorded_reads_back_as_the_same_operation_on_the_layer_id() {
        for text in [
            r#"{"op": "stroke", "layer": "Base", "seed": 7,
                "brush": {"type": "raise", "radius": 41.3, "falloff": 12.7, "strength": 0.1},
                "points": [[512, 480], [600.123456789, 500, 0.8], [700, 620, 1.0, 0.25]]}"#,
            r#"{"op": "fill", "brush": {"type": "set_height", "height": 12.25, "strength": 0.3}, "region": [0, 1, 2, 3]}"#,
            r#"{"op": "fill", "layer": 3, "brush": {"type": "roughen"}, "seed": 4000000000}"#,
        ] {
            let Operation::Brush(operation) = Operation::from_json_text(text).unwrap() else {
                panic!("{text}")
            };
            let again = Operation::from_json_text(&operation.to_recorded_json(3).unwrap()).unwrap();
            assert_eq!(again.layer(), Some(&LayerReference::Id(3)));
            let Operation::Brush(again) = again else { panic!("{text}") };
            let same = match (operation, again) {
                (BrushOperation::Stroke { stroke: a, .. }, BrushOperation::Stroke { stroke: b, .. }) => {
                    a == b
                }
                (
                    BrushOperation::Fill { brush: a, seed: b, region_m: c, .. },
                    BrushOperation::Fill { brush: d, seed: e, region_m: f, .. },
                ) => (a, b, c) == (d, e, f),
                _ => false,
            };
            assert!(same, "{text}");
        }
    }

    #[test]
    fn a_bad_recipe_says_which_operation_and_which_field() {
        for (text, words) in [
            ("", &["the recipe"][..]),
            ("{}", &["operations"]),
            (r#"{"operations": [], "more": 1}"#, &["more"]),
            (r#"{"operations": [{"op": "melt"}]}"#, &["operation 1 of 1", "melt"]),
            (
                r#"{"operations": [{"op": "fill", "brush": {"type": "raise"}, "regoin": [0, 0, 1, 1]}]}"#,
                &["regoin"],
            ),
            (
                r#"{"operations": [{"op": "stroke", "brush": {"type": "raise", "radius": 0}, "points": [[1, 1]]}]}"#,
                &["radius"],
            ),
            (
                r#"{"operations": [{"op": "stroke", "brush": {"type": "raise"}, "points": [[1]]}]}"#,
                &["point"],
            ),
            (
                r#"{"operations": [{"op": "fill", "brush": {"preset": "Trensh"}}]}"#,
                &["operation 1 of 1", "Trensh", "`Trench`"],
            ),
        ] {
            let err = Recipe::from_json_text(text, Presets::factory()).unwrap_err().to_string();
            for word in words {
                assert!(err.contains(word), "{text}: {err}");
            }
        }
    }
}
