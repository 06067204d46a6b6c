//! Selecting: what becomes of the terrain's selection, as one step.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::{Error, Gate, LayerReference, MAX_COORDINATE_SAMPLES, Result, TerrainGrid};

/// The most points of a lasso.
pub const MAX_LASSO_POINTS: usize = 1 << 16;
/// The furthest that a selection is grown or shrunk at once, in samples: as many lie about all that is looked at.
pub const MAX_GROW_SAMPLES: f64 = 1024.0;
/// The widest feather, in samples: four times as many lie about all that is looked at.
pub const MAX_FEATHER_SAMPLES: f64 = 256.0;

/// What is selected, before it joins what was selected before.
#[derive(Debug, Clone, PartialEq)]
pub enum SelectShape {
    /// The whole terrain.
    All,
    /// Nothing.
    Nothing,
    /// What is selected already.
    Keep,
    /// `[x, z, width, depth]` in metres, far edges outside.
    Rectangle([f64; 4]),
    /// The inside of a polygon by the even-odd rule: its corners `[x, z]` in metres. It closes by itself.
    Lasso(Vec<[f64; 2]>),
    /// What a gate lets through.
    Gate {
        /// The gate.
        gate: Box<Gate>,
        /// `[x, z, width, depth]` in metres, nothing beyond it; `None`: the whole terrain.
        region_m: Option<[f64; 4]>,
    },
    /// The painted mask of a layer.
    Mask {
        /// Whose.
        layer: LayerReference,
        /// `[x, z, width, depth]` in metres, nothing beyond it; `None`: the whole terrain.
        region_m: Option<[f64; 4]>,
    },
}

/// How a shape joins what was selected before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SelectCombine {
    /// The shape alone.
    #[default]
    Replace,
    /// The larger of both.
    Add,
    /// What was selected, where the shape is not: `a (1 − b)`.
    Subtract,
    /// The product of both.
    Intersect,
}

/// A change of the selection: a shape joins it, then what comes of that is grown, shrunk, feathered and inverted, in this order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Fields", into = "Fields")]
pub struct Selecting {
    /// What is selected.
    pub shape: SelectShape,
    /// How it joins what was selected before.
    pub combine: SelectCombine,
    /// By how many metres it grows, 0 and more. What is less than a sample changes nothing.
    pub grow_m: f64,
    /// By how many metres it shrinks then, 0 and more.
    pub shrink_m: f64,
    /// How soft its edges become then: the standard deviation of a Gaussian, in metres, 0 and more.
    pub feather_m: f64,
    /// Whether all that is not selected is selected instead, at the end.
    pub is_inverted: bool,
}

/// The lengths of a [`Selecting`] on a terrain, in samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelectLengths {
    /// 0 to [`MAX_GROW_SAMPLES`].
    pub grow: f64,
    /// 0 to [`MAX_GROW_SAMPLES`].
    pub shrink: f64,
    /// 0 to [`MAX_FEATHER_SAMPLES`].
    pub feather: f64,
}

impl Selecting {
    /// A shape that replaces what was selected, as it is.
    #[must_use]
    pub const fn new(shape: SelectShape) -> Self {
        let (grow_m, shrink_m, feather_m) = (0.0, 0.0, 0.0);
        Self { shape, combine: SelectCombine::Replace, grow_m, shrink_m, feather_m, is_inverted: false }
    }

    /// The layer that it names.
    #[must_use]
    pub const fn layer(&self) -> Option<&LayerReference> {
        match &self.shape {
            SelectShape::Mask { layer, .. } => Some(layer),
            _ => None,
        }
    }

    /// The layer that it names, to be changed.
    #[must_use]
    pub const fn layer_mut(&mut self) -> Option<&mut LayerReference> {
        match &mut self.shape {
            SelectShape::Mask { layer, .. } => Some(layer),
            _ => None,
        }
    }

    /// The gate that it has, to be changed.
    #[must_use]
    pub fn gate_mut(&mut self) -> Option<&mut Gate> {
        match &mut self.shape {
            SelectShape::Gate { gate, .. } => Some(gate),
            _ => None,
        }
    }

    /// Refuses what no terrain can use.
    ///
    /// # Errors
    /// [`Error::SelectValue`], naming the field.
    pub fn check(&self) -> Result<()> {
        match &self.shape {
            SelectShape::Rectangle(rectangle_m) => check_rectangle("shape.rectangle", rectangle_m)?,
            SelectShape::Gate { region_m: Some(region_m), .. }
            | SelectShape::Mask { region_m: Some(region_m), .. } => {
                check_rectangle("shape.region", region_m)?
            }
            SelectShape::Lasso(points) => check_lasso(points)?,
            _ => {}
        }
        for (field, length_m) in self.lengths_m() {
            if !(length_m.is_finite() && length_m >= 0.0) {
                return Err(refused(field, length_m, "it must be a number of metres, 0 or more"));
            }
        }
        Ok(())
    }

    /// Its lengths on a terrain.
    ///
    /// # Errors
    /// As [`Self::check`], and for lengths of too many samples.
    pub fn lengths(&self, grid: &TerrainGrid) -> Result<SelectLengths> {
        self.check()?;
        let limits = [MAX_GROW_SAMPLES, MAX_GROW_SAMPLES, MAX_FEATHER_SAMPLES];
        let mut samples = [0.0; 3];
        for ((length, (field, length_m)), limit) in samples.iter_mut().zip(self.lengths_m()).zip(limits) {
            *length = length_m / grid.spacing_m();
            if *length > limit {
                let limit_m = limit * grid.spacing_m();
                let limit =
                    format!("it is {length} samples, and at most {limit} can be: give {limit_m} m or less");
                return Err(refused(field, format!("{length_m} m"), limit));
            }
        }
        let [grow, shrink, feather] = samples;
        Ok(SelectLengths { grow, shrink, feather })
    }

    /// The points of its lasso on a terrain, in samples; none of any other shape.
    ///
    /// # Errors
    /// As [`Self::check`], and for points absurdly far away.
    pub fn lasso(&self, grid: &TerrainGrid) -> Result<Vec<[f64; 2]>> {
        self.check()?;
        let SelectShape::Lasso(points) = &self.shape else { return Ok(Vec::new()) };
        let on_samples = |(place, point): (usize, &[f64; 2])| {
            let samples = grid.sample_from_world(*point);
            if samples.iter().all(|along| along.abs() <= MAX_COORDINATE_SAMPLES) {
                return Ok(samples);
            }
            let limit = format!("it must be within ±{} m", MAX_COORDINATE_SAMPLES * grid.spacing_m());
            Err(refused(format!("shape.lasso[{place}]"), format!("{point:?}"), limit))
        };
        points.iter().enumerate().map(on_samples).collect()
    }

    const fn lengths_m(&self) -> [(&'static str, f64); 3] {
        [("grow", self.grow_m), ("shrink", self.shrink_m), ("feather", self.feather_m)]
    }
}

fn check_rectangle(field: &str, rectangle_m: &[f64; 4]) -> Result<()> {
    let [.., width_m, depth_m] = rectangle_m;
    if rectangle_m.iter().all(|number| number.is_finite()) && *width_m > 0.0 && *depth_m > 0.0 {
        return Ok(());
    }
    let limit = "it must be [x, z, width, depth] in metres, width and depth above 0";
    Err(refused(field, format!("{rectangle_m:?}"), limit))
}

fn check_lasso(points: &[[f64; 2]]) -> Result<()> {
    if !(3..=MAX_LASSO_POINTS).contains(&points.len()) {
        let limit = format!("it must have 3 to {MAX_LASSO_POINTS}");
        return Err(refused("shape.lasso", format!("a list of {} points", points.len()), limit));
    }
    match points.iter().position(|point| !point.iter().all(|along| along.is_finite())) {
        None => Ok(()),
        Some(place) => {
            Err(refused(format!("shape.lasso[{place}]"), "no place", "it must be [x, z] in metres"))
        }
    }
}

fn refused(field: impl Into<String>, value: impl ToString, limit: impl Into<String>) -> Error {
    Error::SelectValue { field: field.into(), value: value.to_string(), limit: limit.into() }
}

/// A change of the selection as JSON.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    shape: ShapeFields,
    #[serde(default)]
    combine: SelectCombine,
    #[serde(default)]
    grow: f64,
    #[serde(default)]
    shrink: f64,
    #[serde(default)]
    feather: f64,
    #[serde(default)]
    invert: bool,
}

#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ShapeFields {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    all: Option<bool>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    nothing: Option<bool>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    keep: Option<bool>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rectangle: Option<[f64; 4]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lasso: Option<Vec<[f64; 2]>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gate: Option<Map<String, Value>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mask: Option<LayerReference>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    region: Option<[f64; 4]>,
}

impl TryFrom<Fields> for Selecting {
    type Error = Error;

    fn try_from(fields: Fields) -> Result<Self> {
        let Fields { shape, combine, grow, shrink, feather, invert } = fields;
        let selecting = Self {
            shape: shape.try_into()?,
            combine,
            grow_m: grow,
            shrink_m: shrink,
            feather_m: feather,
            is_inverted: invert,
        };
        selecting.check()?;
        Ok(selecting)
    }
}

impl From<Selecting> for Fields {
    fn from(selecting: Selecting) -> Self {
        Self {
            shape: selecting.shape.into(),
            combine: selecting.combine,
            grow: selecting.grow_m,
            shrink: selecting.shrink_m,
            feather: selecting.feather_m,
            invert: selecting.is_inverted,
        }
    }
}

impl TryFrom<ShapeFields> for SelectShape {
    type Error = Error;

    fn try_from(fields: ShapeFields) -> Result<Self> {
        let ShapeFields { all, nothing, keep, rectangle, lasso, gate, mask, region } = fields;
        let words = [
            ("shape.all", all, Self::All),
            ("shape.nothing", nothing, Self::Nothing),
            ("shape.keep", keep, Self::Keep),
        ];
        let mut given = Vec::new();
        for (field, word, shape) in words {
            match word {
                Some(true) => given.push(shape),
                Some(false) => return Err(refused(field, false, "it must be true, or be left out")),
                None => {}
            }
        }
        given.extend(rectangle.map(Self::Rectangle));
        given.extend(lasso.map(Self::Lasso));
        if let Some(gate) = gate {
            given.push(Self::Gate { gate: Box::new(Gate::from_json(&gate)?), region_m: region });
        }
        given.extend(mask.map(|layer| Self::Mask { layer, region_m: region }));
        let shape = given.pop().filter(|_| given.is_empty()).ok_or(Error::SelectShape)?;
        match (region, &shape) {
            (None, _) | (_, Self::Gate { .. } | Self::Mask { .. }) => Ok(shape),
            (Some(region), _) => {
                Err(refused("shape.region", format!("{region:?}"), "only a `gate` and a `mask` have one"))
            }
        }
    }
}

impl From<SelectShape> for ShapeFields {
    fn from(shape: SelectShape) -> Self {
        match shape {
            SelectShape::All => Self { all: Some(true), ..Self::default() },
            SelectShape::Nothing => Self { nothing: Some(true), ..Self::default() },
            SelectShape::Keep => Self { keep: Some(true), ..Self::default() },
            SelectShape::Rectangle(rectangle) => Self { rectangle: Some(rectangle), ..Self::default() },
            SelectShape::Lasso(points) => Self { lasso: Some(points), ..Self::default() },
            SelectShape::Gate { gate, region_m } => {
                Self { gate: Some(gate.to_json()), region: region_m, ..Self::default() }
            }
            SelectShape::Mask { layer, region_m } => {
                Self { mask: Some(layer), region: region_m, ..Self::default() }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> serde_json::Result<Selecting> {
        serde_json::from_str(text)
    }

    #[test]
    fn what_is_written_reads_back() {
        for text in [
            r#"{"shape": {"all": true}}"#,
            r#"{"shape": {"nothing": true}}"#,
            r#"{"shape": {"keep": true}, "grow": 3, "shrink": 1.5, "feather": 12, "invert": true}"#,
            r#"{"shape": {"rectangle": [10, -20, 300, 0.5]}, "combine": "subtract"}"#,
            r#"{"shape": {"lasso": [[0, 0], [10, 0.25], [5, 9]]}, "combine": "add"}"#,
            r#"{"shape": {"gate": {"slope": {"min": 20, "max": 45, "feather": 5}, "selection": true}, "region": [0, 0, 9, 9]}}"#,
            r#"{"shape": {"gate": {"image": {"file": "a.png", "region": [0, 0, 64, 64]}}}, "combine": "intersect"}"#,
            r#"{"shape": {"mask": "Sand"}}"#,
            r#"{"shape": {"mask": 3, "region": [1, 2, 3, 4]}}"#,
        ] {
            let selecting = read(text).unwrap();
            let written = serde_json::to_string(&selecting).unwrap();
            assert_eq!(read(&written).unwrap(), selecting, "{text}");
        }
        let plain = read(r#"{"shape": {"nothing": true}}"#).unwrap();
        assert_eq!(plain, Selecting::new(SelectShape::Nothing));
        assert_eq!(
            serde_json::to_string(&plain).unwrap(),
            r#"{"shape":{"nothing":true},"combine":"replace","grow":0.0,"shrink":0.0,"feather":0.0,"invert":false}"#
        );
    }

    #[test]
    fn what_cannot_be_used_is_refused_by_its_field() {
        for (text, word) in [
            (r"{}", "shape"),
            (r#"{"shape": {}}"#, "`lasso`"),
            (r#"{"shape": {"all": true, "mask": 1}}"#, "alone"),
            (r#"{"shape": {"keep": false}}"#, "`shape.keep`"),
            (r#"{"shape": {"all": true}, "growth": 3}"#, "growth"),
            (r#"{"shape": {"circle": [0, 0, 3]}}"#, "circle"),
            (r#"{"shape": {"all": true}, "combine": "xor"}"#, "xor"),
            (r#"{"shape": {"rectangle": [0, 0, 0, 5]}}"#, "`shape.rectangle`"),
            (r#"{"shape": {"rectangle": [0, 0, 5]}}"#, "4"),
            (r#"{"shape": {"lasso": [[0, 0], [1, 1]]}}"#, "`shape.lasso`"),
            (r#"{"shape": {"lasso": [[0, 0], [1, 1], [2]]}}"#, "2"),
            (r#"{"shape": {"gate": {"slop": {}}}}"#, "slop"),
            (r#"{"shape": {"gate": {}, "region": [0, 0, -1, 5]}}"#, "`shape.region`"),
            (r#"{"shape": {"all": true, "region": [0, 0, 1, 5]}}"#, "`shape.region`"),
            (r#"{"shape": {"all": true}, "grow": -1}"#, "`grow`"),
            (r#"{"shape": {"all": true}, "shrink": -0.5}"#, "`shrink`"),
            (r#"{"shape": {"all": true}, "feather": -1e-9}"#, "`feather`"),
        ] {
            let err = read(text).unwrap_err().to_string();
            assert!(err.contains(word), "{text}: {err}");
        }
        let too_many = Selecting::new(SelectShape::Lasso(vec![[0.0; 2]; MAX_LASSO_POINTS + 1]));
        assert!(too_many.check().unwrap_err().to_string().contains("65537"));
        let nowhere = Selecting::new(SelectShape::Lasso(vec![[0.0; 2], [f64::NAN, 1.0], [1.0; 2]]));
        assert!(nowhere.check().unwrap_err().to_string().contains("shape.lasso[1]"));
        let endless = Selecting { feather_m: f64::INFINITY, ..Selecting::new(SelectShape::All) };
        assert!(endless.check().unwrap_err().to_string().contains("`feather`"));
    }

    #[test]
    fn lengths_are_those_of_the_terrain_and_have_their_limits() {
        let grid = TerrainGrid::new(100, 100, 2.5).unwrap();
        let selecting = Selecting {
            grow_m: 2560.0,
            shrink_m: 5.0,
            feather_m: 640.0,
            ..Selecting::new(SelectShape::Keep)
        };
        let lengths = selecting.lengths(&grid).unwrap();
        assert_eq!(lengths, SelectLengths { grow: 1024.0, shrink: 2.0, feather: 256.0 });
        for (selecting, words) in [
            (Selecting { grow_m: 2561.0, ..selecting.clone() }, ["`grow`", "2560 m"]),
            (Selecting { shrink_m: 1.0e300, ..selecting.clone() }, ["`shrink`", "2560 m"]),
            (Selecting { feather_m: 641.0, ..selecting.clone() }, ["`feather`", "640 m"]),
        ] {
            let err = selecting.lengths(&grid).unwrap_err().to_string();
            assert!(words.iter().all(|word| err.contains(word)), "{err}");
        }
        let far = Selecting::new(SelectShape::Lasso(vec![[0.0; 2], [1.0, 5.0], [-1.0e12, 0.0]]));
        assert!(far.lasso(&grid).unwrap_err().to_string().contains("shape.lasso[2]"));
        let near = Selecting::new(SelectShape::Lasso(vec![[0.0; 2], [5.0, 10.0], [-2.5, 0.0]]));
        assert_eq!(near.lasso(&grid).unwrap(), [[0.0, 0.0], [2.0, 4.0], [-1.0, 0.0]]);
        assert_eq!(selecting.lasso(&grid).unwrap(), Vec::<[f64; 2]>::new());
    }
}
