//! Terrace: steps of equal height.

use orogeny_field::TerraceSteps;

use super::OwnData;

/// The shader's stem.
pub const STEM: &str = "brush/terrace";

/// The layout is that of `Terrace` in `shaders/brush/terrace.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct TerraceUniform {
    /// The sample at which the plane has height 0.
    pub anchor: [i32; 2],
    /// How the plane rises, metres a sample.
    pub plane_m_per_sample: [f32; 2],
    /// Height of a step, metres.
    pub step_m: f32,
    /// 1 over it.
    pub inverse_step: f32,
    /// How steep the edges are.
    pub steepness: f32,
    /// Nothing: the size is a multiple of 8.
    pub unused: u32,
}

pub(crate) fn data(steps: &TerraceSteps) -> OwnData {
    let TerraceSteps { step_m, inverse_step, steepness, anchor, plane_m_per_sample } = *steps;
    OwnData::uniform(&TerraceUniform {
        anchor,
        plane_m_per_sample,
        step_m,
        inverse_step,
        steepness,
        unused: 0,
    })
}
