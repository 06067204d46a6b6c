//! Brushes as operations: a stroke, a fill.

use orogeny_field::{Brush, LayerReference, PointerSample, Stroke, TerrainGrid};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::not_understood;
use crate::{Error, Presets, Result};

/// Which field of a layer, or of the terrain, is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// The heights that are seen, of which a layer that adds to what is below it keeps the difference; of any other layer its own
    /// heights.
    Seen,
    /// The layer's own heights, whatever they come to with what is below.
    Heights,
    /// The layer's mask, 0..1; one that was never painted is 1 everywhere.
    Mask,
    /// The terrain's selection, 0..1, which gates look at; at first nothing is selected.
    Selection,
}

impl Target {
    /// Where a brush goes that does not say: brushes for masks to the mask, all others to the heights that are seen.
    const fn of(brush: &Brush) -> Self {
        if brush.brush_type.is_for_masks() { Self::Mask } else { Self::Seen }
    }

    /// Whether it is heights, and no mask.
    pub(crate) const fn is_heights(self) -> bool {
        matches!(self, Self::Seen | Self::Heights)
    }
}

/// A brush that is applied.
#[derive(Debug, Clone, PartialEq)]
pub enum BrushOperation {
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

impl BrushOperation {
    /// The `op`s that it reads.
    pub(super) const NAMES: [&str; 2] = ["stroke", "fill"];

    /// Reads one whose brush may name any of these presets.
    ///
    /// # Errors
    /// As [`super::Operation::from_json_with`].
    pub(super) fn from_json_with(value: Value, presets: &Presets) -> Result<Self> {
        let understood = |err: serde_json::Error| not_understood("the operation", &err);
        if value.get("op").and_then(Value::as_str) == Some("stroke") {
            let fields: StrokeFields = serde_json::from_value(value).map_err(understood)?;
            let brush = presets.brush(&fields.brush)?;
            let target = target(fields.target, &brush)?;
            let stroke = Stroke { brush, seed: fields.seed, points: fields.points };
            return Ok(Self::Stroke { layer: fields.layer, target, stroke });
        }
        let fields: FillFields = serde_json::from_value(value).map_err(understood)?;
        let brush = presets.brush(&fields.brush)?;
        let target = target(fields.target, &brush)?;
        Ok(Self::Fill { layer: fields.layer, target, brush, seed: fields.seed, region_m: fields.region })
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

    /// The points of a stroke.
    pub(crate) fn points(&self) -> Option<Vec<PointerSample>> {
        match self {
            Self::Stroke { stroke, .. } => Some(stroke.points.clone()),
            Self::Fill { .. } => None,
        }
    }

    /// Gives a stroke its points.
    pub(crate) fn set_points(&mut self, points: Vec<PointerSample>) {
        if let Self::Stroke { stroke, .. } = self {
            stroke.points = points;
        }
    }

    /// Where its brush acts when it is held over a place: there, and at its copies. In metres.
    #[must_use]
    pub fn copies_m(&self, grid: &TerrainGrid, place_m: [f64; 2]) -> Vec<[f64; 2]> {
        let copies = orogeny_brush::copies(self.brush(), grid, grid.sample_from_world(place_m));
        copies.into_iter().map(|place| place.map(|along| along * grid.spacing_m())).collect()
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

    /// All layers that it names.
    pub(super) fn layers_mut(&mut self) -> Vec<&mut LayerReference> {
        let (layer, brush) = match self {
            Self::Stroke { layer, stroke, .. } => (layer, &mut stroke.brush),
            Self::Fill { layer, brush, .. } => (layer, brush),
        };
        layer.iter_mut().chain(&mut brush.cloning.source.layer).collect()
    }

    /// The layer it is for; `None`: the lowest.
    #[must_use]
    pub const fn layer(&self) -> Option<&LayerReference> {
        match self {
            Self::Stroke { layer, .. } | Self::Fill { layer, .. } => layer.as_ref(),
        }
    }
}

/// Where an operation goes.
fn target(given: Option<Target>, brush: &Brush) -> Result<Target> {
    let target = given.unwrap_or_else(|| Target::of(brush));
    if target.is_heights() && brush.brush_type.is_for_masks() {
        let name = brush.brush_type.name();
        let detail = format!("`target` is heights, and `{name}` is for masks and selections");
        return Err(Error::Operation { place: "the operation".to_owned(), detail });
    }
    Ok(target)
}
