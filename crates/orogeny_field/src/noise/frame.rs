//! What an instance adds to a noise: its seed, the octaves' own offsets, and where its coordinates begin.

use super::{LatticePoint, NoiseKernel, skewed};
use crate::hash::hash;

/// One row of a frame. The layout is that of `FrameOctave` in `shaders/driver/noise.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct FrameOctave {
    /// Added to the lattice place of a sample: its cell, wrapped to 32 bits.
    pub cell: [u32; 3],
    /// The octave's seed.
    pub seed: u32,
    /// The rest of what is added, 0..1.
    pub fraction: [f32; 3],
    /// In which direction the pattern is laid.
    pub direction: u32,
}

/// Everything of a noise that may differ from instance to instance.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseFrame {
    /// In which direction the pattern is laid.
    pub direction: usize,
    /// One for each row of the octave tables.
    pub octaves: Vec<FrameOctave>,
}

impl NoiseFrame {
    /// The frame of a seed, in the world's coordinates or, with `centre` in samples of the terrain, in those of an instance.
    ///
    /// Octave `l` of turbulence `m` has the seed `hash(l, m, n)` and is moved by uniforms of `hash(l, 0x51 + 16m, n)` and so on,
    /// so that octaves share no lattice point and one seed is not another one zoomed.
    #[must_use]
    pub fn new(kernel: &NoiseKernel, seed: u32, direction: usize, centre: Option<[f64; 2]>) -> Self {
        let slots = kernel.slots;
        let rows = (0..slots.main)
            .map(|l| (0, l))
            .chain([1, 2].into_iter().flat_map(|m| (0..slots.distortion).map(move |l| (m, l))));
        let octaves = rows
            .map(|(m, l)| {
                let frequency = kernel.scales.get(slots.index(m, l)).map_or(1.0, |scale| scale.frequency);
                let [mut x, mut y, w] = kernel.octave_origin(seed, m, l);
                if let (Some(affine), Some([centre_x, centre_z])) = (kernel.directions.get(direction), centre)
                {
                    let [[xx, xz], [zx, zz]] = affine.columns;
                    x -= frequency * (centre_x * xx + centre_z * zx);
                    y -= frequency * (centre_x * xz + centre_z * zz);
                }
                let LatticePoint { cell, fraction, .. } = LatticePoint::of(skewed(kernel.basis, [x, y, w]));
                FrameOctave { cell, seed: hash(l, m, seed), fraction, direction: direction as u32 }
            })
            .collect();
        Self { direction, octaves }
    }
}
