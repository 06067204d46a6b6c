//! Mask: paint and erase masks and selections.

use super::OwnData;

/// The shader's stem.
pub const STEM: &str = "brush/mask";

/// The layout is that of `Mask` in `shaders/brush/mask.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MaskUniform {
    /// What is painted, 0..1.
    pub value: f32,
}

pub(crate) fn data(value: f32) -> OwnData {
    OwnData::uniform(&MaskUniform { value })
}
