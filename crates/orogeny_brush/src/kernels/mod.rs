//! The kernels: for each stage its stem, what a pass gives it, and its row on the CPU.

pub mod blend;
pub mod custom;
pub mod ledge;
pub mod level;
pub mod mask;
pub mod noise;
pub mod raise;
pub mod ramp;
pub mod range_map;
pub mod roughen;
pub mod stamp;
pub mod terrace;

use std::sync::Arc;

use orogeny_field::noise::NoiseKernel;
use orogeny_field::{
    Bitmap, Brush, BrushType, HeightRange, Instance, LedgeDirection, LevelOnly, RampAlong, StampMode,
    TerraceSteps,
};
use orogeny_reference::store::clamp_mask;

use crate::filter::Filter;
use crate::plan::Pass;

/// A kernel. Several brush types may share one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// `brush/raise`: raise and lower.
    Raise,
    /// `brush/ledge`.
    Ledge,
    /// `brush/level`: level and set height.
    Level,
    /// `brush/ramp`.
    Ramp,
    /// `brush/roughen`.
    Roughen,
    /// `brush/noise`.
    Noise,
    /// `brush/blend`: all that pulls the ground to what a filter makes.
    Blend,
    /// `brush/terrace`.
    Terrace,
    /// `brush/range_map`.
    RangeMap,
    /// `brush/stamp`.
    Stamp,
    /// `brush/mask`: paint and erase a mask.
    Mask,
    /// `custom/brush`: what a user wrote.
    Custom,
}

/// What a kernel does, with all that is the same for every sample and instance of a pass.
#[derive(Debug, Clone, PartialEq)]
pub enum Rule {
    /// [`Stage::Raise`].
    Raise,
    /// [`Stage::Ledge`].
    Ledge(LedgeDirection),
    /// [`Stage::Level`].
    Level {
        /// The goal, metres.
        target_height_m: f32,
        /// Which way the ground may move.
        only: LevelOnly,
    },
    /// [`Stage::Ramp`].
    Ramp {
        /// The profile along its way.
        along: RampAlong,
        /// Which way the ground may move.
        only: LevelOnly,
    },
    /// [`Stage::Roughen`].
    Roughen {
        /// Of its white noise.
        seed: u32,
    },
    /// [`Stage::Noise`].
    Noise(Arc<NoiseKernel>),
    /// [`Stage::Blend`]: what the ground is pulled to.
    Filter(Filter),
    /// [`Stage::Terrace`].
    Terrace(TerraceSteps),
    /// [`Stage::RangeMap`].
    RangeMap(HeightRange),
    /// [`Stage::Stamp`].
    Stamp {
        /// Metres that a bitmap value of 1 stands for.
        scale_m: f32,
        /// How it meets the ground.
        mode: StampMode,
        /// The height image.
        bitmap: Arc<Bitmap>,
    },
    /// [`Stage::Mask`].
    Mask {
        /// What is painted, 0..1.
        value: f32,
    },
    /// [`Stage::Custom`].
    Custom(custom::CustomRule),
}

impl Rule {
    /// Its kernel.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        match self {
            Self::Raise => Stage::Raise,
            Self::Ledge(_) => Stage::Ledge,
            Self::Level { .. } => Stage::Level,
            Self::Ramp { .. } => Stage::Ramp,
            Self::Roughen { .. } => Stage::Roughen,
            Self::Noise(_) => Stage::Noise,
            Self::Filter(_) => Stage::Blend,
            Self::Terrace(_) => Stage::Terrace,
            Self::RangeMap(_) => Stage::RangeMap,
            Self::Stamp { .. } => Stage::Stamp,
            Self::Mask { .. } => Stage::Mask,
            Self::Custom(_) => Stage::Custom,
        }
    }
}

impl Stage {
    /// Those that come with the program.
    pub const ALL: [Self; 11] = [
        Self::Raise,
        Self::Ledge,
        Self::Level,
        Self::Ramp,
        Self::Roughen,
        Self::Noise,
        Self::Blend,
        Self::Terrace,
        Self::RangeMap,
        Self::Stamp,
        Self::Mask,
    ];

    /// The kernel of a brush type.
    #[must_use]
    pub const fn of(brush_type: BrushType) -> Self {
        match brush_type {
            BrushType::Raise | BrushType::Lower => Self::Raise,
            BrushType::Ledge => Self::Ledge,
            BrushType::Level | BrushType::SetHeight => Self::Level,
            BrushType::Ramp => Self::Ramp,
            BrushType::Roughen => Self::Roughen,
            BrushType::Noise => Self::Noise,
            BrushType::Smooth
            | BrushType::Sharpen
            | BrushType::Smear
            | BrushType::Grab
            | BrushType::Clone
            | BrushType::ErodeThermal
            | BrushType::ErodeFluvial
            | BrushType::ErodeDroplets
            | BrushType::FillPits
            | BrushType::FlowMask
            | BrushType::RainMask => Self::Blend,
            BrushType::Terrace => Self::Terrace,
            BrushType::RangeMap => Self::RangeMap,
            BrushType::Stamp => Self::Stamp,
            BrushType::PaintMask | BrushType::EraseMask => Self::Mask,
            BrushType::Custom => Self::Custom,
        }
    }

    /// The shader's stem.
    #[must_use]
    pub const fn stem(self) -> &'static str {
        match self {
            Self::Raise => raise::STEM,
            Self::Ledge => ledge::STEM,
            Self::Level => level::STEM,
            Self::Ramp => ramp::STEM,
            Self::Roughen => roughen::STEM,
            Self::Noise => noise::STEM,
            Self::Blend => blend::STEM,
            Self::Terrace => terrace::STEM,
            Self::RangeMap => range_map::STEM,
            Self::Stamp => stamp::STEM,
            Self::Mask => mask::STEM,
            Self::Custom => custom::STEM,
        }
    }

    /// Which way a brush's strength goes: -1 where it takes height away.
    #[must_use]
    pub fn sign(self, brush: &Brush) -> f64 {
        match self {
            Self::Raise => raise::sign(brush),
            Self::Ledge => ledge::sign(brush),
            _ => 1.0,
        }
    }

    /// Whether each instance needs the height at its centre from before the stroke.
    #[must_use]
    pub const fn needs_reference_height(self) -> bool {
        matches!(self, Self::Ledge | Self::Stamp | Self::Ramp)
    }

    /// Whether the stroke needs the height under its first point from before it.
    #[must_use]
    pub const fn needs_target_height(self) -> bool {
        matches!(self, Self::Level)
    }

    /// Whether each instance has a goal of its own, so that they act one after another whatever the brush's blending: a wash
    /// has one goal a sample.
    #[must_use]
    pub const fn has_goal_of_instance(self) -> bool {
        matches!(self, Self::Stamp | Self::Ramp)
    }
}

/// Where a row begins, on the terrain.
#[derive(Debug, Clone, Copy)]
pub struct RowStart {
    /// First sample.
    pub x: i32,
    /// Row.
    pub z: i32,
}

/// Applies a pass's kernel to a row, given the amounts and, for a noise or a filter, the values of its own; returns the number of clamped heights.
pub(crate) fn apply_row(
    pass: &Pass,
    instance: &Instance,
    start: RowStart,
    heights: &mut [f32],
    amounts: &[f32],
    values: &[f32],
) -> u32 {
    let start = [start.x, start.z];
    let num_clamped = match &pass.rule {
        Rule::Raise => orogeny_reference::brush::raise::row(heights, amounts),
        Rule::Ledge(direction) => {
            orogeny_reference::brush::ledge::row(heights, amounts, instance, *direction)
        }
        Rule::Level { target_height_m, only } => {
            orogeny_reference::brush::level::row(heights, amounts, *target_height_m, *only)
        }
        Rule::Ramp { along, only } => {
            orogeny_reference::brush::ramp::row(heights, amounts, start, instance, *along, *only)
        }
        Rule::Roughen { seed } => {
            let [x, z] = start;
            orogeny_reference::brush::roughen::row(heights, amounts, x, z, *seed)
        }
        Rule::Noise(_) => orogeny_reference::brush::noise::row(heights, amounts, values),
        Rule::Filter(_) => orogeny_reference::brush::blend::row(heights, amounts, values),
        Rule::Terrace(steps) => orogeny_reference::brush::terrace::row(heights, amounts, start, steps),
        Rule::RangeMap(range) => orogeny_reference::brush::range_map::row(heights, amounts, range),
        Rule::Stamp { scale_m, mode, bitmap } => {
            orogeny_reference::brush::stamp::row(heights, amounts, start, instance, bitmap, *scale_m, *mode)
        }
        Rule::Mask { value } => orogeny_reference::brush::mask::row(heights, amounts, *value),
        // The CPU back end refuses it before it comes here.
        Rule::Custom(_) => 0,
    };
    if pass.is_mask {
        clamp_mask(heights);
        return 0;
    }
    num_clamped
}

/// What a kernel is bound to beside what all share, from the first binding of its own on.
#[derive(Debug, Default)]
pub(crate) struct OwnData {
    /// Pipeline-overridable constants.
    pub(crate) constants: Vec<(&'static str, u32)>,
    /// Uniforms.
    pub(crate) uniforms: Vec<Vec<u8>>,
    /// Storage buffers that are read, but for those that depend on the tiles.
    pub(crate) storage: Vec<Vec<u8>>,
}

impl OwnData {
    pub(crate) fn uniform(uniform: &impl bytemuck::NoUninit) -> Self {
        Self { uniforms: vec![bytemuck::bytes_of(uniform).to_vec()], ..Self::default() }
    }

    pub(crate) fn storage(bytes: &[u8]) -> Self {
        Self { storage: vec![bytes.to_vec()], ..Self::default() }
    }

    pub(crate) fn with_constants(mut self, constants: &[(&'static str, u32)]) -> Self {
        self.constants.extend(constants);
        self
    }
}
