//! Smooth, sharpen, smear: all that pulls the ground to what a filter made of it.

use crate::filter::kernels::PlaneUniform;

/// The shader's stem.
pub const STEM: &str = "brush/blend";

/// The layout is that of `Blend` in `shaders/brush/blend.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct BlendUniform {
    /// The first goal's sample, on the terrain.
    pub goal_origin: [i32; 2],
    /// Goals from row to row.
    pub goal_stride: u32,
    /// Nothing.
    pub padding: u32,
}

impl From<&PlaneUniform> for BlendUniform {
    fn from(plane: &PlaneUniform) -> Self {
        Self { goal_origin: plane.origin, goal_stride: plane.stride, padding: 0 }
    }
}
