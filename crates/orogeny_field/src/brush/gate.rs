//! Gates: where a brush may act, by the ground as it was before the stroke.

use super::DataSource;
use crate::noise::Noise;

/// A range with soft ends: 1 within it, 0 further than the feather outside, a smooth step between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower end.
    pub min: f64,
    /// Upper end.
    pub max: f64,
    /// Width of each soft end, outside the range.
    pub feather: f64,
}

/// Slopes that face a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AspectGate {
    /// Degrees from world x towards z of the way down.
    pub angle_deg: f64,
    /// How far from it, to either side, in degrees.
    pub width_deg: f64,
    /// Width of each soft end, degrees.
    pub feather_deg: f64,
}

/// Where a noise lies within a range.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseGate {
    /// Which noise; seeding is that of the world.
    pub noise: Noise,
    /// The range, of the normalised noise.
    pub band: Band,
}

/// A picture laid over the world: its values, 0..1, and those of its border beyond it.
#[derive(Debug, Clone, PartialEq)]
pub struct GateImage {
    /// The picture.
    pub source: DataSource,
    /// Where it lies: `[x, z, width, depth]` in metres.
    pub region_m: [f64; 4],
}

/// Where a brush may act: the product of all that are given.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gate {
    /// Steepness, degrees.
    pub slope_deg: Option<Band>,
    /// Height, metres.
    pub height_m: Option<Band>,
    /// Which way the ground falls.
    pub aspect: Option<AspectGate>,
    /// How the ground bends, 1/km: positive on crests, negative in hollows.
    pub curvature_per_km: Option<Band>,
    /// A noise.
    pub noise: Option<NoiseGate>,
    /// The terrain's selection.
    pub selection: bool,
    /// A picture.
    pub image: Option<GateImage>,
    /// Whether it acts where it otherwise would not.
    pub is_inverted: bool,
}

impl Gate {
    /// Whether it looks at heights.
    #[must_use]
    pub const fn needs_heights(&self) -> bool {
        self.slope_deg.is_some()
            || self.height_m.is_some()
            || self.aspect.is_some()
            || self.curvature_per_km.is_some()
    }
}
