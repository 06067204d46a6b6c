//! `raise`: one instance after another on resident pages, against the copy bandwidth of the same threads.

use anyhow::Result;
use orogeny_brush::{Batch, CpuExecutor, Executor, GpuBudget, GpuExecutor};
use orogeny_field::{Brush, BrushType, PageLayout, ProfileShape};
use orogeny_gpu::{AdapterChoice, Gpu};
use orogeny_pages::MemoryPages;

use crate::dab::{dab, make_resident};
use crate::limit::CopyLimit;
use crate::measure::{Times, thread_counts};
use crate::report::{Figure, Report};

/// 512 MiB of heights, so that successive instances find their pages in memory and not in a cache.
const TERRAIN: [u64; 2] = [16_384, 8_192];
const RADII: [f64; 4] = [64.0, 256.0, 1000.0, 1024.0];
const PAGE_BUDGET_IN_BYTES: u64 = 2 << 30;

const SHAPES: [(&str, ProfileShape); 3] = [
    ("smooth", ProfileShape::Smooth),
    ("power 1", ProfileShape::Power { power: 1.0 }),
    ("gauss", ProfileShape::Gauss),
];

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    for num_threads in thread_counts()? {
        on_cpu(report, repeat, num_threads)?;
    }
    match Gpu::open(&AdapterChoice::RealGpu) {
        Ok(gpu) => on_gpu(report, repeat, gpu),
        Err(err) => {
            report.note(format!("GPU not measured: {err}"));
            Ok(())
        }
    }
}

fn on_cpu(report: &mut Report, repeat: usize, num_threads: usize) -> Result<()> {
    let mut limit = CopyLimit::new();
    let mut executor = CpuExecutor::new(PageLayout::default(), PAGE_BUDGET_IN_BYTES, Some(num_threads))?;
    let mut pages = MemoryPages::new(PageLayout::default(), 100.0);
    make_resident(&mut executor, &mut pages, TERRAIN)?;
    let mut copies = Times::default();
    let mut measured = cases()?;
    for _ in 0..repeat {
        limit.copy(&mut copies, num_threads);
        for case in &mut measured {
            case.measure(|batch| Ok(executor.run(batch, &mut pages)?))?;
        }
    }
    let copy_bytes_per_s = CopyLimit::bytes() / copies.median_s();
    report.add(Figure::rate(format!("copy, {num_threads} threads"), &copies, CopyLimit::bytes() / 8.0, None));
    for case in measured {
        let name = format!("raise {} r {}, CPU {num_threads} threads", case.shape, case.radius);
        report.add(Figure::rate(name, &case.times, case.num_samples, Some(copy_bytes_per_s)));
    }
    Ok(())
}

/// On a GPU a run ends with waiting for the device, so the figure holds the whole way of a batch. The limit is the CPU's
/// figure above it; the device's own copy bandwidth belongs to the benchmark of kernels.
fn on_gpu(report: &mut Report, repeat: usize, gpu: Gpu) -> Result<()> {
    let budget = GpuBudget { budget_in_bytes: PAGE_BUDGET_IN_BYTES, layers_per_array: 256 };
    let name = gpu.description().name.clone();
    let mut executor = GpuExecutor::new(gpu.clone(), PageLayout::default(), budget)?;
    let mut pages = MemoryPages::new(PageLayout::default(), 100.0);
    make_resident(&mut executor, &mut pages, TERRAIN)?;
    let mut measured = cases()?;
    for _ in 0..repeat {
        for case in &mut measured {
            case.measure(|batch| {
                executor.run(batch, &mut pages)?;
                Ok(gpu.wait()?)
            })?;
        }
    }
    for case in measured {
        let name = format!("raise {} r {}, {name}", case.shape, case.radius);
        report.add(Figure::rate(name, &case.times, case.num_samples, None));
    }
    Ok(())
}

struct Case {
    shape: &'static str,
    radius: f64,
    /// Samples within the radius.
    num_samples: f64,
    /// One instance each, at different places.
    batches: Vec<Batch>,
    next: usize,
    times: Times,
}

impl Case {
    /// Measures the next batch.
    fn measure(&mut self, run: impl FnOnce(&Batch) -> Result<()>) -> Result<()> {
        self.next += 1;
        let index = self.next % self.batches.len();
        #[expect(clippy::indexing_slicing, reason = "the index is a remainder of the length")]
        let batch = &self.batches[index];
        self.times.measure(|| run(batch))
    }
}

fn cases() -> Result<Vec<Case>> {
    let mut cases = Vec::new();
    for (shape, profile) in SHAPES {
        for radius in RADII {
            let brush = Brush { shape: profile.clone(), ..Brush::new(BrushType::Raise, radius, 1.0) };
            // Off the sample and page grid, and far enough apart that a cache does not help.
            let batches = (0..5)
                .map(|place| {
                    let x = 1100.3 + 3200.0 * f64::from(place);
                    dab(&brush, TERRAIN, [x.min(15_200.0), 2000.7 + 900.0 * f64::from(place)])
                })
                .collect::<Result<Vec<_>>>()?;
            let num_samples = std::f64::consts::PI * radius * radius;
            cases.push(Case { shape, radius, num_samples, batches, next: 0, times: Times::default() });
        }
    }
    Ok(cases)
}
