//! Brushes as values: a type, its parameters, and the table that says which parameters a type has.
//!
//! The table ([`PARAMETERS`]) is the single source of names, units, ranges and defaults: parsing, the error messages, the
//! `brushes` command and its JSON schema all read it.

mod catalog;
mod parse;
mod profile;

pub use catalog::{PARAMETERS, Parameter, ParameterKind};
pub use profile::{Falloff, FalloffFormula, Profile, ProfileShape};

/// What a brush does to the heights under it (`kernels.md` would call it the rule).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BrushType {
    /// Adds its weight to the height.
    Raise,
    /// Subtracts its weight from the height.
    Lower,
    /// Raises what is low or lowers what is high, so that a step is left.
    Ledge,
    /// Pulls towards the height under the stroke's first point, or a given one.
    Level,
    /// Pulls towards a given height.
    SetHeight,
    /// Adds white noise.
    Roughen,
}

impl BrushType {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Self; 6] =
        [Self::Raise, Self::Lower, Self::Ledge, Self::Level, Self::SetHeight, Self::Roughen];

    /// The name used in recipes.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Raise => "raise",
            Self::Lower => "lower",
            Self::Ledge => "ledge",
            Self::Level => "level",
            Self::SetHeight => "set_height",
            Self::Roughen => "roughen",
        }
    }

    /// One line on what it does.
    #[must_use]
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Raise => "adds height; one straight pass raises its centre line by `strength`",
            Self::Lower => "takes height away; one straight pass lowers its centre line by `strength`",
            Self::Ledge => "raises the low side or lowers the high side of a slope, leaving a step",
            Self::Level => "flattens towards the height under the stroke's first point, or `height`",
            Self::SetHeight => "pulls the ground to `height`",
            Self::Roughen => "adds white noise of up to ±`strength`",
        }
    }

    /// How its strength is meant.
    #[must_use]
    pub const fn coverage(self) -> Coverage {
        match self {
            Self::Raise | Self::Lower | Self::Ledge | Self::Roughen => Coverage::Additive,
            Self::Level | Self::SetHeight => Coverage::Blending,
        }
    }

    /// The type with this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|brush_type| brush_type.name() == name)
    }
}

/// The two meanings of `strength`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coverage {
    /// Metres that one straight pass adds at its centre line.
    Additive,
    /// The share, 0..1, by which one straight pass blends towards the target.
    Blending,
}

/// How the instances of a blending brush meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Blending {
    /// Each instance blends again; going over a place twice blends twice.
    BuildUp,
    /// One weight for the whole stroke, the largest of all instances; applied to the heights from before it.
    Wash,
}

/// What the pen's pressure scales, linearly from nothing at 0 to all at 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PressureTarget {
    /// Nothing.
    None,
    /// The radius (and falloff).
    Radius,
    /// The strength.
    Strength,
    /// Radius and strength.
    Both,
}

impl PressureTarget {
    /// Whether the radius follows the pressure.
    #[must_use]
    pub const fn scales_radius(self) -> bool {
        matches!(self, Self::Radius | Self::Both)
    }

    /// Whether the strength follows the pressure.
    #[must_use]
    pub const fn scales_strength(self) -> bool {
        matches!(self, Self::Strength | Self::Both)
    }
}

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

/// A brush with all its parameters: read from JSON ([`Brush::from_json`]), or made by [`Brush::new`] and the fields and then
/// looked at by [`Brush::check`] wherever it is used.
#[derive(Debug, Clone, PartialEq)]
pub struct Brush {
    /// What it does.
    pub brush_type: BrushType,
    /// Outer radius, metres, above 0.
    pub radius_m: f64,
    /// Shape of the slope.
    pub shape: ProfileShape,
    /// Width of the slope, metres, 0 to the radius.
    pub falloff_m: f64,
    /// Metres (additive brushes) or 0..1 (blending brushes).
    pub strength: f64,
    /// Distance between instances as a fraction of the radius.
    pub spacing: f64,
    /// What pressure scales.
    pub pressure: PressureTarget,
    /// How instances of a blending brush meet.
    pub blending: Blending,
    /// Target of `level` and `set_height`, reference of `ledge`, in metres; `None`: found under the stroke.
    pub height_m: Option<f32>,
    /// Which side of a ledge is moved.
    pub direction: LedgeDirection,
    /// Which way `level` may move the ground.
    pub only: LevelOnly,
}
