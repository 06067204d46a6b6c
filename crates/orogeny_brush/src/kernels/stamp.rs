//! Stamp: a height image pressed into the ground.

use orogeny_field::StampMode;

use super::OwnData;

/// The shader's stem.
pub const STEM: &str = "brush/stamp";

/// The layout is that of `Stamp` in `shaders/brush/stamp.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct StampUniform {
    /// Metres that a bitmap value of 1 stands for.
    pub scale_m: f32,
}

pub(crate) fn data(scale_m: f32, mode: StampMode) -> OwnData {
    OwnData::uniform(&StampUniform { scale_m }).with_constants(&[("STAMP_MODE", mode as u32)])
}
