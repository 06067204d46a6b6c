//! Noise, in rows of the blocks that it is worked out in.

use std::hint::black_box;

use anyhow::Result;
use orogeny_field::noise::{Basis, LATTICE_BLOCK, Noise, NoiseFrame, NoiseKernel, Normalization, Turbulence};
use orogeny_reference::noise::row::{self, LatticeBlock};

use crate::{Kernel, WIDTH, Work};

pub const KERNELS: &[Kernel] = &[
    Kernel { name: "noise/gradient_fbm", prepare: || rows_of(Basis::Gradient, Turbulence::Fbm) },
    Kernel { name: "noise/gradient_ridged", prepare: || rows_of(Basis::Gradient, Turbulence::Ridged) },
    Kernel { name: "noise/value_fbm", prepare: || rows_of(Basis::Value, Turbulence::Fbm) },
    Kernel { name: "noise/simplex_fbm", prepare: || rows_of(Basis::Simplex, Turbulence::Fbm) },
    Kernel { name: "noise/worley_fbm", prepare: || rows_of(Basis::Worley, Turbulence::Fbm) },
];

/// Eight octaves of a row of blocks.
fn rows_of(basis: Basis, turbulence: Turbulence) -> Result<Work> {
    const BLOCK: usize = LATTICE_BLOCK as usize;
    let noise = Noise {
        basis,
        turbulence,
        octaves: 8,
        feature_size_m: 256.0,
        normalization: Normalization::Off,
        ..Noise::default()
    };
    let kernel = NoiseKernel::new(&noise, 1.0, [0.0; 2])?;
    Ok(Box::new(move || {
        let frame = NoiseFrame::new(&kernel, 1, 0, None);
        let mut values = [0.0; BLOCK];
        for x in (0..WIDTH).step_by(BLOCK) {
            let block = LatticeBlock::around([x as i32, 0], &kernel, &frame);
            for within in 0..LATTICE_BLOCK {
                row::block_row(&mut values, within, &kernel, &block, None);
                black_box(&mut values);
            }
        }
    }))
}
