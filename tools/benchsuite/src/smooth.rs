//! `smooth`: Gaussians of several widths over 4096 x 4096 samples, as a fill of resident pages through the CPU back end, beside
//! OpenCV's exact `GaussianBlur` and its `stackBlur`, which is faster and no Gaussian.
//!
//! The share of the limit is that of `GaussianBlur`'s rate on the same threads; then the same fills through the GPU back end.

use anyhow::Result;
use orogeny_field::{Brush, BrushType, Smoothing};

use crate::adapter;
use crate::fill::Fill;
use crate::measure::{Times, thread_counts};
use crate::python;
use crate::report::{Figure, Report, Unit};

const SIDE: u64 = 4096;
const NUM_SAMPLES: f64 = (SIDE * SIDE) as f64;
/// Samples a side of what goes through the GPU back end, which may be a software driver.
const ADAPTER_SIDE: u64 = 2048;
/// Standard deviations in samples: those of windows of a radius of 8, 32 and 128 in OpenCV, and wider.
const SIGMAS: [f64; 4] = [8.0 / 3.0, 32.0 / 3.0, 128.0 / 3.0, 256.0];
/// Fields and windows wider than that take OpenCV minutes.
const MAX_OPENCV_SIGMA: f64 = 128.0 / 3.0;

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let python = python::interpreter(report);
    let rough = Brush::new(BrushType::Roughen, 1.0, 100.0);
    for num_threads in thread_counts()? {
        for sigma in SIGMAS {
            let brush = smooth(sigma);
            let mut fill = Fill::new(num_threads, SIDE, 1.0, Some(&rough), &brush)?;
            let (mut own, mut gaussian, mut stack) = (Times::default(), Times::default(), Times::default());
            for _ in 0..repeat {
                fill.measure(&mut own)?;
                if let Some(python) = python.as_ref().filter(|_| sigma <= MAX_OPENCV_SIGMA) {
                    let [gaussian_s, stack_s] = with_opencv(python, sigma, num_threads)?;
                    gaussian.add(gaussian_s);
                    stack.add(stack_s);
                }
            }
            let limit = (!gaussian.is_empty()).then(|| NUM_SAMPLES / gaussian.median_s());
            let mut add = |name: &str, times: &Times| {
                let name = format!("{name}, sigma {sigma:.1}, {num_threads} threads");
                report.add(Figure::per_second(name, Unit::SamplesPerSecond, times, NUM_SAMPLES, limit));
            };
            add("smooth as a fill", &own);
            if !gaussian.is_empty() {
                add("smooth OpenCV GaussianBlur", &gaussian);
                add("smooth OpenCV stackBlur", &stack);
            }
        }
    }
    let case = |sigma| adapter::Case {
        name: format!("smooth as a fill, sigma {sigma:.1}"),
        brush: smooth(sigma),
        ground: &rough,
        side: ADAPTER_SIDE,
        spacing_m: 1.0,
        iterations: 1,
        // Up to 4 samples it is a filter of that many, further on a pyramid.
        stencil_radius: if sigma < 4.0 { 11 } else { 2 },
    };
    adapter::run(report, repeat, &SIGMAS.map(case))
}

fn smooth(sigma: f64) -> Brush {
    let smoothing = Smoothing { width_m: Some(sigma), ..Smoothing::default() };
    Brush { smoothing, ..Brush::new(BrushType::Smooth, 1.0, 1.0) }
}

/// Seconds that OpenCV takes for its Gaussian and for its stack blur.
fn with_opencv(python: &std::ffi::OsStr, sigma: f64, num_threads: usize) -> Result<[f64; 2]> {
    const PROGRAM: &str = r"
import sys, time, numpy, cv2
side, sigma, threads = int(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
cv2.setNumThreads(threads)
field = numpy.random.default_rng(1).random((side, side), dtype=numpy.float32)
radius = round(3 * sigma)
target = numpy.empty_like(field)
window = (2 * radius + 1, 2 * radius + 1)
for work in (lambda: cv2.GaussianBlur(field, window, sigma, dst=target), lambda: cv2.stackBlur(field, window, dst=target)):
    work()
    start = time.perf_counter()
    work()
    print(time.perf_counter() - start)
";
    python::seconds(python, PROGRAM, &[SIDE.to_string(), sigma.to_string(), num_threads.to_string()])
}
