//! Ramp: a slope between two places.

use orogeny_field::{LevelOnly, RampAlong};

use super::OwnData;
use super::level::only_number;

/// The shader's stem.
pub const STEM: &str = "brush/ramp";

/// The layout is that of `Ramp` in `shaders/brush/ramp.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct RampUniform {
    /// 1 where its beginning and end are level.
    pub is_smooth: u32,
    /// 0 both ways, 1 cut, 2 fill.
    pub level_only: u32,
}

pub(crate) fn data(along: RampAlong, only: LevelOnly) -> OwnData {
    let is_smooth = u32::from(along == RampAlong::Smooth);
    OwnData::uniform(&RampUniform { is_smooth, level_only: only_number(only) })
}
