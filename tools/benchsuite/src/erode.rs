//! `erode`: thermal erosion, running water, droplets, filled pits and masks of flow over 2048 x 2048 resident samples, as fills
//! through the CPU back end.
//!
//! Rates are samples times iterations a second; of droplets, one of them for each sample, droplets a second. No library on the
//! package registries erodes a heightfield, so there is nothing to run beside them; the share of the limit is that of the bandwidth at
//! which the same threads copy memory, 8 bytes for each sample and iteration. Then the erosions that a GPU works out, through that
//! back end.

use anyhow::Result;
use orogeny_field::noise::Noise;
use orogeny_field::{Brush, BrushType, FlowRouting, Pipes, Thermal};

use crate::adapter;
use crate::fill::Fill;
use crate::limit::CopyLimit;
use crate::measure::{Times, thread_counts};
use crate::report::{Figure, Report};

const SIDE: u64 = 2048;
const ITERATIONS: u32 = 20;
/// Samples a side of what goes through the GPU back end, which may be a software driver.
const ADAPTER_SIDE: u64 = 1024;
const NUM_SAMPLES: f64 = (SIDE * SIDE) as f64;

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    for num_threads in thread_counts()? {
        let mut limit = CopyLimit::new();
        let mut copies = Times::default();
        let mut cases = vec![];
        for (name, brush, iterations) in brushes() {
            let fill = Fill::new(num_threads, SIDE, 4.0, Some(&hills()), &brush)?;
            cases.push((name, iterations, fill, Times::default()));
        }
        for _ in 0..repeat {
            limit.copy(&mut copies, num_threads);
            for (.., fill, times) in &mut cases {
                fill.measure(times)?;
            }
        }
        let copy_bytes_per_s = CopyLimit::bytes() / copies.median_s();
        for (name, iterations, _, times) in cases {
            let name = format!("erode {name} as a fill, {num_threads} threads");
            let num = NUM_SAMPLES * f64::from(iterations);
            report.add(Figure::rate(name, &times, num, Some(copy_bytes_per_s)));
        }
    }
    let hills = hills();
    let [thermal, fluvial, ..] = brushes();
    let case = |(name, brush, iterations): (&str, Brush, u32)| adapter::Case {
        name: format!("erode {name} as a fill"),
        brush,
        ground: &hills,
        side: ADAPTER_SIDE,
        spacing_m: 4.0,
        iterations,
        stencil_radius: 2,
    };
    adapter::run(report, repeat, &[thermal, fluvial].map(case))
}

/// Each with its iterations.
fn brushes() -> [(&'static str, Brush, u32); 6] {
    let thermal = Thermal { iterations: ITERATIONS, ..Thermal::default() };
    let pipes = Pipes { iterations: ITERATIONS, ..Pipes::default() };
    let flow_routing = FlowRouting::shared();
    let shared = Brush { flow_routing, ..Brush::new(BrushType::FlowMask, 1.0, 1.0) };
    [
        ("thermal", Brush { thermal, ..Brush::new(BrushType::ErodeThermal, 1.0, 1.0) }, ITERATIONS),
        ("fluvial", Brush { pipes, ..Brush::new(BrushType::ErodeFluvial, 1.0, 1.0) }, ITERATIONS),
        ("droplets", Brush::new(BrushType::ErodeDroplets, 1.0, 1.0), 1),
        // Half of the way, so that pits are left for the next time.
        ("filled pits", Brush::new(BrushType::FillPits, 1.0, 0.5), 1),
        ("flow mask", Brush::new(BrushType::FlowMask, 1.0, 1.0), 1),
        ("shared flow mask", shared, 1),
    ]
}

fn hills() -> Brush {
    let noise = Noise { feature_size_m: 900.0, ..Noise::default() };
    Brush { noise, ..Brush::new(BrushType::Noise, 1.0, 300.0) }
}
