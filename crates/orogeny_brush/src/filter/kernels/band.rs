//! A level of a Laplacian pyramid, weighted.

use super::MAX_INPUTS;
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/band";

/// The layout is that of `Band` in `shaders/field/band.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct BandUniform {
    /// How much of it.
    pub factor: f32,
}

pub(super) fn data(factor: f32, num_inputs: usize) -> OwnData {
    let is_coarsest = num_inputs < MAX_INPUTS;
    OwnData::uniform(&BandUniform { factor }).with_constants(&[("IS_COARSEST", u32::from(is_coarsest))])
}
