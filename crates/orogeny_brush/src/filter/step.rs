//! Steps: how the values of a plane are made of those of others.

use std::sync::Arc;

use orogeny_field::{
    FieldId, GrabKernel, Mirrors, PYRAMID_PHASES, Part, PhaseWeights, PipesKernel, Placement, Plane,
    SampleRect, ThermalKernel,
};

use super::{RegionKernel, Weights};
use crate::gate::GatePlan;

/// The most planes that a step makes one of.
pub const MAX_INPUTS: usize = 4;

/// Along which axis a step works.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// To the east.
    X,
    /// To the south.
    Z,
}

impl Axis {
    /// The mirrors of what is made along it: along the other one each row or column is made of its own alone.
    fn of_mirrors(self, source: Mirrors, made: impl FnOnce(Option<u32>) -> Option<u32>) -> Mirrors {
        let [x, z] = source.periods;
        let periods = match self {
            Self::X => [made(x), z],
            Self::Z => [x, made(z)],
        };
        Mirrors { periods }
    }
}

/// How the values of a plane are made of those of others.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// They are given: the heights that are worked on.
    Heights,
    /// They are given: those of a field of the terrain, before the operation.
    Field(FieldId),
    /// They are given: data from outside, from sample (0, 0) on.
    Raster(Arc<Plane>),
    /// They are given: what is made of a whole region at once.
    Region(Arc<RegionKernel>),
    /// They are given: what a gate lets through, 0..1.
    Gate(Arc<GatePlan>),
    /// `field/weights`: how much a stroke takes of what is made, 0..1.
    Weights(Arc<Weights>),
    /// `field/resample`: another ground laid on the terrain.
    Resample {
        /// Where.
        placement: Placement,
        /// What its heights are multiplied by, and what is added to them then, metres.
        heights: [f32; 2],
    },
    /// `field/cover`: where there is another ground, 0..1; of one plane, how much is selected of it.
    Cover {
        /// Where it lies.
        placement: Placement,
        /// What is copied of it.
        part: Part,
    },
    /// `field/lerp`: the first plane pulled to the second by the third.
    Lerp,
    /// `field/combine`: a sum of two planes.
    Combine {
        /// What each is multiplied by.
        factors: [f32; 2],
    },
    /// `field/band`: a level of a Laplacian pyramid, weighted: of weights and level, and of the next one and what came of all
    /// further ones, both expanded along z, which it expands along x; of weights and level only, for the coarsest.
    Band {
        /// How much of it.
        factor: f32,
    },
    /// `field/channel`: one quantity of several, as a mask.
    Channel {
        /// Which one.
        number: u32,
        /// Up to this it is 0.
        from: f32,
        /// 1 over how much more it takes to be 1.
        inverse_width: f32,
    },
    /// `field/grab`: the ground moved along with brushes.
    Grab(Arc<GrabKernel>),
    /// `field/convolve`: a symmetric filter, centred on every `stride`-th sample.
    Convolve {
        /// Along which axis.
        axis: Axis,
        /// Samples from centre to centre.
        stride: u32,
        /// Of the neighbours 1, 2, … samples away.
        weights: Arc<[f32]>,
    },
    /// `field/interpolate`: as many values for each sample as there are phases.
    Interpolate {
        /// Along which axis.
        axis: Axis,
        /// Their weights.
        phases: Arc<[PhaseWeights]>,
    },
    /// `field/sharpen`: the first plane pushed away from the second.
    Sharpen {
        /// How far.
        gain: f32,
    },
    /// `field/shift`: the value some way off.
    Shift {
        /// Whole samples.
        cell: [i32; 2],
        /// And the rest, 0..1.
        fraction: [f32; 2],
    },
    /// `field/thermal`: a half of an iteration of thermal erosion; of its shares the last input may be the hardness.
    Thermal {
        /// Which one.
        phase: ThermalPhase,
        /// The rock.
        kernel: Arc<ThermalKernel>,
    },
    /// `field/pipes`: a part of an iteration of erosion by running water; of its ground the last input may be the hardness.
    Pipes {
        /// Which one.
        phase: PipesPhase,
        /// Rock and water.
        kernel: Arc<PipesKernel>,
    },
}

/// Halves of an iteration of thermal erosion; the numbers are the kernel's `phase`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum ThermalPhase {
    /// From heights to the shares that slide, and with more than one layer of rock the drops that hold.
    Shares = 0,
    /// From heights and shares to heights.
    Heights = 1,
}

/// Parts of erosion by running water; the numbers are the kernel's `phase`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum PipesPhase {
    /// From heights to ground, water and sediment: dry and clean.
    Begin = 0,
    /// From these to the first flows.
    FirstFlux = 1,
    /// From these and the flows before to the flows.
    Flux = 2,
    /// From these and the flows to ground, water and sediment.
    Ground = 3,
    /// From these to heights: what is carried is laid down.
    Settle = 4,
}

impl Step {
    /// Values a sample of what it makes.
    #[must_use]
    pub fn num_channels(&self) -> u32 {
        match self {
            Self::Thermal { phase: ThermalPhase::Shares, kernel } if kernel.num_layers > 1 => 2,
            Self::Pipes { phase: PipesPhase::Begin | PipesPhase::Ground, .. } => 3,
            Self::Pipes { phase: PipesPhase::FirstFlux | PipesPhase::Flux, .. } => 4,
            _ => 1,
        }
    }

    /// Whether there is nothing beyond the terrain's border, rather than the terrain mirrored.
    #[must_use]
    pub const fn is_closed(&self) -> bool {
        matches!(self, Self::Thermal { .. } | Self::Pipes { .. })
    }

    /// Whether it is made of no other plane.
    #[must_use]
    pub const fn is_given(&self) -> bool {
        matches!(
            self,
            Self::Heights
                | Self::Field(_)
                | Self::Raster(_)
                | Self::Region(_)
                | Self::Gate(_)
                | Self::Weights(_)
        )
    }

    /// Where its plane is mirrored, on a terrain of so many samples along x and z: at the border of what it is a part of, where it is
    /// given; where its first input is, for a filter that sums what lies on both sides alike.
    #[must_use]
    pub fn mirrors(&self, terrain: [u32; 2], first: Mirrors) -> Mirrors {
        match self {
            Self::Raster(plane) => Mirrors::of_extent([plane.rect().width(), plane.rect().depth()]),
            _ if self.is_given() => Mirrors::of_extent(terrain),
            Self::Convolve { axis, stride, .. } => axis.of_mirrors(first, |period| {
                period.filter(|period| period.is_multiple_of(*stride))?.checked_div(*stride)
            }),
            // What lies between two samples has other bits when it is made from behind.
            Self::Interpolate { axis, .. } => axis.of_mirrors(first, |_| None),
            _ => Mirrors::NONE,
        }
    }

    /// Along which axis it filters its one input.
    pub(super) const fn filtered_axis(&self) -> Option<Axis> {
        match self {
            Self::Convolve { axis, .. } | Self::Interpolate { axis, .. } => Some(*axis),
            _ => None,
        }
    }

    /// What an input must have for it to make a rectangle.
    pub(crate) fn source_rect(&self, rect: &SampleRect, input: usize) -> SampleRect {
        let filtered = |first: i32, end: i32, stride: u32, weights: &[f32]| {
            let (stride, radius) = (stride.cast_signed(), weights.len() as i32);
            (first * stride - radius, (end - 1) * stride + radius + 1)
        };
        let coarse = |first: i32, end: i32, phases: &[PhaseWeights]| {
            let factor = phases.len().max(1) as i32;
            (first.div_euclid(factor) - 1, (end - 1).div_euclid(factor) + 3)
        };
        let SampleRect { x0, z0, x1, z1 } = *rect;
        let ((x0, x1), (z0, z1)) = match self {
            Self::Heights
            | Self::Field(_)
            | Self::Raster(_)
            | Self::Region(_)
            | Self::Gate(_)
            | Self::Weights(_) => ((x0, x1), (z0, z1)),
            Self::Band { .. } if input >= 2 => (coarse(x0, x1, &PYRAMID_PHASES), (z0, z1)),
            Self::Sharpen { .. }
            | Self::Channel { .. }
            | Self::Lerp
            | Self::Combine { .. }
            | Self::Band { .. } => ((x0, x1), (z0, z1)),
            // The spline takes a sample more on each side.
            Self::Resample { placement, .. } | Self::Cover { placement, .. } => {
                let SampleRect { x0, z0, x1, z1 } = placement.source_rect(rect).grown(1);
                ((x0, x1), (z0, z1))
            }
            Self::Grab(kernel) => {
                let SampleRect { x0, z0, x1, z1 } = rect.grown(kernel.reach().ceil() as i32 + 3);
                ((x0, x1), (z0, z1))
            }
            Self::Pipes { phase: PipesPhase::Begin | PipesPhase::Settle, .. } => ((x0, x1), (z0, z1)),
            Self::Thermal { .. } | Self::Pipes { .. } => ((x0 - 1, x1 + 1), (z0 - 1, z1 + 1)),
            Self::Convolve { axis: Axis::X, stride, weights } => {
                (filtered(x0, x1, *stride, weights), (z0, z1))
            }
            Self::Convolve { axis: Axis::Z, stride, weights } => {
                ((x0, x1), filtered(z0, z1, *stride, weights))
            }
            Self::Interpolate { axis: Axis::X, phases } => (coarse(x0, x1, phases), (z0, z1)),
            Self::Interpolate { axis: Axis::Z, phases } => ((x0, x1), coarse(z0, z1, phases)),
            Self::Shift { cell: [x, z], .. } => ((x0 + x, x1 + x + 1), (z0 + z, z1 + z + 1)),
        };
        SampleRect::new(x0, z0, x1, z1)
    }
}
