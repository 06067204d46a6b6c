//! A symmetric filter along one axis.

use super::{Axis, axis_constant};
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/convolve";

/// The layout is that of `Convolve` in `shaders/field/convolve.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ConvolveUniform {
    /// Samples from centre to centre.
    pub stride: i32,
}

pub(super) fn data(axis: Axis, stride: u32, weights: &[f32]) -> OwnData {
    let uniform = ConvolveUniform { stride: stride.cast_signed() };
    let constants = [axis_constant(axis), ("NUM_WEIGHTS", weights.len() as u32)];
    let mut data = OwnData::uniform(&uniform).with_constants(&constants);
    data.storage = vec![bytemuck::cast_slice(weights).to_vec()];
    data
}
