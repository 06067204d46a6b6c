//! Roughen: white noise by the sample's place and the stroke's seed.

use super::OwnData;

/// The shader's stem.
pub const STEM: &str = "brush/roughen";

/// The layout is that of `Roughen` in `shaders/brush/roughen.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct RoughenUniform {
    /// Of the white noise.
    pub seed: u32,
}

pub(crate) fn data(seed: u32) -> OwnData {
    OwnData::uniform(&RoughenUniform { seed })
}
