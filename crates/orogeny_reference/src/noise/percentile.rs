//! What a raw sum of octaves is scaled by, from percentiles of many of its values.

use orogeny_field::noise::{Noise, NoiseKernel, skewed};

use super::LANES;
use super::turbulence::{self, Places};
use crate::hash::hash;

/// Points that are looked at.
const NUM_POINTS: usize = 65_536;
/// Cells a side of the square over which they are spread.
const EXTENT_CELLS: f64 = 1024.0;
/// Of all points in order, the one at one hundredth and the one at 98.
const FIRST_PERCENTILE: usize = NUM_POINTS / 100;
const LAST_PERCENTILE: usize = NUM_POINTS * 98 / 100;

/// Successive points of the (2, 3) Halton sequence.
struct HaltonPoints<'a> {
    kernel: &'a NoiseKernel,
    seed: u32,
    points: [[f64; 2]; LANES],
}

impl Places<f64> for HaltonPoints<'_> {
    /// Coordinates of each point, and the seed.
    type Octave = ([[f64; 3]; LANES], u32);

    fn octave(&self, m: u32, l: u32) -> Self::Octave {
        let basis = self.kernel.basis;
        let frequency =
            self.kernel.scales.get(self.kernel.slots.index(m, l)).map_or(1.0, |scale| scale.frequency);
        let [origin_x, origin_y, slice] = self.kernel.octave_origin(self.seed, m, l);
        let place =
            |[x, y]: [f64; 2]| skewed(basis, [frequency * x + origin_x, frequency * y + origin_y, slice]);
        (self.points.map(place), hash(l, m, self.seed))
    }

    fn origin((_, seed): &Self::Octave) -> ([u32; 3], u32) {
        ([0; 3], *seed)
    }

    fn place((places, _): &Self::Octave, lane: usize) -> [f64; 3] {
        places.get(lane).copied().unwrap_or_default()
    }
}

/// Offset and scale that make `(sum - offset) * scale` reach from about 0 (of the turbulences about 0: -1) to 1: the offset is
/// the 1st percentile (of those about 0: 0), and the scale makes the 98th 1. A noise that is the same everywhere keeps scale 1.
#[must_use]
pub fn normalization(noise: &Noise) -> (f64, f64) {
    let kernel = NoiseKernel::in_feature_sizes(noise);
    let mut values = Vec::with_capacity(NUM_POINTS);
    for first in (1..=NUM_POINTS).step_by(LANES) {
        let points = std::array::from_fn(|lane| {
            let index = first + lane;
            [EXTENT_CELLS * radical_inverse(index, 2), EXTENT_CELLS * radical_inverse(index, 3)]
        });
        values.extend(turbulence::sum(
            &kernel,
            &HaltonPoints { kernel: &kernel, seed: noise.seed, points },
            None,
        ));
    }
    values.sort_unstable_by(f64::total_cmp);
    let percentile = |index: usize| values.get(index).copied().unwrap_or_default();
    let offset = if noise.turbulence.is_signed() { 0.0 } else { percentile(FIRST_PERCENTILE) };
    let extent = percentile(LAST_PERCENTILE) - offset;
    if extent > 0.0 && extent.is_finite() { (offset, 1.0 / extent) } else { (offset, 1.0) }
}

/// The digits of `index` in a base, mirrored at the point.
fn radical_inverse(mut index: usize, base: usize) -> f64 {
    let step = 1.0 / base as f64;
    let (mut sum, mut place) = (0.0, step);
    while index > 0 {
        sum += (index % base) as f64 * place;
        index /= base;
        place *= step;
    }
    sum
}
