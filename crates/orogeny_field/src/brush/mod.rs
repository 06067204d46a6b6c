//! Brushes as values: a type, its parameters, and the table that says which parameters a type has.
//!
//! The table ([`PARAMETERS`]) is the single source of names, units, ranges and defaults: parsing, the error messages, the
//! `brushes` command and its JSON schema all read it.

mod catalog;
mod cloning;
mod gate;
mod parse;
mod profile;
mod settings;

pub(crate) use catalog::GATE;
pub use catalog::{PARAMETERS, Parameter, ParameterKind};
pub use cloning::{Alignment, CloneBlend, CloneSource, Cloning, LayerReference, MAX_PYRAMID_LEVELS};
pub use gate::{AspectGate, Band, Gate, GateImage, NoiseGate};
pub use profile::{Falloff, FalloffFormula, Profile, ProfileShape};
pub use settings::{
    Alpha, AlphaRotation, Custom, DataSource, Dynamics, HeightRange, Jitter, LedgeDirection, LevelOnly,
    RampAlong, RangeFormula, RangeMap, RangeMapping, SmoothMethod, Smoothing, Stamp, StampMode, Symmetry,
    SymmetryKind, Terrace, TerraceSteps,
};

use crate::noise::Noise;
use crate::{Droplets, FillPits, FlowMask, FlowRouting, Pipes, RainMask, Thermal};

/// What a brush does to the heights under it.
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
    /// Pulls towards a slope from the stroke's first point to its last.
    Ramp,
    /// Adds white noise.
    Roughen,
    /// Adds a procedural noise.
    Noise,
    /// Pulls towards what is smoothed.
    Smooth,
    /// Pushes away from what is smoothed.
    Sharpen,
    /// Drags the ground along.
    Smear,
    /// Moves the ground under the stroke's first point to its last.
    Grab,
    /// Copies ground from elsewhere.
    Clone,
    /// Lets slide what is too steep.
    ErodeThermal,
    /// Lets water run.
    ErodeFluvial,
    /// Lets single drops of water run.
    ErodeDroplets,
    /// Raises what water cannot leave.
    FillPits,
    /// Pulls towards steps of equal height.
    Terrace,
    /// Spreads the heights of a range anew over it.
    RangeMap,
    /// Presses a bitmap into the ground.
    Stamp,
    /// Pulls a mask towards a value.
    PaintMask,
    /// Pulls a mask towards 0.
    EraseMask,
    /// Pulls a mask towards where water gathers.
    FlowMask,
    /// Pulls a mask to what rain leaves.
    RainMask,
    /// Does what a file of its user's says.
    Custom,
}

impl BrushType {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Self; 25] = [
        Self::Raise,
        Self::Lower,
        Self::Ledge,
        Self::Level,
        Self::SetHeight,
        Self::Ramp,
        Self::Roughen,
        Self::Noise,
        Self::Smooth,
        Self::Sharpen,
        Self::Smear,
        Self::Grab,
        Self::Clone,
        Self::ErodeThermal,
        Self::ErodeFluvial,
        Self::ErodeDroplets,
        Self::FillPits,
        Self::Terrace,
        Self::RangeMap,
        Self::Stamp,
        Self::PaintMask,
        Self::EraseMask,
        Self::FlowMask,
        Self::RainMask,
        Self::Custom,
    ];

    /// The name used in recipes.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Raise => "raise",
            Self::Lower => "lower",
            Self::Ledge => "ledge",
            Self::Level => "level",
            Self::SetHeight => "set_height",
            Self::Ramp => "ramp",
            Self::Roughen => "roughen",
            Self::Noise => "noise",
            Self::Smooth => "smooth",
            Self::Sharpen => "sharpen",
            Self::Smear => "smear",
            Self::Grab => "grab",
            Self::Clone => "clone",
            Self::ErodeThermal => "erode_thermal",
            Self::ErodeFluvial => "erode_fluvial",
            Self::ErodeDroplets => "erode_droplets",
            Self::FillPits => "fill_pits",
            Self::Terrace => "terrace",
            Self::RangeMap => "range_map",
            Self::Stamp => "stamp",
            Self::PaintMask => "paint_mask",
            Self::EraseMask => "erase_mask",
            Self::FlowMask => "flow_mask",
            Self::RainMask => "rain_mask",
            Self::Custom => "custom",
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
            Self::Ramp => "builds a slope from the stroke's first point to its last",
            Self::Roughen => "adds white noise of up to ±`strength`",
            Self::Noise => "adds mountains, hills, dunes: any noise of up to about ±`strength`",
            Self::Smooth => "smooths what is narrower than `width`",
            Self::Sharpen => "makes what is narrower than `width` stand out",
            Self::Smear => "drags the ground along, as a finger does wet paint",
            Self::Grab => "moves the ground under the stroke's first point to its last",
            Self::Clone => "copies ground from another place, layer or file, and blends it in",
            Self::ErodeThermal => "lets ground that is too steep slide down, as scree does",
            Self::ErodeFluvial => "lets rain run off: gullies are cut, and what they lose is laid down below",
            Self::ErodeDroplets => "lets single drops of water run down, which cut fine gullies",
            Self::FillPits => "raises the ground of pits until water can leave them",
            Self::Terrace => "cuts the ground into steps of equal height",
            Self::RangeMap => "spreads the heights between `low` and `high` anew: bias, gain or a curve",
            Self::Stamp => "presses a height image into the ground",
            Self::PaintMask => "paints a mask or a selection",
            Self::EraseMask => "erases a mask or a selection",
            Self::FlowMask => "paints a mask or a selection where water gathers on the layer's heights",
            Self::RainMask => {
                "paints a mask or a selection by what rain leaves: water, sediment, deposits, wear"
            }
            Self::Custom => "does what a WGSL file of your own says; needs a GPU or the software adapter",
        }
    }

    /// How its strength is meant.
    #[must_use]
    pub const fn coverage(self) -> Coverage {
        match self {
            Self::Raise | Self::Lower | Self::Ledge | Self::Roughen | Self::Noise => Coverage::Additive,
            Self::Level
            | Self::SetHeight
            | Self::Ramp
            | Self::Smooth
            | Self::Sharpen
            | Self::Smear
            | Self::Grab
            | Self::Clone
            | Self::ErodeThermal
            | Self::ErodeFluvial
            | Self::ErodeDroplets
            | Self::FillPits
            | Self::Terrace
            | Self::RangeMap
            | Self::Stamp
            | Self::PaintMask
            | Self::EraseMask
            | Self::FlowMask
            | Self::RainMask
            | Self::Custom => Coverage::Blending,
        }
    }

    /// Whether it is for masks and selections, whose values are 0..1, rather than for heights.
    #[must_use]
    pub const fn is_for_masks(self) -> bool {
        matches!(self, Self::PaintMask | Self::EraseMask | Self::FlowMask | Self::RainMask)
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
    /// Each instance acts on what those before it left, with its whole weight: of brushes whose users write them.
    Each,
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
    /// The flow.
    Flow,
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

    /// Whether the flow follows the pressure.
    #[must_use]
    pub const fn scales_flow(self) -> bool {
        matches!(self, Self::Flow)
    }
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
    /// How much of the strength each instance gives, 0..1; a wash with less than 1 comes nearer to it with every pass.
    pub flow: f64,
    /// Whether it goes on working while the pointer rests.
    pub is_airbrush: bool,
    /// What pressure and tilt do beyond [`Self::pressure`].
    pub dynamics: Dynamics,
    /// What differs at random from instance to instance.
    pub jitter: Jitter,
    /// A bitmap that shapes the weight.
    pub alpha: Option<Alpha>,
    /// Copies of the stroke.
    pub symmetry: Option<Symmetry>,
    /// Where it may act.
    pub gate: Option<Box<Gate>>,
    /// Of `noise`.
    pub noise: Noise,
    /// Of `smooth` and `sharpen`.
    pub smoothing: Smoothing,
    /// Of `clone`.
    pub cloning: Cloning,
    /// Of `erode_thermal`, `erode_fluvial` and `rain_mask`: how hard the ground is where, 0..1.
    pub hardness: Option<Box<Gate>>,
    /// Of `erode_thermal`.
    pub thermal: Thermal,
    /// Of `erode_fluvial` and `rain_mask`.
    pub pipes: Pipes,
    /// Of `erode_droplets`; its seed is that of the operation.
    pub droplets: Droplets,
    /// Of `fill_pits`.
    pub fill_pits: FillPits,
    /// Of `flow_mask`: how water is shared among the samples below.
    pub flow_routing: FlowRouting,
    /// Of `flow_mask`: which areas it tells apart.
    pub flow_mask: FlowMask,
    /// Of `rain_mask`.
    pub rain_mask: RainMask,
    /// Of `terrace`.
    pub terrace: Terrace,
    /// Of `range_map`.
    pub range_map: RangeMap,
    /// Height at the end of a `ramp`, in metres; `None`: the ground there. Its beginning is [`Self::height_m`].
    pub end_height_m: Option<f32>,
    /// Of `ramp`.
    pub along: RampAlong,
    /// Of `stamp`.
    pub stamp: Stamp,
    /// What `paint_mask` paints, 0..1.
    pub mask_value: f64,
    /// Of `custom`.
    pub custom: Option<Custom>,
}
