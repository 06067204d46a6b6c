//! A coarse grid turned into a finer one, along one axis.

use orogeny_field::PhaseWeights;

use super::{Axis, axis_constant};
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/interpolate";

/// The layout is that of `Interpolate` in `shaders/field/interpolate.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct InterpolateUniform {
    /// How many times as fine.
    pub num_phases: i32,
}

pub(super) fn data(axis: Axis, phases: &[PhaseWeights]) -> OwnData {
    let uniform = InterpolateUniform { num_phases: phases.len() as i32 };
    let mut data = OwnData::uniform(&uniform).with_constants(&[axis_constant(axis)]);
    data.storage = vec![bytemuck::cast_slice(phases).to_vec()];
    data
}
