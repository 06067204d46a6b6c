//! `noise`: eight octaves of gradient fBm over 4096 x 4096 samples, as a fill through the CPU back end and by themselves, beside
//! the noise libraries that a Rust program would take instead: fastnoise-lite and simdnoise.
//!
//! The share of the limit is that of fastnoise-lite's rate on the same threads.

use anyhow::Result;
use fastnoise_lite::{FastNoiseLite, FractalType, NoiseType};
use orogeny_field::noise::{Basis, LATTICE_BLOCK, Noise, NoiseFrame, NoiseKernel, Normalization, Turbulence};
use orogeny_field::{Brush, BrushType};
use orogeny_reference::noise::row::{self, LatticeBlock};
use rayon::prelude::*;
use simdnoise::NoiseBuilder;

use crate::fill::Fill;
use crate::measure::{Times, thread_counts};
use crate::report::{Figure, Report, Unit};

const SIDE: usize = 4096;
/// Samples of the first octave's cell.
const FEATURE: f32 = 256.0;
const OCTAVES: u32 = 8;
const NUM_SAMPLES: f64 = (SIDE * SIDE) as f64;
/// Rows that are worked of bases that take many times as long.
const FEW_ROWS: usize = 256;

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    for num_threads in thread_counts()? {
        on_threads(report, repeat, num_threads)?;
    }
    Ok(())
}

fn on_threads(report: &mut Report, repeat: usize, num_threads: usize) -> Result<()> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(num_threads).build()?;
    let mut values = vec![0.0_f32; SIDE * SIDE];
    let brush =
        Brush { noise: noise(Basis::Gradient, Turbulence::Fbm), ..Brush::new(BrushType::Noise, 1.0, 100.0) };
    let mut fill = Fill::new(num_threads, SIDE as u64, 1.0, None, &brush)?;
    let (mut lite, mut simd, mut filled) = (Times::default(), Times::default(), Times::default());
    let mut own: Vec<(Noise, Times)> = noises().into_iter().map(|noise| (noise, Times::default())).collect();
    for _ in 0..repeat {
        pool.install(|| lite.measure(|| with_fastnoise_lite(&mut values)));
        pool.install(|| simd.measure(|| with_simdnoise(&mut values)));
        fill.measure(&mut filled)?;
        for (noise, times) in &mut own {
            let kernel = NoiseKernel::new(noise, 1.0, [0.0; 2])?;
            let values = values.get_mut(..SIDE * num_rows(noise)).unwrap_or_default();
            pool.install(|| times.measure(|| with_own(values, &kernel)));
        }
    }
    let limit = NUM_SAMPLES / lite.median_s();
    let mut add = |name: String, times: &Times, num_samples: f64| {
        let name = format!("{name}, {num_threads} threads");
        report.add(Figure::per_second(name, Unit::SamplesPerSecond, times, num_samples, Some(limit)));
    };
    add("noise fastnoise-lite, Perlin fbm".to_owned(), &lite, NUM_SAMPLES);
    add("noise simdnoise, simplex fbm".to_owned(), &simd, NUM_SAMPLES);
    add("noise brush as a fill, gradient fbm".to_owned(), &filled, NUM_SAMPLES);
    for (noise, times) in &own {
        let name = format!("noise rows, {:?} {:?}", noise.basis, noise.turbulence).to_lowercase();
        add(name, times, (SIDE * num_rows(noise)) as f64);
    }
    Ok(())
}

fn noise(basis: Basis, turbulence: Turbulence) -> Noise {
    let normalization = Normalization::Off;
    Noise {
        basis,
        turbulence,
        feature_size_m: FEATURE.into(),
        octaves: OCTAVES,
        normalization,
        ..Noise::default()
    }
}

/// Every turbulence of gradient noise, and fBm of every other basis.
fn noises() -> Vec<Noise> {
    let turbulences = Turbulence::ALL.into_iter().map(|turbulence| noise(Basis::Gradient, turbulence));
    let bases = Basis::ALL.into_iter().skip(1).map(|basis| noise(basis, Turbulence::Fbm));
    turbulences.chain(bases).collect()
}

fn num_rows(noise: &Noise) -> usize {
    if matches!(noise.basis, Basis::Gradient | Basis::Simplex) { SIDE } else { FEW_ROWS }
}

fn with_fastnoise_lite(values: &mut [f32]) {
    let mut noise = FastNoiseLite::with_seed(1);
    noise.set_noise_type(Some(NoiseType::Perlin));
    noise.set_fractal_type(Some(FractalType::FBm));
    noise.set_fractal_octaves(Some(OCTAVES.cast_signed()));
    noise.set_fractal_lacunarity(Some(1.92));
    noise.set_fractal_gain(Some(0.574));
    noise.set_frequency(Some(1.0 / FEATURE));
    values.par_chunks_mut(SIDE).enumerate().for_each(|(z, row)| {
        for (x, value) in row.iter_mut().enumerate() {
            *value = noise.get_noise_2d(x as f32, z as f32);
        }
    });
}

fn with_simdnoise(values: &mut [f32]) {
    const ROWS: usize = 256;
    values.par_chunks_mut(SIDE * ROWS).enumerate().for_each(|(band, rows)| {
        let (made, _, _) = NoiseBuilder::fbm_2d_offset(0.0, SIDE, (band * ROWS) as f32, ROWS)
            .with_freq(1.0 / FEATURE)
            .with_octaves(OCTAVES as u8)
            .with_lacunarity(1.92)
            .with_gain(0.574)
            .generate();
        rows.copy_from_slice(&made);
    });
}

fn with_own(values: &mut [f32], kernel: &NoiseKernel) {
    const BLOCK: usize = LATTICE_BLOCK as usize;
    let frame = NoiseFrame::new(kernel, 1, 0, None);
    values.par_chunks_mut(SIDE * BLOCK).enumerate().for_each(|(band, rows)| {
        let mut made = [0.0; BLOCK];
        for x in (0..SIDE).step_by(BLOCK) {
            let block = LatticeBlock::around([x as i32, (band * BLOCK) as i32], kernel, &frame);
            for (within, row) in (0..).zip(rows.chunks_mut(SIDE)) {
                row::block_row(&mut made, within, kernel, &block, None);
                if let Some(values) = row.get_mut(x..x + BLOCK) {
                    values.copy_from_slice(&made);
                }
            }
        }
    });
}
