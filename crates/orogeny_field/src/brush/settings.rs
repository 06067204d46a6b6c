//! What single brush types have beside what all of them have.

use std::sync::Arc;

use crate::{Curve, CurveTable};

/// Which side of a ledge is moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LedgeDirection {
    /// Ground below the reference comes up.
    Raise,
    /// Ground above the reference goes down.
    Lower,
}

/// Which way `level` may move the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LevelOnly {
    /// Both ways.
    Both,
    /// Down only.
    Cut,
    /// Up only.
    Fill,
}

/// Steps of equal height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terrace {
    /// Height of a step, metres.
    pub step_m: f64,
    /// How sharp its edges are: 0 leaves the ground as it is, 1 makes walls.
    pub sharpness: f64,
    /// Degrees by which the steps are tilted against the horizontal.
    pub tilt_deg: f64,
    /// Degrees from world x towards z of the way down their tilt.
    pub tilt_direction_deg: f64,
}

impl Default for Terrace {
    fn default() -> Self {
        Self { step_m: 10.0, sharpness: 0.7, tilt_deg: 0.0, tilt_direction_deg: 0.0 }
    }
}

/// Steps as kernels take them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TerraceSteps {
    /// Height of a step, metres.
    pub step_m: f32,
    /// 1 over it.
    pub inverse_step: f32,
    /// `1 / (1 - 0.99 sharpness)`.
    pub steepness: f32,
    /// The sample at which the tilted plane has height 0.
    pub anchor: [i32; 2],
    /// How the plane rises from sample to sample along x and z, metres.
    pub plane_m_per_sample: [f32; 2],
}

impl TerraceSteps {
    /// Steps on samples `spacing_m` apart, tilted about the sample `anchor`.
    #[must_use]
    pub fn new(terrace: &Terrace, spacing_m: f64, anchor: [i32; 2]) -> Self {
        let (z, x) = terrace.tilt_direction_deg.to_radians().sin_cos();
        let fall = terrace.tilt_deg.to_radians().tan() * spacing_m;
        Self {
            step_m: terrace.step_m as f32,
            inverse_step: (1.0 / terrace.step_m) as f32,
            steepness: (1.0 / (1.0 - 0.99 * terrace.sharpness)) as f32,
            anchor,
            plane_m_per_sample: [(-fall * x) as f32, (-fall * z) as f32],
        }
    }
}

/// How heights within a range are spread anew over it.
#[derive(Debug, Clone, PartialEq)]
pub enum RangeMapping {
    /// `z^(ln b / ln 1/2)`: b under a half lowers the middle, above raises it.
    Bias(f64),
    /// Bias twice, mirrored at the middle: g under a half flattens the middle, above steepens it.
    Gain(f64),
    /// A user's curve from 0..1 to 0..1.
    Curve(Curve),
}

/// A range of heights that is mapped onto itself.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeMap {
    /// Lower end, metres.
    pub low_m: f64,
    /// Upper end, metres.
    pub high_m: f64,
    /// How.
    pub mapping: RangeMapping,
}

impl Default for RangeMap {
    fn default() -> Self {
        Self { low_m: 0.0, high_m: 1000.0, mapping: RangeMapping::Bias(0.3) }
    }
}

/// Which formula a kernel uses; the number is the kernels' `RANGE_FORMULA` constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum RangeFormula {
    /// [`RangeMapping::Bias`].
    Bias = 0,
    /// [`RangeMapping::Gain`].
    Gain = 1,
    /// [`RangeMapping::Curve`].
    Curve = 2,
}

/// A range as kernels take it.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightRange {
    /// Lower end, metres.
    pub low_m: f32,
    /// Upper end, metres.
    pub high_m: f32,
    /// 1 over its width.
    pub inverse_width: f32,
    /// How.
    pub formula: RangeFormula,
    /// The exponent of a bias: `ln b / ln 1/2`.
    pub exponent: f32,
    /// Of [`RangeFormula::Curve`].
    pub table: Option<Arc<CurveTable>>,
}

impl From<&RangeMap> for HeightRange {
    fn from(range: &RangeMap) -> Self {
        let (formula, exponent, table) = match &range.mapping {
            RangeMapping::Bias(bias) => (RangeFormula::Bias, bias.ln() / 0.5_f64.ln(), None),
            RangeMapping::Gain(gain) => (RangeFormula::Gain, (1.0 - gain).ln() / 0.5_f64.ln(), None),
            RangeMapping::Curve(curve) => (RangeFormula::Curve, 1.0, Some(Arc::new(curve.table(0.0, 1.0)))),
        };
        Self {
            low_m: range.low_m as f32,
            high_m: range.high_m as f32,
            // Finite for the narrowest range that `f32` tells apart.
            inverse_width: (1.0 / (range.high_m - range.low_m)).min(f64::from(f32::MAX)) as f32,
            formula,
            exponent: exponent as f32,
            table,
        }
    }
}

/// How the ground is smoothed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SmoothMethod {
    /// By a Gaussian: the width is its standard deviation.
    Gaussian,
    /// By a B-spline over a lattice of samples: the width is their distance, to the nearest power of two in samples.
    Lattice,
}

/// What is smoothed, or made to stand out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothing {
    /// How.
    pub method: SmoothMethod,
    /// What is narrower than about this goes, metres; `None`: an eighth of the radius.
    pub width_m: Option<f64>,
    /// Of `sharpen`: how much further from what is smoothed the ground is moved, by its distance from it.
    pub gain: f64,
}

impl Default for Smoothing {
    fn default() -> Self {
        Self { method: SmoothMethod::Gaussian, width_m: None, gain: 1.0 }
    }
}

/// The profile of a ramp along its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RampAlong {
    /// The same slope everywhere.
    Linear,
    /// Level at both ends.
    Smooth,
}

/// How a stamp meets the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u32)]
pub enum StampMode {
    /// The ground becomes the stamp.
    Replace = 0,
    /// The stamp is laid on the ground.
    Add = 1,
    /// The higher of both.
    Max = 2,
    /// The lower of both.
    Min = 3,
}

/// A height image that is pressed into the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stamp {
    /// Metres that a value of 1 in the bitmap stands for.
    pub scale_m: f64,
    /// How it meets the ground.
    pub mode: StampMode,
}

impl Default for Stamp {
    fn default() -> Self {
        Self { scale_m: 100.0, mode: StampMode::Add }
    }
}

/// How an alpha bitmap is turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AlphaRotation {
    /// By its angle.
    Fixed,
    /// With the stroke, and by its angle.
    Follow,
    /// By a random angle for each instance.
    Random,
}

/// Where data from outside is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DataSource {
    /// A file, before an operation is recorded.
    File(String),
    /// The name of its content, in a recorded operation: 64 hexadecimal digits.
    Blake3(String),
}

/// A kernel that a user wrote.
#[derive(Debug, Clone, PartialEq)]
pub struct Custom {
    /// Its WGSL text.
    pub source: DataSource,
    /// Values of the parameters that it declares, by name; those that are not given have their defaults.
    pub parameters: Vec<(String, f64)>,
}

/// A bitmap that shapes the brush: its value multiplies the weight, over the square about the circle.
#[derive(Debug, Clone, PartialEq)]
pub struct Alpha {
    /// The picture.
    pub source: DataSource,
    /// Degrees by which it is turned from x towards z.
    pub angle_deg: f64,
    /// What else turns it.
    pub rotation: AlphaRotation,
    /// Whether left and right change places.
    pub is_mirrored: bool,
}

/// What differs at random from instance to instance, by the stroke's seed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Jitter {
    /// How much smaller an instance may be, as a share of the radius.
    pub radius: f64,
    /// How far its centre may be away, as a share of the radius.
    pub position: f64,
    /// How much weaker it may be, as a share of the strength.
    pub strength: f64,
}

/// Copies of a stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Symmetry {
    /// Which copies.
    pub kind: SymmetryKind,
    /// A place on the axis, or the point, in metres.
    pub centre_m: [f64; 2],
}

/// Which copies of a stroke are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SymmetryKind {
    /// In the mirror of an axis through the centre, at an angle from world x towards z in degrees.
    Axis {
        /// The angle.
        angle_deg: f64,
    },
    /// Through the centre.
    Point,
    /// Turned about the centre: that many in all.
    Radial {
        /// How many, the stroke itself among them.
        count: u32,
    },
}

/// What a pen's pressure and tilt, 0..1, are turned into: factors 0..1. `None`: they count for nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Dynamics {
    /// From pressure to radius; before it, [`crate::PressureTarget`].
    pub pressure_to_radius: Option<Curve>,
    /// From pressure to strength.
    pub pressure_to_strength: Option<Curve>,
    /// From pressure to flow.
    pub pressure_to_flow: Option<Curve>,
    /// From tilt (0 upright, 1 flat) to radius.
    pub tilt_to_radius: Option<Curve>,
    /// From tilt to strength.
    pub tilt_to_strength: Option<Curve>,
    /// From tilt to flow.
    pub tilt_to_flow: Option<Curve>,
}
