//! The kernels of steps: for each its stem, and what it is given on a GPU beside the planes.

pub mod band;
pub mod channel;
pub mod coarsen;
pub mod combine;
pub mod convolve;
pub mod cover;
pub mod grab;
pub mod interpolate;
pub mod lerp;
pub mod pipes;
pub mod resample;
pub mod sharpen;
pub mod shift;
pub mod thermal;
pub mod weights;

use orogeny_field::{Placement, SampleRect};

use super::{Axis, MAX_INPUTS, PipesPhase, Step, ThermalPhase};
use crate::kernels::OwnData;

/// What all steps are given. The layout is that of `Step` in `shaders/driver/plane.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct StepUniform {
    /// The plane that is written.
    pub result: PlaneUniform,
    /// Those that are read; the first again where there are no more.
    pub inputs: [InputUniform; MAX_INPUTS],
    /// Samples of the result along x and z.
    pub size: [u32; 2],
    /// Samples of the terrain along x and z.
    pub extent: [u32; 2],
}

/// A plane that is read. The layout is that of `Input` in `shaders/driver/plane.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct InputUniform {
    /// Where it lies.
    pub plane: PlaneUniform,
    /// After how many samples along x and z what it is a part of is there again, where that is mirrored; else 0.
    pub periods: [u32; 2],
    /// Nothing.
    pub padding: [u32; 2],
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
            Self::Heights | Self::Field(_) | Self::Raster(_) | Self::Region(_) | Self::Gate(_) => None,
            Self::Weights(_) => Some(weights::STEM),
            Self::Resample { .. } => Some(resample::STEM),
            Self::Cover { .. } => Some(cover::STEM),
            Self::Combine { .. } => Some(combine::STEM),
            Self::Lerp => Some(lerp::STEM),
            Self::Channel { .. } => Some(channel::STEM),
            Self::Band { .. } => Some(band::STEM),
            Self::Grab(_) => Some(grab::STEM),
            Self::Convolve { .. } => Some(convolve::STEM),
            Self::Interpolate { .. } => Some(interpolate::STEM),
            Self::Sharpen { .. } => Some(sharpen::STEM),
            Self::Shift { .. } => Some(shift::STEM),
            Self::Thermal { .. } => Some(thermal::STEM),
            Self::Pipes { .. } => Some(pipes::STEM),
        }
    }

    /// Samples along x and z that an invocation of its kernel makes: four, where those beside one another read much the same, and four
    /// times four where they look all around themselves.
    pub(crate) const fn at_once(&self) -> [u32; 2] {
        match self {
            Self::Convolve { axis: Axis::Z, .. } | Self::Interpolate { axis: Axis::Z, .. } => [1, 4],
            Self::Convolve { axis: Axis::X, .. } | Self::Interpolate { axis: Axis::X, .. } => [4, 1],
            Self::Thermal { .. } => [4, 4],
            // The same for pipes took as long: what an invocation then has to hold outweighs what it need not read.
            _ => [1, 1],
        }
    }

    /// What its kernel is given beside `num_inputs` planes, to make a rectangle.
    pub(crate) fn data(&self, rect: &SampleRect, num_inputs: usize) -> OwnData {
        match self {
            Self::Heights
            | Self::Field(_)
            | Self::Raster(_)
            | Self::Region(_)
            | Self::Gate(_)
            | Self::Weights(_) => OwnData::default(),
            Self::Resample { placement, heights } => resample::data(placement, *heights, rect),
            Self::Cover { placement, part } => cover::data(placement, part, num_inputs > 0, rect),
            Self::Lerp => OwnData::default(),
            Self::Channel { number, from, inverse_width } => channel::data(*number, *from, *inverse_width),
            Self::Combine { factors } => combine::data(*factors),
            Self::Band { factor } => band::data(*factor, num_inputs),
            Self::Grab(kernel) => grab::data(kernel),
            Self::Convolve { axis, stride, weights } => convolve::data(*axis, *stride, weights),
            Self::Interpolate { axis, phases } => interpolate::data(*axis, phases),
            Self::Sharpen { gain } => sharpen::data(*gain),
            Self::Shift { cell, fraction } => shift::data(*cell, *fraction),
            Self::Thermal { phase, kernel } => {
                thermal::data(kernel, *phase, *phase == ThermalPhase::Shares && num_inputs > 1)
            }
            Self::Pipes { phase, kernel } => {
                pipes::data(kernel, *phase, *phase == PipesPhase::Ground && num_inputs > 2)
            }
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

/// The tables of `shaders/driver/place.wgsl`: what each column and each row of a rectangle has of its samples' places.
fn places(placement: &Placement, rect: &SampleRect) -> Vec<Vec<u8>> {
    let columns: Vec<_> = (rect.x0..rect.x1).map(|x| placement.column(x)).collect();
    let rows: Vec<_> = (rect.z0..rect.z1).map(|z| placement.row(z)).collect();
    vec![bytemuck::cast_slice(&columns).to_vec(), bytemuck::cast_slice(&rows).to_vec()]
}
