//! A symmetric filter along one axis.

use super::{Axis, axis_constant};
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/convolve";

pub(super) fn data(axis: Axis, stride: u32, weights: &[f32]) -> OwnData {
    let constants = [axis_constant(axis), ("NUM_WEIGHTS", weights.len() as u32), ("STRIDE", stride)];
    OwnData::storage(bytemuck::cast_slice(weights)).with_constants(&constants)
}
