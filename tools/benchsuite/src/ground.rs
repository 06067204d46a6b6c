//! Real ground and real strokes on it: what the product would commit.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use orogeny_brush::{Canvas, CpuExecutor, Executor as _, Resources, StrokePlanner};
use orogeny_field::{Brush, BrushType, FieldId, Page, PageKey, PageLayout, PointerSample, TerrainGrid};
use orogeny_formats::{ImportOptions, NodataPolicy};
use orogeny_pages::{MemoryPages, PageStore as _};
use orogeny_store::codec;

/// Samples a side of a page.
pub const SIDE: usize = orogeny_field::DEFAULT_PAGE_SIZE as usize;

/// Bytes of a page before it is coded.
pub const PAGE_BYTES: usize = SIDE * SIDE * 4;

const FIELD: FieldId = FieldId(0);
/// Metres between samples: that of the bundled terrain, north to south.
const SPACING_M: f64 = 30.0;
/// Samples from the middle of a stroke to its rim, and its instances: with them a stroke changes more than half of the ground.
const RADIUS: f64 = 165.0;
const MAX_INSTANCES: usize = 1 << 12;
const BUDGET_IN_BYTES: u64 = 1 << 30;

/// The whole pages of a raster.
pub struct Ground {
    pages: Vec<(PageKey, Page)>,
    grid: TerrainGrid,
}

/// The heights of a page before and after a stroke, mapped to ordered integers.
pub struct Change {
    pub before: Vec<u32>,
    pub after: Vec<u32>,
}

/// How the samples of a raster become heights.
#[derive(Clone, Copy)]
pub enum Sampling {
    /// As they are in the file.
    AsTheyAre,
    /// As an import does it by itself: resampled to square metres where the file says degrees.
    AsImported,
}

/// The terrain that ships with the program: whole metres.
pub fn bundled(sampling: Sampling) -> Result<Ground> {
    read(&root().join("assets/terrain/frazier_1024_int16.tif"), sampling)
}

/// Any raster that the program imports.
pub fn read(path: &Path, sampling: Sampling) -> Result<Ground> {
    let spacing_m = matches!(sampling, Sampling::AsTheyAre).then_some(SPACING_M);
    let options = ImportOptions { spacing_m, nodata: NodataPolicy::Fill, ..ImportOptions::default() };
    let mut import = orogeny_formats::open(path, &options)?;
    let (width, depth) = (import.info().width as usize, import.info().depth as usize);
    let mut heights = vec![0.0; width * depth];
    import.read_rows(&mut heights)?;
    let rows: Vec<&[f32]> = heights.chunks_exact(width).collect();
    let mut pages = Vec::new();
    for (band, z) in rows.chunks_exact(SIDE).zip(0..) {
        for x in 0..width / SIDE {
            let columns = x * SIDE..(x + 1) * SIDE;
            let samples = band.iter().filter_map(|row| row.get(columns.clone())).flatten().copied().collect();
            let key = PageKey::full_resolution(FIELD, u32::try_from(x)?, z);
            pages.push((key, Page::from_samples(PageLayout::default(), samples)?));
        }
    }
    let whole = |samples: usize| (samples / SIDE * SIDE) as u64;
    let grid = TerrainGrid::new(whole(width), whole(depth), SPACING_M)
        .with_context(|| format!("`{}` holds no page of {SIDE} x {SIDE} samples", path.display()))?;
    Ok(Ground { pages, grid })
}

impl Ground {
    /// The ordered values of each page.
    pub fn ordered(&self) -> Vec<Vec<u32>> {
        self.pages.iter().map(|(_, page)| codec::ordered_from_page(page)).collect()
    }

    /// Paints strokes one after another; gives for each the pages that it changed, with their place in [`Self::ordered`].
    /// `seed` decides their way.
    pub fn paint(&self, brushes: &[Brush], seed: u32) -> Result<Vec<Vec<(u32, Change)>>> {
        let layout = PageLayout::default();
        let mut executor = CpuExecutor::new(layout, BUDGET_IN_BYTES, None)?;
        let mut pages = MemoryPages::new(layout, 0.0);
        pages.save(self.pages.clone()).map_err(anyhow::Error::from_boxed)?;
        let mut painted = Vec::new();
        for (brush, number) in brushes.iter().zip(0..) {
            pages.commit();
            let seed = seed * 64 + number;
            let mut planner = StrokePlanner::new(
                brush,
                seed,
                Canvas::heights(self.grid, layout, FIELD),
                Resources::default(),
            )?;
            for point in way(&self.grid, seed) {
                planner.push(&point)?;
            }
            planner.finish();
            while let Some(batch) = planner.next_batch(&mut pages, MAX_INSTANCES)? {
                executor.run(&batch, &mut pages)?;
            }
            executor.finish(&mut pages)?;
            painted.push(changes(&self.pages, &mut pages)?);
        }
        Ok(painted)
    }
}

/// Raises the ground by 20 m, with the smooth falloff.
pub fn raise() -> Brush {
    Brush::new(BrushType::Raise, RADIUS * SPACING_M, 20.0)
}

/// Adds noise of up to half a metre each way.
pub fn roughen() -> Brush {
    Brush::new(BrushType::Roughen, RADIUS * SPACING_M, 0.5)
}

/// Up and down across the terrain in four bends that the seed shifts.
fn way(grid: &TerrainGrid, seed: u32) -> Vec<PointerSample> {
    let bounds = [grid.width(), grid.depth()].map(|samples| f64::from(samples) * grid.spacing_m());
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(0x9e37_79b9).wrapping_add(0x7f4a_7c15);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let [width_m, depth_m] = bounds;
    (0..4)
        .map(|bend| {
            let x_m = (f64::from(bend) + random()) / 4.0 * width_m;
            let z_m = (f64::from(bend % 2) * 0.5 + 0.5 * random()) * depth_m;
            PointerSample::at(x_m, z_m)
        })
        .collect()
}

/// The pages that differ from those before the stroke, in the order of the ground's.
fn changes(ground: &[(PageKey, Page)], pages: &mut MemoryPages) -> Result<Vec<(u32, Change)>> {
    let mut changes = Vec::new();
    for ((key, _), place) in ground.iter().zip(0..) {
        let before = pages.load_before(key).map_err(anyhow::Error::from_boxed)?;
        let after = pages.load(key).map_err(anyhow::Error::from_boxed)?;
        if let (Some(before), Some(after)) = (before, after)
            && before != after
        {
            let [before, after] = [before, after].map(|page| codec::ordered_from_page(&page));
            changes.push((place, Change { before, after }));
        }
    }
    Ok(changes)
}

/// The workspace's folder.
fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}
