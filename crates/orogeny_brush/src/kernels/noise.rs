//! Noise: which seeds and places an instance's noise has, and what the kernel is given of them.

use orogeny_field::noise::{LatticePoint, LatticeStep, NoiseFrame, NoiseKernel};

use super::OwnData;
use crate::tiles::Tile;

/// The shader's stem.
pub const STEM: &str = "brush/noise";

/// The layout is that of `Noise` in `shaders/driver/noise.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct NoiseUniform {
    /// Of the four nearest distances.
    pub worley_weights: [f32; 4],
    /// Octaves of the main turbulence.
    pub num_main: u32,
    /// Octaves of each of the two that distort it.
    pub num_distortion: u32,
    /// How far they do, feature sizes.
    pub distortion_weight: f32,
    /// From one octave's weight to the next.
    pub main_gain: f32,
    /// The same of the distortion.
    pub distortion_gain: f32,
    /// Of the multifractals.
    pub elevation: f32,
    /// Subtracted from the sum.
    pub offset: f32,
    /// What the rest is multiplied by.
    pub scale: f32,
}

impl From<&NoiseKernel> for NoiseUniform {
    fn from(kernel: &NoiseKernel) -> Self {
        let [main_gain, distortion_gain] = kernel.gains.map(|gain| gain as f32);
        Self {
            worley_weights: kernel.worley_weights.map(|weight| weight as f32),
            num_main: kernel.slots.main,
            num_distortion: kernel.slots.distortion,
            distortion_weight: kernel.distortion_weight as f32,
            main_gain,
            distortion_gain,
            elevation: kernel.elevation as f32,
            offset: kernel.offset as f32,
            scale: kernel.scale as f32,
        }
    }
}

/// What does not depend on the tiles: the uniform, the frames, and the steps along the lattices.
pub(crate) fn data(kernel: &NoiseKernel, frames: &[NoiseFrame], is_rough: bool) -> OwnData {
    let rows = |direction| (0..kernel.slots.len()).map(move |slot| (direction, slot));
    let steps: Vec<LatticeStep> = (0..kernel.num_directions())
        .flat_map(rows)
        .map(|(direction, slot)| kernel.step(direction, slot))
        .collect();
    let octaves: Vec<_> = frames.iter().flat_map(|frame| frame.octaves.iter().copied()).collect();
    let mut data = OwnData::uniform(&NoiseUniform::from(kernel)).with_constants(&[
        ("NOISE_BASIS", kernel.basis as u32),
        ("NOISE_TURBULENCE", kernel.turbulence as u32),
        ("DISTORTION_TURBULENCE", kernel.distortion_turbulence as u32),
        ("FOLLOWS_STROKE", u32::from(kernel.num_directions() > 1)),
        ("HAS_TRANSFER", u32::from(kernel.transfer.is_some())),
        ("HAS_CURVE", u32::from(kernel.curve.is_some())),
        ("HAS_ROUGHNESS", u32::from(is_rough)),
    ]);
    data.storage = vec![bytemuck::cast_slice(&octaves).to_vec(), bytemuck::cast_slice(&steps).to_vec()];
    data
}

/// Where each tile lies on the lattices: one place for each direction and octave. Tells the tiles where theirs begin.
pub(crate) fn lattice(kernel: &NoiseKernel, tiles: &mut [Tile]) -> Vec<LatticePoint> {
    let mut lattice = Vec::with_capacity(tiles.len() * kernel.num_directions() * kernel.slots.len());
    for tile in tiles {
        tile.first_lattice = lattice.len() as u32;
        let origin = tile.lattice_block_origin();
        for direction in 0..kernel.num_directions() {
            lattice.extend((0..kernel.slots.len()).map(|slot| kernel.lattice(direction, slot, origin)));
        }
    }
    lattice
}
