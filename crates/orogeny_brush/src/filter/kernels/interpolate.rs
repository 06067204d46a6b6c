//! A coarse grid turned into a finer one, along one axis.

use orogeny_field::PhaseWeights;

use super::{Axis, axis_constant};
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/interpolate";

pub(super) fn data(axis: Axis, phases: &[PhaseWeights]) -> OwnData {
    let constants = [axis_constant(axis), ("NUM_PHASES", phases.len() as u32)];
    OwnData::storage(bytemuck::cast_slice(phases)).with_constants(&constants)
}
