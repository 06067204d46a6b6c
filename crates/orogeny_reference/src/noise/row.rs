//! Rows of a noise on a terrain's grid.

use multiversion::multiversion;
use orogeny_field::noise::{LATTICE_BLOCK, LatticePoint, LatticeStep, NoiseFrame, NoiseKernel};

use super::LANES;
use super::turbulence::{self, Places};
use crate::curve::look_up;

/// Where the samples of one lattice block lie on the lattice of each octave.
///
/// All of a block's samples are worked, whether they are asked for or not, from the same place: so neither how a terrain is cut
/// into pages nor which part of a row is painted changes a bit.
#[derive(Debug, Clone)]
pub struct LatticeBlock {
    octaves: Vec<BlockOctave>,
}

#[derive(Debug, Clone, Copy)]
struct BlockOctave {
    cell: [u32; 3],
    seed: u32,
    /// Of the block's first sample, from that cell's corner.
    first: [f32; 3],
    step_x: [f32; 3],
    step_z: [f32; 3],
}

impl BlockOctave {
    /// One that is not there.
    const NONE: Self = Self { cell: [0; 3], seed: 0, first: [0.0; 3], step_x: [0.0; 3], step_z: [0.0; 3] };
}

impl LatticeBlock {
    /// The block that holds a sample of the terrain.
    #[must_use]
    pub fn around([x, z]: [i32; 2], kernel: &NoiseKernel, frame: &NoiseFrame) -> Self {
        let block = LATTICE_BLOCK.cast_signed();
        let origin = [x - x.rem_euclid(block), z - z.rem_euclid(block)];
        let of_slot = |(slot, own): (usize, &orogeny_field::noise::FrameOctave)| {
            let LatticePoint { cell: [x, y, w], fraction: [fx, fy, fw], .. } =
                kernel.lattice(frame.direction, slot, origin);
            let LatticeStep { x: step_x, z: step_z, .. } = kernel.step(frame.direction, slot);
            let ([own_x, own_y, own_w], [own_fx, own_fy, own_fw]) = (own.cell, own.fraction);
            BlockOctave {
                cell: [x.wrapping_add(own_x), y.wrapping_add(own_y), w.wrapping_add(own_w)],
                seed: own.seed,
                first: [fx + own_fx, fy + own_fy, fw + own_fw],
                step_x,
                step_z,
            }
        };
        Self { octaves: frame.octaves.iter().enumerate().map(of_slot).collect() }
    }
}

/// One row of a block.
struct BlockRow<'a> {
    kernel: &'a NoiseKernel,
    block: &'a LatticeBlock,
    row: f32,
}

impl Places<f32> for BlockRow<'_> {
    /// With the row's first place.
    type Octave = (BlockOctave, [f32; 3]);

    #[inline(always)]
    fn octave(&self, m: u32, l: u32) -> Self::Octave {
        let slot = self.kernel.slots.index(m, l);
        let octave = self.block.octaves.get(slot).copied().unwrap_or(BlockOctave::NONE);
        let [x, z, w] = octave.step_z;
        (octave, [x * self.row, z * self.row, w * self.row])
    }

    #[inline(always)]
    fn origin((octave, _): &Self::Octave) -> ([u32; 3], u32) {
        (octave.cell, octave.seed)
    }

    #[inline(always)]
    fn place((octave, [down_x, down_y, down_w]): &Self::Octave, lane: usize) -> [f32; 3] {
        let ([x, y, w], [step_x, step_y, step_w]) = (octave.first, octave.step_x);
        let lane = lane as f32;
        [x + (lane * step_x + down_x), y + (lane * step_y + down_y), w + (lane * step_w + down_w)]
    }
}

/// Writes a noise, normalised and put through its curve, for all samples of row `row`, 0..32, of a block, as rough as
/// `roughness`, 0..1, says.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn block_row(
    values: &mut [f32; LANES],
    row: u32,
    kernel: &NoiseKernel,
    block: &LatticeBlock,
    roughness: Option<&[f32; LANES]>,
) {
    let (offset, scale) = (kernel.offset as f32, kernel.scale as f32);
    let sums = turbulence::sum(kernel, &BlockRow { kernel, block, row: row as f32 }, roughness);
    for (value, sum) in values.iter_mut().zip(sums) {
        *value = (sum - offset) * scale;
    }
    if let Some(curve) = &kernel.curve {
        for value in values.iter_mut() {
            *value = look_up(curve, *value).0;
        }
    }
}

/// Writes a noise for the samples `first_x ..` of row `z`, both within a terrain, as rough as `roughness` says where it is
/// given: one number a sample.
pub fn row(
    values: &mut [f32],
    first_x: i32,
    z: i32,
    kernel: &NoiseKernel,
    frame: &NoiseFrame,
    roughness: Option<&[f32]>,
) {
    let block_side = LATTICE_BLOCK.cast_signed();
    let (mut whole, mut rough) = ([0.0; LANES], [0.0; LANES]);
    let mut x = first_x;
    let mut rest = values;
    let mut num_done = 0;
    while !rest.is_empty() {
        let within = x.rem_euclid(block_side) as usize;
        let num_samples = rest.len().min(LANES - within);
        let (part, after) = rest.split_at_mut(num_samples);
        let block = LatticeBlock::around([x, z], kernel, frame);
        let known = roughness.and_then(|roughness| roughness.get(num_done..num_done + num_samples));
        if let (Some(known), Some(rough)) = (known, rough.get_mut(within..within + num_samples)) {
            rough.copy_from_slice(known);
        }
        let row = z.rem_euclid(block_side).cast_unsigned();
        block_row(&mut whole, row, kernel, &block, roughness.map(|_| &rough));
        if let Some(whole) = whole.get(within..within + num_samples) {
            part.copy_from_slice(whole);
        }
        rest = after;
        num_done += num_samples;
        x += num_samples as i32;
    }
}

/// Blends two rows of noise, `a + w (b - a)`: the two nearest directions of one that follows the stroke.
pub fn blend(a: &mut [f32], b: &[f32], weight: f32) {
    for (a, b) in a.iter_mut().zip(b) {
        *a = crate::store::lerp(*a, *b, weight);
    }
}
