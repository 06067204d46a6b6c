//! Heights pushed away from their smoothed ones.

use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/sharpen";

/// The layout is that of `Sharpen` in `shaders/field/sharpen.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SharpenUniform {
    /// How far.
    pub gain: f32,
}

pub(super) fn data(gain: f32) -> OwnData {
    OwnData::uniform(&SharpenUniform { gain })
}
