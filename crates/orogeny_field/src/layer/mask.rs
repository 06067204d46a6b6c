//! Where a layer counts: its painted mask, and terms that are worked out from what lies below.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::{Curve, Error, Gate, LayerReference, Result};

/// The most terms of a mask.
pub const MAX_MASK_TERMS: usize = 32;
/// The widest blur of a term, in metres.
const MAX_BLUR_M: f64 = 1.0e6;

/// What a term of a mask is worked out from, 0..1.
#[derive(Debug, Clone, PartialEq)]
pub enum MaskSource {
    /// Slope, height, aspect and curvature of what lies below the layer, a noise, a picture, the selection.
    Gate(Box<Gate>),
    /// The heights of another layer: 0 at `low` metres and below, 1 at `high` and above.
    Heights {
        /// Whose.
        layer: LayerReference,
        /// Metres at which it is 0.
        low: f64,
        /// Metres at which it is 1, other than `low`.
        high: f64,
    },
    /// The painted mask of another layer.
    Mask(LayerReference),
}

impl MaskSource {
    /// The layer that it looks at.
    #[must_use]
    pub const fn layer(&self) -> Option<&LayerReference> {
        match self {
            Self::Gate(_) => None,
            Self::Heights { layer, .. } | Self::Mask(layer) => Some(layer),
        }
    }

    /// The layer that it looks at, to be named otherwise.
    #[must_use]
    pub const fn layer_mut(&mut self) -> Option<&mut LayerReference> {
        match self {
            Self::Gate(_) => None,
            Self::Heights { layer, .. } | Self::Mask(layer) => Some(layer),
        }
    }
}

/// How a term joins those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MaskCombine {
    /// The product of both.
    #[default]
    Multiply,
    /// The sum of both, at most 1.
    Add,
    /// What was there, less the term; at least 0.
    Subtract,
    /// The larger of the two.
    Max,
    /// The smaller of the two.
    Min,
}

/// A part of a mask that is worked out wherever it is looked at.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Fields", into = "Fields")]
pub struct MaskTerm {
    /// From what.
    pub source: MaskSource,
    /// Over how many metres it is blurred: the standard deviation of a Gaussian, 0 for none.
    pub blur_m: f64,
    /// Whether it is 1 less what it would be, after the blur.
    pub is_inverted: bool,
    /// What becomes of its values then: control points, 0..1 each way.
    pub curve: Option<Curve>,
    /// How it joins those before it, and the painted mask.
    pub combine: MaskCombine,
}

/// A term as JSON.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gate: Option<Map<String, Value>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    heights: Option<HeightsFields>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mask: Option<LayerReference>,
    #[serde(default)]
    blur: f64,
    #[serde(default)]
    invert: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    curve: Option<Vec<[f64; 2]>>,
    #[serde(default)]
    combine: MaskCombine,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct HeightsFields {
    layer: LayerReference,
    low: f64,
    high: f64,
}

impl TryFrom<Fields> for MaskTerm {
    type Error = Error;

    fn try_from(fields: Fields) -> Result<Self> {
        let source = match (fields.gate, fields.heights, fields.mask) {
            (Some(gate), None, None) => MaskSource::Gate(Box::new(Gate::from_json(&gate)?)),
            (None, Some(HeightsFields { layer, low, high }), None) => {
                MaskSource::Heights { layer, low, high }
            }
            (None, None, Some(layer)) => MaskSource::Mask(layer),
            _ => return Err(Error::MaskSource),
        };
        Ok(Self {
            source,
            blur_m: fields.blur,
            is_inverted: fields.invert,
            curve: fields.curve.map(|points| Curve::new("`curve`", points)).transpose()?,
            combine: fields.combine,
        })
    }
}

impl From<MaskTerm> for Fields {
    fn from(term: MaskTerm) -> Self {
        let (mut gate, mut heights, mut mask) = (None, None, None);
        match term.source {
            MaskSource::Gate(given) => gate = Some(given.to_json()),
            MaskSource::Heights { layer, low, high } => heights = Some(HeightsFields { layer, low, high }),
            MaskSource::Mask(layer) => mask = Some(layer),
        }
        Self {
            gate,
            heights,
            mask,
            blur: term.blur_m,
            invert: term.is_inverted,
            curve: term.curve.map(|curve| curve.points().to_vec()),
            combine: term.combine,
        }
    }
}

impl MaskTerm {
    /// A term of a source alone, multiplied by what was there.
    #[must_use]
    pub const fn new(source: MaskSource) -> Self {
        Self { source, blur_m: 0.0, is_inverted: false, curve: None, combine: MaskCombine::Multiply }
    }

    /// Refuses numbers out of their range.
    ///
    /// # Errors
    /// [`Error::LayerValue`], naming the number.
    pub fn check(&self) -> Result<()> {
        if !(0.0..=MAX_BLUR_M).contains(&self.blur_m) {
            return Err(Error::LayerValue { field: "blur", value: self.blur_m, low: 0.0, high: MAX_BLUR_M });
        }
        if let MaskSource::Heights { low, high, .. } = self.source {
            let limit = f64::from(crate::MAX_HEIGHT_M);
            for (field, value) in [("low", low), ("high", high)] {
                if !(-limit..=limit).contains(&value) {
                    return Err(Error::LayerValue { field, value, low: -limit, high: limit });
                }
            }
            if low == high {
                return Err(Error::LayerRange { low });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back() {
        for text in [
            r#"{"gate": {"slope": {"min": 20, "max": 45, "feather": 5}}, "invert": true, "combine": "max"}"#,
            r#"{"heights": {"layer": "Sand", "low": 0, "high": 3}, "blur": 12.5}"#,
            r#"{"mask": 7, "curve": [[0, 0], [0.5, 0.9], [1, 1]], "combine": "subtract"}"#,
            r#"{"gate": {"noise": {"min": 0.1, "max": 2, "pattern": {"feature_size": 80}}}}"#,
        ] {
            let term: MaskTerm = serde_json::from_str(text).unwrap();
            term.check().unwrap();
            let again: MaskTerm = serde_json::from_str(&serde_json::to_string(&term).unwrap()).unwrap();
            assert_eq!(again, term, "{text}");
        }
    }

    #[test]
    fn a_bad_term_is_refused_by_its_field() {
        for (text, word) in [
            (r#"{"gate": {"slop": {"min": 1, "max": 2}}}"#, "slop"),
            (r#"{"gate": {}, "blurr": 3}"#, "blurr"),
            (r#"{"mask": 1, "curve": [[0, 0]]}"#, "curve"),
            (r#"{"mask": 1, "gate": {}}"#, "one of"),
            (r#"{"blur": 1}"#, "one of"),
        ] {
            let err = serde_json::from_str::<MaskTerm>(text).unwrap_err().to_string();
            assert!(err.contains(word), "{text}: {err}");
        }
        let flat: MaskTerm =
            serde_json::from_str(r#"{"heights": {"layer": 1, "low": 2, "high": 2}}"#).unwrap();
        assert!(flat.check().is_err());
        let wide: MaskTerm = serde_json::from_str(r#"{"mask": 1, "blur": -1}"#).unwrap();
        assert!(wide.check().unwrap_err().to_string().contains("blur"));
    }
}
