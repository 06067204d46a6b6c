//! `clone`: ground cloned over 4096 x 4096 samples, as a fill of resident pages through the CPU back end, feathered and by Laplacian
//! pyramids of 6 levels, beside such a blend of two fields and a mask by OpenCV's `pyrDown` and `pyrUp`.
//!
//! The share of the limit is that of OpenCV's rate on the same threads.

use anyhow::Result;
use orogeny_field::{Alignment, Brush, BrushType, CloneBlend, CloneSource, Cloning};

use crate::fill::Fill;
use crate::measure::{Times, thread_counts};
use crate::python;
use crate::report::{Figure, Report, Unit};

const SIDE: u64 = 4096;
const NUM_SAMPLES: f64 = (SIDE * SIDE) as f64;
const NUM_LEVELS: u32 = 6;

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let python = python::interpreter(report);
    let rough = Brush::new(BrushType::Roughen, 1.0, 100.0);
    for num_threads in thread_counts()? {
        let mut limit = None;
        for (name, blend, scale) in [
            ("laplacian", CloneBlend::Laplacian, 1.0),
            ("feathered", CloneBlend::Feathered, 1.0),
            ("feathered, enlarged", CloneBlend::Feathered, 1.5),
        ] {
            let mut fill = Fill::new(num_threads, SIDE, 1.0, Some(&rough), &clone(blend, scale))?;
            let (mut own, mut theirs) = (Times::default(), Times::default());
            for _ in 0..repeat {
                fill.measure(&mut own)?;
                if let Some(python) = python.as_ref().filter(|_| blend == CloneBlend::Laplacian) {
                    let [seconds] = with_opencv(python, num_threads)?;
                    theirs.add(seconds);
                }
            }
            let mut add = |name: String, times: &Times, limit| {
                let name = format!("{name}, {num_threads} threads");
                report.add(Figure::per_second(name, Unit::SamplesPerSecond, times, NUM_SAMPLES, limit));
            };
            if !theirs.is_empty() {
                limit = Some(NUM_SAMPLES / theirs.median_s());
                add("clone OpenCV pyramids".to_owned(), &theirs, None);
            }
            add(format!("clone as a fill, {name}"), &own, limit.filter(|_| blend == CloneBlend::Laplacian));
        }
    }
    Ok(())
}

/// Of ground of the same size.
fn clone(blend: CloneBlend, scale: f64) -> Brush {
    let source = CloneSource {
        to_m: Some([0.0, 0.0]),
        alignment: Alignment::Aligned,
        scale,
        ..CloneSource::default()
    };
    let cloning = Cloning { source, blend, num_levels: Some(NUM_LEVELS), level_weights: Vec::new() };
    Brush { cloning, ..Brush::new(BrushType::Clone, 1.0, 1.0) }
}

/// Seconds that OpenCV takes for a blend.
fn with_opencv(python: &std::ffi::OsStr, num_threads: usize) -> Result<[f64; 1]> {
    const PROGRAM: &str = r"
import sys, time, numpy, cv2
side, threads, num_levels = (int(argument) for argument in sys.argv[1:])
cv2.setNumThreads(threads)
random = numpy.random.default_rng(1)
dst, src, mask = (random.random((side, side), dtype=numpy.float32) for _ in range(3))

def pyramid(values):
    levels = [values]
    for _ in range(num_levels):
        levels.append(cv2.pyrDown(levels[-1]))
    return levels

def laplacian(values):
    levels = pyramid(values)
    return [cv2.subtract(a, cv2.pyrUp(b, dstsize=a.shape[::-1])) for a, b in zip(levels, levels[1:])] + levels[-1:]

def blend():
    levels = []
    for a, b, m in zip(laplacian(dst), laplacian(src), pyramid(mask)):
        levels.append(cv2.add(a, cv2.multiply(m, cv2.subtract(b, a))))
    result = levels[-1]
    for level in levels[-2::-1]:
        result = cv2.add(level, cv2.pyrUp(result, dstsize=level.shape[::-1]))
    return result

blend()
start = time.perf_counter()
blend()
print(time.perf_counter() - start)
";
    python::seconds(python, PROGRAM, &[SIDE.to_string(), num_threads.to_string(), NUM_LEVELS.to_string()])
}
