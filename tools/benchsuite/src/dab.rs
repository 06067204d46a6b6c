//! One instance of a brush, as plain data that an executor runs again and again.

use anyhow::{Context as _, Result};
use orogeny_brush::{Batch, Canvas, Executor, Resources, StrokePlanner};
use orogeny_field::{Brush, BrushType, FieldId, PageLayout, PointerSample, TerrainGrid};
use orogeny_pages::MemoryPages;

/// An instance at a place of a terrain of so many samples along x and z, one every metre.
pub fn dab(brush: &Brush, [width, depth]: [u64; 2], [x_m, z_m]: [f64; 2]) -> Result<Batch> {
    let layout = PageLayout::default();
    let canvas = Canvas::heights(TerrainGrid::new(width, depth, 1.0)?, layout, FieldId(0));
    let mut planner = StrokePlanner::new(brush, 0, canvas, Resources::default())?;
    planner.push(&PointerSample::at(x_m, z_m))?;
    planner.finish();
    planner.next_batch(&mut MemoryPages::new(layout, 100.0), 1)?.context("the dab lies outside the terrain")
}

/// Makes all pages of such a terrain resident, whose depth is at most its width.
pub fn make_resident(executor: &mut dyn Executor, pages: &mut MemoryPages, size: [u64; 2]) -> Result<()> {
    let [width, depth] = size.map(|samples| samples as f64);
    let brush = Brush { falloff_m: 0.0, ..Brush::new(BrushType::Raise, width, 1.0) };
    executor.run(&dab(&brush, size, [width / 2.0, depth / 2.0])?, pages)?;
    Ok(())
}
