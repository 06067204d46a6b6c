//! What a layer is made of.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};

use crate::{Brush, BrushType, Error, Result};

/// A brush that is applied to all that is looked at, whenever it is looked at: nothing of it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Procedure {
    /// Which one, as a fill has it: without a stroke.
    #[serde(serialize_with = "write_brush", deserialize_with = "read_brush")]
    pub brush: Box<Brush>,
    /// Feeds everything random in it.
    #[serde(default)]
    pub seed: u32,
}

fn write_brush<S: Serializer>(brush: &Brush, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    brush.to_json().serialize(serializer)
}

fn read_brush<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Box<Brush>, D::Error> {
    let object = Map::<String, Value>::deserialize(deserializer)?;
    Brush::from_json(&object).map(Box::new).map_err(serde::de::Error::custom)
}

/// What a layer is made of.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum LayerContent {
    /// Heights, painted or imported.
    #[default]
    Heights,
    /// What a brush makes of flat ground at 0 m: noise, or a brush of the user's own.
    Procedural(Procedure),
    /// What a brush makes of what is below. What has no bounds that it depends on, as erosion, is worked out when that is asked
    /// for and kept, as the difference to what was below.
    Effect(Procedure),
    /// Layers that belong together.
    Group,
}

impl LayerContent {
    /// As recipes have it.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Heights => "heights",
            Self::Procedural(_) => "procedural",
            Self::Effect(_) => "effect",
            Self::Group => "group",
        }
    }

    /// The brush, where there is one.
    #[must_use]
    pub const fn procedure(&self) -> Option<&Procedure> {
        match self {
            Self::Procedural(procedure) | Self::Effect(procedure) => Some(procedure),
            Self::Heights | Self::Group => None,
        }
    }

    /// The brush, to be changed.
    #[must_use]
    pub const fn procedure_mut(&mut self) -> Option<&mut Procedure> {
        match self {
            Self::Procedural(procedure) | Self::Effect(procedure) => Some(procedure),
            Self::Heights | Self::Group => None,
        }
    }

    /// Whether it is an effect that is worked out when that is asked for, and kept: a simulation, or what looks at a whole
    /// region at once.
    #[must_use]
    pub const fn is_kept(&self) -> bool {
        match self {
            Self::Effect(procedure) => is_simulated(procedure.brush.brush_type),
            _ => false,
        }
    }

    /// The blend mode of a new layer of it: what an effect makes of the ground takes the ground's place.
    #[must_use]
    pub const fn usual_blend(&self) -> super::Blend {
        match self {
            Self::Effect(_) => super::Blend::Replace,
            _ => super::Blend::Add,
        }
    }

    /// Refuses brushes that no layer can be made of.
    ///
    /// # Errors
    /// [`Error::LayerBrush`] for one that needs a stroke, is for masks, or is worked out only over what is below; what
    /// [`Brush::check`] says.
    pub fn check(&self) -> Result<()> {
        let Some(Procedure { brush, .. }) = self.procedure() else { return Ok(()) };
        brush.check()?;
        let brush_type = brush.brush_type;
        let refused = |why| Err(Error::LayerBrush { brush: brush_type.name(), content: self.name(), why });
        let needs_stroke = matches!(
            brush_type,
            BrushType::Ramp | BrushType::Smear | BrushType::Grab | BrushType::Stamp | BrushType::Clone
        );
        let needs_height = matches!(brush_type, BrushType::Level | BrushType::Ledge);
        match self {
            _ if brush_type.is_for_masks() => {
                refused("it is for masks: give the layer's mask a term, or paint it")
            }
            _ if needs_stroke => refused("it needs a stroke or a place: paint with it on a layer of heights"),
            _ if brush.alpha.is_some() => refused("its bitmap lies about the places of a stroke"),
            _ if needs_height && brush.height_m.is_none() => {
                refused("no stroke gives it a height: give `height`")
            }
            Self::Procedural(_) if is_simulated(brush_type) => {
                refused("it needs ground to work on: make the layer an `effect`")
            }
            _ => Ok(()),
        }
    }
}

/// Whether what a brush makes of a sample depends on samples however far away.
const fn is_simulated(brush_type: BrushType) -> bool {
    matches!(
        brush_type,
        BrushType::ErodeThermal | BrushType::ErodeFluvial | BrushType::ErodeDroplets | BrushType::FillPits
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(kind: &str, brush: &str) -> serde_json::Result<LayerContent> {
        serde_json::from_str(&format!(r#"{{"type": "{kind}", "brush": {brush}}}"#))
    }

    #[test]
    fn what_is_written_reads_back() {
        for (kind, brush) in [
            ("procedural", r#"{"type": "noise", "strength": 300, "feature_size": 900}"#),
            ("effect", r#"{"type": "smooth", "strength": 0.5, "width": 12}"#),
            ("effect", r#"{"type": "erode_thermal", "gate": {"slope": {"min": 20, "max": 90}}}"#),
        ] {
            let content = content(kind, brush).unwrap();
            content.check().unwrap();
            let again: LayerContent =
                serde_json::from_str(&serde_json::to_string(&content).unwrap()).unwrap();
            assert_eq!(again, content);
            assert_eq!(content.is_kept(), brush.contains("erode"));
        }
        assert_eq!(serde_json::to_string(&LayerContent::Group).unwrap(), r#"{"type":"group"}"#);
    }

    #[test]
    fn a_brush_that_no_layer_can_be_made_of_is_refused_by_its_name() {
        for (kind, brush, word) in [
            ("effect", r#"{"type": "smear"}"#, "smear"),
            ("effect", r#"{"type": "paint_mask"}"#, "paint_mask"),
            ("effect", r#"{"type": "level"}"#, "height"),
            ("procedural", r#"{"type": "erode_fluvial"}"#, "effect"),
        ] {
            let err = content(kind, brush).unwrap().check().unwrap_err().to_string();
            assert!(err.contains(word), "{err}");
        }
        assert!(
            content("procedural", r#"{"type": "noise", "octves": 3}"#)
                .unwrap_err()
                .to_string()
                .contains("octves")
        );
    }
}
