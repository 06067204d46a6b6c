//! Heights moved by a distance that is the same everywhere.

use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/shift";

/// The layout is that of `Shift` in `shaders/field/shift.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ShiftUniform {
    /// Whole samples.
    pub cell: [i32; 2],
    /// And the rest, 0..1.
    pub fraction: [f32; 2],
}

pub(super) fn data(cell: [i32; 2], fraction: [f32; 2]) -> OwnData {
    OwnData::uniform(&ShiftUniform { cell, fraction })
}
