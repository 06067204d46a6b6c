//! Operations: what changes a terrain, as JSON and as values.

use std::path::Path;

use orogeny_field::{Brush, LayerReference, PointerSample, Stroke};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::resources;
use crate::{Error, Presets, Result};

/// Which field of a layer, or of the terrain, is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// The layer's heights.
    Heights,
    /// The layer's mask, 0..1; one that was never painted is 1 everywhere.
    Mask,
    /// The terrain's selection, 0..1, which gates look at; at first nothing is selected.
    Selection,
}

impl Target {
    /// Where a brush goes that does not say: brushes for masks to the mask, all others to the heights.
    const fn of(brush: &Brush) -> Self {
        if brush.brush_type.is_for_masks() { Self::Mask } else { Self::Heights }
    }
}

/// Something that changes a terrain.
#[derive(Debug, Clone, PartialEq)]
pub enum Operation {
    /// A brush drawn along points.
    Stroke {
        /// Where; `None`: the lowest layer.
        layer: Option<LayerReference>,
        /// Which field.
        target: Target,
        /// What.
        stroke: Stroke,
    },
    /// A brush applied once over a region at full weight.
    Fill {
        /// Where; `None`: the lowest layer.
        layer: Option<LayerReference>,
        /// Which field.
        target: Target,
        /// What.
        brush: Brush,
        /// Feeds everything random in it.
        seed: u32,
        /// `[x, z, width, depth]` in metres, far edges outside; `None`: the whole terrain.
        region_m: Option<[f64; 4]>,
    },
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StrokeFields {
    op: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    layer: Option<LayerReference>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    target: Option<Target>,
    #[serde(default)]
    seed: u32,
    brush: Map<String, Value>,
    points: Vec<PointerSample>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FillFields {
    op: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    layer: Option<LayerReference>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    target: Option<Target>,
    #[serde(default)]
    seed: u32,
    brush: Map<String, Value>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    region: Option<[f64; 4]>,
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
        let understood = |err: serde_json::Error| not_understood("the operation", &err);
        let name = value.get("op").and_then(Value::as_str).unwrap_or_default().to_owned();
        match name.as_str() {
            "stroke" => {
                let fields: StrokeFields = serde_json::from_value(value).map_err(understood)?;
                let brush = presets.brush(&fields.brush)?;
                let target = target(fields.target, &brush)?;
                let stroke = Stroke { brush, seed: fields.seed, points: fields.points };
                Ok(Self::Stroke { layer: fields.layer, target, stroke })
            }
            "fill" => {
                let fields: FillFields = serde_json::from_value(value).map_err(understood)?;
                let brush = presets.brush(&fields.brush)?;
                let target = target(fields.target, &brush)?;
                Ok(Self::Fill {
                    layer: fields.layer,
                    target,
                    brush,
                    seed: fields.seed,
                    region_m: fields.region,
                })
            }
            _ => Err(Error::Operation {
                place: "the operation".to_owned(),
                detail: format!("`op` is `{name}`, it must be `stroke` or `fill`"),
            }),
        }
    }

    /// Writes the operation with all parameters, on the layer of the given id: what the history records.
    ///
    /// # Errors
    /// [`Error::Operation`] should a number in it have no JSON form.
    pub fn to_recorded_json(&self, layer_id: u32) -> Result<String> {
        let layer = Some(LayerReference::Id(layer_id));
        let target = Some(self.target());
        let op = self.name().to_owned();
        let text = match self {
            Self::Stroke { stroke, .. } => serde_json::to_string(&StrokeFields {
                op,
                layer,
                target,
                seed: stroke.seed,
                brush: stroke.brush.to_json(),
                points: stroke.points.clone(),
            }),
            Self::Fill { brush, seed, region_m, .. } => serde_json::to_string(&FillFields {
                op,
                layer,
                target,
                seed: *seed,
                brush: brush.to_json(),
                region: *region_m,
            }),
        };
        text.map_err(|err| not_understood("the operation", &err))
    }

    /// Its `op`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Stroke { .. } => "stroke",
            Self::Fill { .. } => "fill",
        }
    }

    /// What it is done with.
    #[must_use]
    pub const fn brush(&self) -> &Brush {
        match self {
            Self::Stroke { stroke, .. } => &stroke.brush,
            Self::Fill { brush, .. } => brush,
        }
    }

    /// Which field it changes.
    #[must_use]
    pub const fn target(&self) -> Target {
        match self {
            Self::Stroke { target, .. } | Self::Fill { target, .. } => *target,
        }
    }

    /// The same with another brush.
    #[must_use]
    pub(crate) fn with_brush(mut self, new: Brush) -> Self {
        *self.brush_mut() = new;
        self
    }

    pub(crate) const fn brush_mut(&mut self) -> &mut Brush {
        match self {
            Self::Stroke { stroke, .. } => &mut stroke.brush,
            Self::Fill { brush, .. } => brush,
        }
    }

    /// The layer it is for; `None`: the lowest.
    #[must_use]
    pub const fn layer(&self) -> Option<&LayerReference> {
        match self {
            Self::Stroke { layer, .. } | Self::Fill { layer, .. } => layer.as_ref(),
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
            resources::resolve_files(operation.brush_mut(), folder);
        }
    }
}

/// Where an operation goes.
fn target(given: Option<Target>, brush: &Brush) -> Result<Target> {
    let target = given.unwrap_or_else(|| Target::of(brush));
    if target == Target::Heights && brush.brush_type.is_for_masks() {
        let detail =
            format!("`target` is `heights`, and `{}` is for masks and selections", brush.brush_type.name());
        return Err(Error::Operation { place: "the operation".to_owned(), detail });
    }
    Ok(target)
}

fn not_understood(place: &str, err: &serde_json::Error) -> Error {
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
            let operation = Operation::from_json_text(text).unwrap();
            let again = Operation::from_json_text(&operation.to_recorded_json(3).unwrap()).unwrap();
            assert_eq!(again.layer(), Some(&LayerReference::Id(3)));
            let same = match (operation, again) {
                (Operation::Stroke { stroke: a, .. }, Operation::Stroke { stroke: b, .. }) => a == b,
                (
                    Operation::Fill { brush: a, seed: b, region_m: c, .. },
                    Operation::Fill { brush: d, seed: e, region_m: f, .. },
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
