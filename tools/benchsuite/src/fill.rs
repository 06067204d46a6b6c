//! A brush as users have it, applied to a whole square of resident pages.

use std::sync::Arc;

use anyhow::Result;
use orogeny_brush::{
    Batch, Canvas, CloneGround, CpuExecutor, Executor, GpuBudget, GpuExecutor, Resources, plan_fill,
};
use orogeny_field::{Brush, BrushType, FieldId, PageLayout, Plane, SampleRect, TerrainGrid, hash};
use orogeny_gpu::Gpu;
use orogeny_pages::MemoryPages;

use crate::measure::Times;

/// Of pages.
const BUDGET_IN_BYTES: u64 = 1 << 30;
/// What brushes for masks paint.
const MASK: FieldId = FieldId(1);

/// A fill, again and again.
pub struct Fill {
    executor: Box<dyn Executor>,
    /// What is waited for.
    gpu: Option<Gpu>,
    pages: MemoryPages,
    pieces: Vec<Batch>,
}

impl Fill {
    /// Of `side` x `side` samples `spacing_m` apart, on ground that another brush has made of a plain, through the CPU back end.
    pub fn new(
        num_threads: usize,
        side: u64,
        spacing_m: f64,
        ground: Option<&Brush>,
        brush: &Brush,
    ) -> Result<Self> {
        let executor = CpuExecutor::new(PageLayout::default(), BUDGET_IN_BYTES, Some(num_threads))?;
        Self::through(Box::new(executor), None, side, spacing_m, ground, brush)
    }

    /// The same through the GPU back end.
    pub fn on_gpu(
        gpu: &Gpu,
        side: u64,
        spacing_m: f64,
        ground: Option<&Brush>,
        brush: &Brush,
    ) -> Result<Self> {
        let budget = GpuBudget { budget_in_bytes: BUDGET_IN_BYTES, layers_per_array: 64 };
        let executor = GpuExecutor::new(gpu.clone(), PageLayout::default(), budget)?;
        Self::through(Box::new(executor), Some(gpu.clone()), side, spacing_m, ground, brush)
    }

    fn through(
        executor: Box<dyn Executor>,
        gpu: Option<Gpu>,
        side: u64,
        spacing_m: f64,
        ground: Option<&Brush>,
        brush: &Brush,
    ) -> Result<Self> {
        let layout = PageLayout::default();
        let grid = TerrainGrid::new(side, side, spacing_m)?;
        let canvas = Canvas::heights(grid, layout, FieldId(0));
        let mut store = MemoryPages::new(layout, 0.0);
        let mut plan = |brush: &Brush| {
            let clone_ground =
                (brush.brush_type == BrushType::Clone).then(|| rough_ground(side as i32, spacing_m));
            let is_mask = brush.brush_type.is_for_masks();
            let field = if is_mask { MASK } else { canvas.field };
            let canvas = Canvas { field, is_mask, ..canvas };
            let resources = Resources { clone_ground, ..Resources::default() };
            plan_fill(brush, 3, canvas, resources, grid.bounds(), &mut store)
        };
        let mut fill = Self { executor, gpu, pages: MemoryPages::new(layout, 0.0), pieces: Vec::new() };
        if let Some(ground) = ground {
            fill.executor.run(&plan(ground)?, &mut fill.pages)?;
            fill.end()?;
        }
        fill.pieces = plan(brush)?.split(layout, usize::MAX).collect();
        Ok(fill)
    }

    /// Ends the operation too, outside of what is measured: the next one works anew.
    pub fn measure(&mut self, times: &mut Times) -> Result<()> {
        times.measure(|| -> Result<()> {
            self.pieces.iter().try_for_each(|piece| self.executor.run(piece, &mut self.pages))?;
            Ok(self.gpu.as_ref().map_or(Ok(()), Gpu::wait)?)
        })?;
        self.end()
    }

    fn end(&mut self) -> Result<()> {
        self.executor.finish(&mut self.pages)?;
        self.pages.commit();
        Ok(())
    }
}

/// What is cloned: data from outside, of the terrain's size.
fn rough_ground(side: i32, spacing_m: f64) -> CloneGround {
    let mut plane = Plane::constant(SampleRect::new(0, 0, side, side), 0.0);
    for (place, height) in (0_u32..).zip(plane.samples_mut()) {
        *height = 200.0 * hash::uniform(place, 0, 5);
    }
    CloneGround::Raster { heights: Arc::new(plane), spacing_m }
}
