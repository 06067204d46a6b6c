//! The kernels of steps: for each its stem, and what it is given on a GPU beside the planes.

pub mod convolve;
pub mod interpolate;
pub mod pipes;
pub mod sharpen;
pub mod shift;
pub mod thermal;

use super::{Axis, Step};
use crate::kernels::OwnData;

/// What all steps are given. The layout is that of `Step` in `shaders/driver/plane.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct StepUniform {
    /// The plane that is written.
    pub result: PlaneUniform,
    /// The first that is read.
    pub first: PlaneUniform,
    /// The second that is read; the first where there is none.
    pub second: PlaneUniform,
    /// Samples of the result along x and z.
    pub size: [u32; 2],
    /// Samples of the terrain along x and z.
    pub extent: [u32; 2],
    /// Whether the first plane is mirrored at the terrain's border.
    pub is_mirrored: u32,
    /// Which part of an iteration it is, of a simulation.
    pub phase: u32,
}

/// Where a plane lies. The layout is that of `Plane` in `shaders/lib/plane.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct PlaneUniform {
    /// Its first sample, on its grid.
    pub origin: [i32; 2],
    /// Values from row to row.
    pub stride: u32,
    /// Values from channel to channel.
    pub channel_stride: u32,
}

impl Step {
    /// The shader's stem; `None` for what is given.
    #[must_use]
    pub const fn stem(&self) -> Option<&'static str> {
        match self {
            Self::Heights => None,
            Self::Convolve { .. } => Some(convolve::STEM),
            Self::Interpolate { .. } => Some(interpolate::STEM),
            Self::Sharpen { .. } => Some(sharpen::STEM),
            Self::Shift { .. } => Some(shift::STEM),
            Self::Thermal { .. } => Some(thermal::STEM),
            Self::Pipes { .. } => Some(pipes::STEM),
        }
    }

    /// Which part of an iteration it is, of a simulation; else 0.
    pub(crate) const fn phase(&self) -> u32 {
        match self {
            Self::Thermal { phase, .. } => *phase as u32,
            Self::Pipes { phase, .. } => *phase as u32,
            _ => 0,
        }
    }

    /// What its kernel is given beside the planes.
    pub(crate) fn data(&self) -> OwnData {
        match self {
            Self::Heights => OwnData::default(),
            Self::Convolve { axis, stride, weights } => convolve::data(*axis, *stride, weights),
            Self::Interpolate { axis, phases } => interpolate::data(*axis, phases),
            Self::Sharpen { gain } => sharpen::data(*gain),
            Self::Shift { cell, fraction } => shift::data(*cell, *fraction),
            Self::Thermal { kernel, .. } => thermal::data(kernel),
            Self::Pipes { kernel, .. } => OwnData::uniform(&**kernel),
        }
    }
}

/// The number that shaders take for an axis.
const fn axis_constant(axis: Axis) -> (&'static str, u32) {
    match axis {
        Axis::X => ("AXIS", 0),
        Axis::Z => ("AXIS", 1),
    }
}
