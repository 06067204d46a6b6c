//! Level, and set height, which has its target given.

use orogeny_field::LevelOnly;

use super::OwnData;

/// The shader's stem.
pub const STEM: &str = "brush/level";

/// The layout is that of `Level` in `shaders/brush/level.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LevelUniform {
    /// The goal, metres.
    pub target_height_m: f32,
    /// 0 both ways, 1 cut, 2 fill.
    pub only: u32,
}

/// The number that shaders take for it.
pub(crate) const fn only_number(only: LevelOnly) -> u32 {
    match only {
        LevelOnly::Both => 0,
        LevelOnly::Cut => 1,
        LevelOnly::Fill => 2,
    }
}

pub(crate) fn data(target_height_m: f32, only: LevelOnly) -> OwnData {
    OwnData::uniform(&LevelUniform { target_height_m, only: only_number(only) })
}
