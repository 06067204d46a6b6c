//! Kernels that look at neighbours, up to the planes that they make: which brush is which [`Graph`].
//!
//! What a graph gives is the goal that the kernel [`blend`](crate::kernels::blend) then pulls the ground to, instance by instance or as a
//! wash. The back ends work out graphs for the blocks of pages that a batch touches.

mod blocks;
pub(crate) mod cloning;
mod erosion;
mod gaussian;
pub(crate) mod grab;
mod graph;
pub mod kernels;
mod lattice;
mod pyramid;
pub(crate) mod region;
mod rounds;
mod step;
mod weights;

use std::sync::Arc;

use orogeny_field::{
    Alignment, Blending, Brush, BrushType, PipesKernel, SmoothMethod, TerrainGrid, ThermalKernel,
};

use crate::Result;
use crate::canvas::Canvas;
use crate::gate::GatePlan;

pub use blocks::{Block, blocks};
pub use cloning::{CloneGround, blend_fields};
pub use graph::{Graph, Node};
pub use region::{MAX_REGION_SAMPLES, RegionKernel, RegionRule};
pub use step::{Axis, MAX_INPUTS, PipesPhase, Step, ThermalPhase};
pub use weights::Weights;

/// What a brush pulls the ground to, and from which state of the ground it is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    /// The goal.
    pub graph: Arc<Graph>,
    /// Whether it is made of the ground as the instances before left it, one at a time, rather than of that before the
    /// stroke.
    pub is_sequential: bool,
}

/// The widest filter, in samples: about nine times as many are looked at for each sample, both ways.
pub const MAX_WIDTH_SAMPLES: f64 = 512.0;

impl Filter {
    /// The filter of a brush that has one and the same for all instances; erosion takes nothing of what is hard.
    ///
    /// # Errors
    /// [`orogeny_field::Error::BrushValue`] for a width of more samples than are looked at.
    pub fn of(brush: &Brush, canvas: &Canvas, hardness: Option<&Arc<GatePlan>>) -> Result<Option<Self>> {
        let grid = &canvas.grid;
        let mut graph = Graph::new([grid.width(), grid.depth()]);
        match brush.brush_type {
            BrushType::Smooth => match brush.smoothing.method {
                SmoothMethod::Gaussian => _ = gaussian::add(&mut graph, Graph::HEIGHTS, width(brush, grid)?),
                SmoothMethod::Lattice => _ = lattice::add(&mut graph, Graph::HEIGHTS, width(brush, grid)?),
            },
            BrushType::Sharpen => {
                let smoothed = gaussian::add(&mut graph, Graph::HEIGHTS, width(brush, grid)?);
                let gain = brush.smoothing.gain as f32;
                graph.add(Step::Sharpen { gain }, &[Graph::HEIGHTS, smoothed]);
            }
            BrushType::ErodeThermal => {
                let kernel = ThermalKernel::new(brush.brush_type.name(), &brush.thermal, grid.spacing_m())?;
                let ground = erosion::Ground::new(&mut graph, Graph::HEIGHTS, hardness);
                erosion::add_thermal(&mut graph, ground, kernel, brush.thermal.iterations);
            }
            BrushType::ErodeFluvial => {
                let kernel = PipesKernel::new(brush.brush_type.name(), &brush.pipes, grid.spacing_m())?;
                let ground = erosion::Ground::new(&mut graph, Graph::HEIGHTS, hardness);
                erosion::add_pipes(&mut graph, ground, kernel, brush.pipes.iterations);
            }
            BrushType::RainMask => {
                let kernel = PipesKernel::new(brush.brush_type.name(), &brush.pipes, grid.spacing_m())?;
                // A mask is made of the layer's heights, and not of itself.
                let heights = graph.add(Step::Field(canvas.heights), &[]);
                let ground = erosion::Ground::new(&mut graph, heights, hardness);
                let (iterations, mask) = (brush.pipes.iterations, &brush.rain_mask);
                erosion::add_rain_mask(&mut graph, ground, kernel, iterations, mask);
            }
            _ => return Ok(None),
        }
        Ok(Some(Self { graph: Arc::new(graph), is_sequential: is_sequential(brush) }))
    }

    /// What drags the ground along by `[x, z]` samples.
    #[must_use]
    pub fn drag(grid: &TerrainGrid, by: [f64; 2]) -> Self {
        let mut graph = Graph::new([grid.width(), grid.depth()]);
        let from = by.map(|by| -by);
        let cell = from.map(f64::floor);
        let ([x, z], [cell_x, cell_z]) = (from, cell);
        let fraction = [(x - cell_x) as f32, (z - cell_z) as f32];
        graph.add(Step::Shift { cell: cell.map(|cell| cell as i32), fraction }, &[Graph::HEIGHTS]);
        Self { graph: Arc::new(graph), is_sequential: true }
    }
}

/// Where a brush does not say how wide it smooths: its radius by this.
const DEFAULT_WIDTH_SHARE: f64 = 8.0;

/// Whether a brush waits for the stroke's end: what it makes of the ground takes long, and is made once.
pub(crate) const fn waits_for_end(brush_type: BrushType) -> bool {
    matches!(brush_type, BrushType::ErodeThermal | BrushType::ErodeFluvial | BrushType::RainMask)
        || region::is_region_wide(brush_type)
}

/// Whether a brush's instances each work on what those before them left all around them.
pub(crate) fn is_sequential(brush: &Brush) -> bool {
    match brush.brush_type {
        BrushType::Smooth | BrushType::Sharpen => brush.blending != Blending::Wash,
        BrushType::Smear => true,
        BrushType::Clone => brush.cloning.source.alignment == Alignment::Fixed,
        _ => false,
    }
}

/// How wide a brush smooths, in samples.
fn width(brush: &Brush, grid: &TerrainGrid) -> Result<f64> {
    match brush.smoothing.width_m.map(|width_m| width_m / grid.spacing_m()) {
        Some(width) if width > MAX_WIDTH_SAMPLES => Err(too_wide(brush, width, grid).into()),
        Some(width) => Ok(width),
        None => Ok((brush.radius_m / DEFAULT_WIDTH_SHARE / grid.spacing_m()).min(MAX_WIDTH_SAMPLES)),
    }
}

fn too_wide(brush: &Brush, width: f64, grid: &TerrainGrid) -> orogeny_field::Error {
    orogeny_field::Error::BrushValue {
        brush: brush.brush_type.name(),
        field: "width".to_owned(),
        value: format!("{} m", width * grid.spacing_m()),
        limit: format!(
            "it is {width} samples, and at most {MAX_WIDTH_SAMPLES} are smoothed over: give {} m or less",
            MAX_WIDTH_SAMPLES * grid.spacing_m()
        ),
    }
}
