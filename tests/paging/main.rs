//! Pages on their way through the executors: which are loaded, what a split changes (nothing), what a fault leaves behind
//! (nothing), and what absurd parameters do (nothing, or bounded work).

#![cfg(test)]

mod clamping;
mod device_loss;
mod extremes;
mod failing_store;
mod hang;
mod levels;
mod loads;
#[cfg(target_os = "linux")]
mod out_of_memory;
mod shared_device;
mod splits;

use orogeny_brush::{CpuExecutor, Executor, GpuBudget, GpuExecutor};
use orogeny_field::{Blending, Brush, BrushType, PageLayout, PointerSample, Stroke};
use orogeny_gpu::Gpu;
use orogeny_tests::Operation;

/// A budget of so many pages, one page a texture array where there are few.
fn gpu_executor(gpu: &Gpu, layout: PageLayout, num_pages: u64) -> GpuExecutor {
    let layers_per_array = if num_pages < 16 { 1 } else { 256 };
    let budget = GpuBudget { budget_in_bytes: num_pages * layout.size_in_bytes(), layers_per_array };
    GpuExecutor::new(gpu.clone(), layout, budget).unwrap()
}

fn cpu_executor(layout: PageLayout, num_pages: u64, num_threads: usize) -> CpuExecutor {
    CpuExecutor::new(layout, num_pages * layout.size_in_bytes(), Some(num_threads)).unwrap()
}

/// Both back ends with a budget of so many pages.
fn executors(gpu: &Gpu, layout: PageLayout, num_pages: u64) -> [Box<dyn Executor>; 2] {
    [Box::new(cpu_executor(layout, num_pages, 2)), Box::new(gpu_executor(gpu, layout, num_pages))]
}

fn stroke(brush: Brush, points: &[[f64; 2]]) -> Operation {
    // Pressure comes and goes along the stroke.
    let points = points
        .iter()
        .enumerate()
        .map(|(index, [x, z])| PointerSample::at(*x, *z).with_pressure([1.0, 0.4, 0.75][index % 3]));
    Operation::Stroke(Stroke { brush, seed: 99, points: points.collect() })
}

/// A loop over all pages of a terrain of 200 x 150 samples, and back over its own start.
const LOOP: [[f64; 2]; 8] = [
    [20.0, 20.0],
    [64.0, 64.0],
    [120.0, 30.0],
    [185.0, 70.0],
    [150.0, 140.0],
    [64.0, 128.0],
    [10.0, 100.0],
    [40.0, 15.0],
];

fn raise() -> Brush {
    Brush::new(BrushType::Raise, 17.3, 25.0)
}

fn wash() -> Brush {
    Brush { blending: Blending::Wash, ..Brush::new(BrushType::Level, 23.1, 0.8) }
}

fn build_up() -> Brush {
    Brush { blending: Blending::BuildUp, ..wash() }
}

fn ledge() -> Brush {
    Brush::new(BrushType::Ledge, 15.7, 40.0)
}

fn roughen() -> Brush {
    Brush::new(BrushType::Roughen, 20.9, 4.0)
}
