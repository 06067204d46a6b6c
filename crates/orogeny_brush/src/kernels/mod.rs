//! The kernels: for each stage its stem, how a brush becomes its pass, and its row on the CPU.

pub mod ledge;
pub mod level;
pub mod raise;
pub mod roughen;

use orogeny_field::{Brush, BrushType, Instance};

use crate::plan::{Pass, Stage};

impl Stage {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Raise, Self::Ledge, Self::Level, Self::Roughen];

    /// The kernel of a brush type.
    #[must_use]
    pub const fn of(brush_type: BrushType) -> Self {
        match brush_type {
            BrushType::Raise | BrushType::Lower => Self::Raise,
            BrushType::Ledge => Self::Ledge,
            BrushType::Level | BrushType::SetHeight => Self::Level,
            BrushType::Roughen => Self::Roughen,
        }
    }

    /// The shader's stem.
    #[must_use]
    pub const fn stem(self) -> &'static str {
        match self {
            Self::Raise => raise::STEM,
            Self::Ledge => ledge::STEM,
            Self::Level => level::STEM,
            Self::Roughen => roughen::STEM,
        }
    }

    /// Which way a brush's strength goes: -1 where it takes height away.
    #[must_use]
    pub fn sign(self, brush: &Brush) -> f64 {
        match self {
            Self::Raise => raise::sign(brush),
            Self::Ledge => ledge::sign(brush),
            Self::Level | Self::Roughen => 1.0,
        }
    }

    /// Whether each instance needs the height at its centre from before the stroke.
    #[must_use]
    pub const fn needs_reference_height(self) -> bool {
        matches!(self, Self::Ledge)
    }

    /// Whether the stroke needs the height under its first point from before it.
    #[must_use]
    pub const fn needs_target_height(self) -> bool {
        matches!(self, Self::Level)
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

/// Applies a pass's kernel to a row of heights, given the amounts; returns the number of clamped heights.
pub(crate) fn apply_row(
    pass: &Pass,
    instance: &Instance,
    start: RowStart,
    heights: &mut [f32],
    amounts: &[f32],
) -> u32 {
    match pass.stage {
        Stage::Raise => raise::apply_row(pass, instance, start, heights, amounts),
        Stage::Ledge => ledge::apply_row(pass, instance, start, heights, amounts),
        Stage::Level => level::apply_row(pass, instance, start, heights, amounts),
        Stage::Roughen => roughen::apply_row(pass, instance, start, heights, amounts),
    }
}
