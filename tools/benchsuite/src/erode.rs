//! `erode`: thermal erosion and running water over 2048 x 2048 resident samples, as fills through the CPU back end.
//!
//! Rates are samples times iterations a second. No library on the package registries erodes a heightfield, so there is nothing to
//! run beside them; the share of the limit is that of the bandwidth at which the same threads copy memory, 8 bytes for each
//! sample and iteration.

use anyhow::Result;
use orogeny_brush::{Batch, Canvas, CpuExecutor, Executor as _, Resources, plan_fill};
use orogeny_field::noise::Noise;
use orogeny_field::{Brush, BrushType, FieldId, PageLayout, Pipes, TerrainGrid, Thermal};
use orogeny_pages::MemoryPages;

use crate::limit::CopyLimit;
use crate::measure::Times;
use crate::report::{Figure, Report};

const SIDE: u64 = 2048;
const ITERATIONS: u32 = 20;
const NUM_SAMPLE_ITERATIONS: f64 = (SIDE * SIDE) as f64 * ITERATIONS as f64;

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let num_cores = std::thread::available_parallelism()?.get();
    let mut thread_counts = vec![1, num_cores];
    thread_counts.dedup();
    for num_threads in thread_counts {
        let mut limit = CopyLimit::new();
        let mut copies = Times::default();
        let mut cases = vec![];
        for (name, brush) in brushes() {
            cases.push((name, Fill::new(num_threads, &brush)?, Times::default()));
        }
        for _ in 0..repeat {
            limit.copy(&mut copies, num_threads);
            for (_, fill, times) in &mut cases {
                fill.measure(times)?;
            }
        }
        let copy_bytes_per_s = CopyLimit::bytes() / copies.median_s();
        for (name, _, times) in cases {
            let name = format!("erode {name} as a fill, {num_threads} threads");
            report.add(Figure::rate(name, &times, NUM_SAMPLE_ITERATIONS, Some(copy_bytes_per_s)));
        }
    }
    Ok(())
}

fn brushes() -> [(&'static str, Brush); 2] {
    let thermal = Thermal { iterations: ITERATIONS, ..Thermal::default() };
    let pipes = Pipes { iterations: ITERATIONS, ..Pipes::default() };
    [
        ("thermal", Brush { thermal, ..Brush::new(BrushType::ErodeThermal, 1.0, 1.0) }),
        ("fluvial", Brush { pipes, ..Brush::new(BrushType::ErodeFluvial, 1.0, 1.0) }),
    ]
}

/// The brush as users have it: a fill over resident pages.
struct Fill {
    executor: CpuExecutor,
    pages: MemoryPages,
    pieces: Vec<Batch>,
}

impl Fill {
    fn new(num_threads: usize, brush: &Brush) -> Result<Self> {
        let layout = PageLayout::default();
        let grid = TerrainGrid::new(SIDE, SIDE, 4.0)?;
        let canvas = Canvas::heights(grid, layout, FieldId(0));
        let executor = CpuExecutor::new(layout, 1 << 30, Some(num_threads))?;
        let noise = Noise { feature_size_m: 900.0, ..Noise::default() };
        let ground = Brush { noise, ..Brush::new(BrushType::Noise, 1.0, 300.0) };
        let ground = plan_fill(&ground, 3, canvas, Resources::default(), grid.bounds())?;
        let erosion = plan_fill(brush, 0, canvas, Resources::default(), grid.bounds())?;
        let mut fill = Self { executor, pages: MemoryPages::new(layout, 0.0), pieces: Vec::new() };
        fill.executor.run(&ground, &mut fill.pages)?;
        fill.executor.finish(&mut fill.pages)?;
        fill.pages.commit();
        fill.pieces = erosion.split(layout, usize::MAX).collect();
        Ok(fill)
    }

    /// Ends the operation too, outside of what is measured.
    fn measure(&mut self, times: &mut Times) -> Result<()> {
        times
            .measure(|| self.pieces.iter().try_for_each(|piece| self.executor.run(piece, &mut self.pages)))?;
        self.executor.finish(&mut self.pages)?;
        self.pages.commit();
        Ok(())
    }
}
