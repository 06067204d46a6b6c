//! A sum of two planes.

use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/combine";

/// The layout is that of `Combine` in `shaders/field/combine.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CombineUniform {
    /// What each is multiplied by.
    pub factors: [f32; 2],
}

pub(super) fn data(factors: [f32; 2]) -> OwnData {
    OwnData::uniform(&CombineUniform { factors })
}
