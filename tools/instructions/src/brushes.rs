//! Kernels of single samples: how much an instance acts, and what brushes make of it.

use std::hint::black_box;

use anyhow::Result;
use orogeny_field::{
    AspectGate, Band, Falloff, FalloffFormula, Footprint, Gate, Instance, LevelOnly, Terrace, TerraceSteps,
    WeightMode,
};
use orogeny_reference::{amounts, brush, gate};

use crate::{DEPTH, Kernel, WIDTH, Work, rough_values, rough_weights};

pub const KERNELS: &[Kernel] = &[
    Kernel { name: "amounts/smooth", prepare: || amounts_of(FalloffFormula::Smooth, WeightMode::Direct) },
    Kernel { name: "amounts/gauss", prepare: || amounts_of(FalloffFormula::Gauss, WeightMode::Direct) },
    Kernel { name: "amounts/power", prepare: || amounts_of(FalloffFormula::Power, WeightMode::Direct) },
    Kernel { name: "amounts/build_up", prepare: || amounts_of(FalloffFormula::Smooth, WeightMode::BuildUp) },
    Kernel { name: "amounts/gather", prepare: gather },
    Kernel {
        name: "brush/raise",
        prepare: || rows_of(|heights, amounts, _| brush::raise::row(heights, amounts)),
    },
    Kernel {
        name: "brush/level",
        prepare: || {
            rows_of(|heights, amounts, _| brush::level::row(heights, amounts, 320.0, LevelOnly::Both))
        },
    },
    Kernel {
        name: "brush/roughen",
        prepare: || rows_of(|heights, amounts, z| brush::roughen::row(heights, amounts, 0, z, 7)),
    },
    Kernel { name: "brush/terrace", prepare: terrace },
    Kernel { name: "gate/ground", prepare: gate_of_ground },
];

fn instance() -> Instance {
    Instance {
        cell: [WIDTH as i32 / 2, DEPTH as i32 / 2],
        inverse_radius: 2.0 / WIDTH as f32,
        amplitude: 0.5,
        flow: 0.5,
        ..Instance::EVERYWHERE
    }
}

fn amounts_of(formula: FalloffFormula, weight_mode: WeightMode) -> Result<Work> {
    let falloff = Falloff { formula, exponent: 2.5, scale: 1.0, ..Falloff::HARD_EDGE };
    let footprint = Footprint { falloff, weight_mode, ..Footprint::EVERYWHERE };
    let (instance, mut amounts) = (instance(), vec![0.0; WIDTH]);
    Ok(Box::new(move || {
        for z in 0..DEPTH as i32 {
            amounts::row(&mut amounts, 0, z, &instance, &footprint);
            black_box(&mut amounts);
        }
    }))
}

fn gather() -> Result<Work> {
    let amounts = rough_weights(WIDTH);
    let mut weights = vec![0.0; WIDTH];
    Ok(Box::new(move || {
        for _ in 0..DEPTH {
            amounts::gather(&mut weights, &amounts, black_box(0.5));
        }
        black_box(&mut weights);
    }))
}

/// What a brush makes of rows of heights, given amounts from 0 to 1.
fn rows_of(row: impl Fn(&mut [f32], &[f32], i32) -> u32 + 'static) -> Result<Work> {
    let amounts = rough_weights(WIDTH);
    let mut heights = rough_values(WIDTH * DEPTH);
    Ok(Box::new(move || {
        for (z, heights) in (0..).zip(heights.chunks_mut(WIDTH)) {
            black_box(row(heights, &amounts, z));
        }
    }))
}

fn terrace() -> Result<Work> {
    let steps = TerraceSteps::new(&Terrace::default(), 1.0, [0, 0]);
    rows_of(move |heights, amounts, z| brush::terrace::row(heights, amounts, [0, z], &steps))
}

fn gate_of_ground() -> Result<Work> {
    let band = |min, max| Some(Band { min, max, feather: 5.0 });
    let gate = Gate {
        slope_deg: band(5.0, 40.0),
        height_m: band(310.0, 340.0),
        aspect: Some(AspectGate { angle_deg: 30.0, width_deg: 90.0, feather_deg: 20.0 }),
        ..Gate::default()
    };
    let ground = rough_values((WIDTH + 2) * (DEPTH + 2));
    let mut weights = vec![1.0; WIDTH];
    Ok(Box::new(move || {
        let rows: Vec<_> = ground.chunks(WIDTH + 2).collect();
        for rows in rows.windows(3) {
            let &[north, here, south] = rows else { continue };
            weights.fill(1.0);
            gate::multiply_by_ground(
                &mut weights,
                &gate,
                &gate::Ground { north, here, south, spacing_m: 4.0 },
            );
            black_box(&mut weights);
        }
    }))
}
