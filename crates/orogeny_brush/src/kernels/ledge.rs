//! Ledge: a step about the height under each instance.

use orogeny_field::{Brush, LedgeDirection};

use super::OwnData;

/// The shader's stem.
pub const STEM: &str = "brush/ledge";

/// The layout is that of `Ledge` in `shaders/brush/ledge.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LedgeUniform {
    /// 1 raises, -1 lowers.
    pub direction: f32,
}

/// -1 where the high side goes down.
pub(crate) fn sign(brush: &Brush) -> f64 {
    f64::from(way(brush.direction))
}

const fn way(direction: LedgeDirection) -> f32 {
    match direction {
        LedgeDirection::Raise => 1.0,
        LedgeDirection::Lower => -1.0,
    }
}

pub(crate) fn data(direction: LedgeDirection) -> OwnData {
    OwnData::uniform(&LedgeUniform { direction: way(direction) })
}
