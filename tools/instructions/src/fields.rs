//! Kernels that look at neighbours, and what layers are joined by.

use std::hint::black_box;

use anyhow::Result;
use orogeny_field::{
    Blend, PYRAMID_PHASES, PYRAMID_WEIGHTS, Pipes, PipesKernel, Plane, SampleRect, Thermal, ThermalKernel,
    gaussian_weights,
};
use orogeny_reference::field::{Channel, band, coarsen, compose, convolve, interpolate, pipes, thermal};

use crate::{DEPTH, Kernel, WIDTH, Work, rough_values, rough_weights};

pub const KERNELS: &[Kernel] = &[
    Kernel { name: "field/convolve_x", prepare: || convolve_along_x(&gaussian_weights(3.7), 1) },
    Kernel { name: "field/convolve_x_of_two", prepare: || convolve_along_x(&PYRAMID_WEIGHTS, 2) },
    Kernel { name: "field/convolve_z", prepare: convolve_along_z },
    Kernel { name: "field/interpolate_x", prepare: interpolate_along_x },
    Kernel { name: "field/interpolate_z", prepare: interpolate_along_z },
    Kernel { name: "field/band", prepare: band_rows },
    Kernel { name: "field/compose", prepare: compose_rows },
    Kernel { name: "field/coarsen", prepare: coarsen_rows },
    Kernel { name: "field/thermal", prepare: thermal_iteration },
    Kernel { name: "field/pipes", prepare: pipes_iteration },
];

fn convolve_along_x(weights: &[f32], stride: usize) -> Result<Work> {
    let source = rough_values(convolve::source_length(WIDTH, weights.len(), stride));
    let (weights, mut target) = (weights.to_vec(), vec![0.0; WIDTH]);
    Ok(Box::new(move || {
        for _ in 0..DEPTH {
            convolve::row_along_x(&mut target, &source, &weights, black_box(stride));
        }
        black_box(&mut target);
    }))
}

fn convolve_along_z() -> Result<Work> {
    let weights = gaussian_weights(3.7);
    let source = rough_values(WIDTH * (DEPTH + 2 * weights.len()));
    let mut target = vec![0.0; WIDTH];
    Ok(Box::new(move || {
        let rows: Vec<_> = source.chunks(WIDTH).collect();
        for rows in rows.windows(2 * weights.len() + 1) {
            convolve::row_along_z(&mut target, rows, &weights);
            black_box(&mut target);
        }
    }))
}

fn interpolate_along_x() -> Result<Work> {
    let (source, mut target) = (rough_values(WIDTH / 2 + 4), vec![0.0; WIDTH]);
    Ok(Box::new(move || {
        for _ in 0..DEPTH {
            interpolate::row_along_x(&mut target, &source, &PYRAMID_PHASES, black_box(0));
        }
        black_box(&mut target);
    }))
}

fn interpolate_along_z() -> Result<Work> {
    let (source, mut target) = (rough_values(WIDTH * (DEPTH + 3)), vec![0.0; WIDTH]);
    Ok(Box::new(move || {
        let rows: Vec<_> = source.chunks(WIDTH).collect();
        for (rows, weights) in rows.windows(4).zip(PYRAMID_PHASES.iter().cycle()) {
            if let Some(rows) = rows.first_chunk() {
                interpolate::row_along_z(&mut target, *rows, weights);
            }
            black_box(&mut target);
        }
    }))
}

fn band_rows() -> Result<Work> {
    let [mask, level, coarser, below] = [WIDTH; 4].map(rough_values);
    let mut target = vec![0.0; WIDTH];
    Ok(Box::new(move || {
        for _ in 0..DEPTH {
            band::row(&mut target, &mask, &level, &coarser, &below, black_box(0.7));
        }
        black_box(&mut target);
    }))
}

fn compose_rows() -> Result<Work> {
    let (mut below, heights) = (rough_values(WIDTH), rough_values(WIDTH));
    let weights = rough_weights(WIDTH);
    Ok(Box::new(move || {
        for blend in [Blend::Add, Blend::Max, Blend::Multiply, Blend::Replace].into_iter().cycle().take(DEPTH)
        {
            compose::row(&mut below, &heights, &weights, blend);
        }
        black_box(&mut below);
    }))
}

fn coarsen_rows() -> Result<Work> {
    let rows = rough_values(3 * (WIDTH + 1));
    let mut above = vec![0.0; WIDTH / 2];
    Ok(Box::new(move || {
        let rows: Vec<_> = rows.chunks(WIDTH + 1).collect();
        for _ in 0..DEPTH {
            if let [north, centre, south] = rows.as_slice() {
                coarsen::row(&mut above, north, centre, south);
            }
            black_box(&mut above);
        }
    }))
}

fn thermal_iteration() -> Result<Work> {
    let kernel = ThermalKernel::new("erode", &Thermal::default(), 4.0)?;
    let rect = SampleRect::new(0, 0, WIDTH as i32, DEPTH as i32);
    let heights = Plane::from_samples(rect, 1, rough_values(WIDTH * DEPTH))?;
    let mut shares = Plane::constant(rect, 0.0);
    let mut new = vec![0.0; WIDTH];
    Ok(Box::new(move || {
        for z in 0..DEPTH as i32 {
            if let Some(row) = shares.row_mut(z) {
                thermal::shares_row(row, &mut [], 0, z, &heights, None, &rect, &kernel);
            }
        }
        for z in 0..DEPTH as i32 {
            thermal::heights_row(&mut new, 0, z, &heights, &shares, &rect, &kernel);
            black_box(&mut new);
        }
    }))
}

fn pipes_iteration() -> Result<Work> {
    let kernel = PipesKernel::new("erode", &Pipes::default(), 4.0)?;
    let rect = SampleRect::new(0, 0, WIDTH as i32, DEPTH as i32);
    let num_samples = WIDTH * DEPTH;
    let mut samples = rough_values(num_samples);
    samples.resize(3 * num_samples, 0.1);
    let state = Plane::from_samples(rect, 3, samples)?;
    let mut flux = Plane::with_channels(rect, 4, 0.01);
    let mut new = [(); 3].map(|()| vec![0.0; WIDTH]);
    Ok(Box::new(move || {
        let channel = |number| Channel(&state, number);
        for z in 0..DEPTH as i32 {
            let channels: Vec<_> = flux.samples_mut().chunks_mut(num_samples).collect();
            let Ok(channels) = <[_; 4]>::try_from(channels) else { return };
            let first = z as usize * WIDTH;
            let rows = channels.map(|channel| channel.get_mut(first..first + WIDTH).unwrap_or_default());
            pipes::flux_row(rows, 0, z, channel(pipes::TERRAIN), channel(pipes::WATER), &rect, &kernel);
        }
        let before = pipes::State {
            terrain: channel(pipes::TERRAIN),
            water: channel(pipes::WATER),
            sediment: channel(pipes::SEDIMENT),
        };
        for z in 0..DEPTH as i32 {
            let [terrain, water, sediment] = &mut new;
            let row = pipes::StateRow { terrain, water, sediment };
            pipes::ground_row(row, 0, z, &before, &flux, None, &rect, &kernel);
            black_box(&mut new);
        }
    }))
}
