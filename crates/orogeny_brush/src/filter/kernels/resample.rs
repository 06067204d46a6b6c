//! Another ground laid on the terrain.

use orogeny_field::{Placement, SampleRect};

use super::places;
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/resample";

/// The layout is that of `Resample` in `shaders/field/resample.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ResampleUniform {
    /// What its heights are multiplied by.
    pub scale: f32,
    /// What is added to them then, metres.
    pub offset_m: f32,
}

pub(super) fn data(placement: &Placement, [scale, offset_m]: [f32; 2], rect: &SampleRect) -> OwnData {
    let mut data = OwnData::uniform(&ResampleUniform { scale, offset_m });
    data.storage = places(placement, rect);
    data
}
