//! Noise that repeats: lattices whose coordinates wrap round, so that a tile's last column goes on into its first.
//!
//! Places `u`, `v` are in tiles: 0..1 is one tile, and any place beyond it is that place in the next one.

use glam::{Vec2, Vec4, vec2, vec4};
use orogeny_field::hash::{bits_to_uniform, hash};

/// So that values mostly keep within ±1: found by trial.
const GRADIENT_SCALE: f32 = 2.3;
/// How wide a cell's rim is in which no point of cellular noise lies, in cells.
const RIM: f32 = 0.05;

/// The whole number below; the standard one is a call where the processor's baseline lacks the instruction.
#[inline(always)]
fn floor(value: f32) -> i32 {
    let whole = value as i32;
    whole - i32::from(value < whole as f32)
}

/// A place's cell on a lattice of `period` cells a tile, and where in the cell it is. Places are within a few tiles.
#[inline(always)]
fn cell(place: f32, period: u32) -> (u32, f32) {
    let scaled = (place - floor(place) as f32) * period as f32;
    // A place just below 0 is rounded to 1.
    let cell = (scaled as i32 as u32).min(period - 1);
    (cell, scaled - cell as f32)
}

/// The cell after one; after the last comes the first.
#[inline(always)]
const fn after(cell: u32, period: u32) -> u32 {
    if cell + 1 == period { 0 } else { cell + 1 }
}

/// The cell before one; before the first comes the last.
#[inline(always)]
const fn before(cell: u32, period: u32) -> u32 {
    if cell == 0 { period - 1 } else { cell - 1 }
}

#[inline(always)]
fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// Half of a lattice point's bits, of its column or its row. The other half is added to it: four points of a cell share two of each.
#[inline(always)]
const fn half_bits(cell: u32, factor: u32) -> u32 {
    (cell + 1).wrapping_mul(factor)
}

/// Random gradients of four lattice points, by their bits: ±32768 along u and v.
///
/// A texel asks for some two hundred of them: [`hash`] with its six products would be most of the work. One xor-multiply round
/// (after MurmurHash3's finaliser) does, where the sum of many is looked at.
#[inline(always)]
fn gradients(bits: [u32; 4]) -> (Vec4, Vec4) {
    let bits = bits.map(|bits| (bits ^ (bits >> 15)).wrapping_mul(0x2c1b_3c6d));
    let bits = bits.map(|bits| bits ^ (bits >> 16));
    // The shifts keep the sign.
    let x = bits.map(|bits| ((bits as i32) << 16 >> 16) as f32);
    let y = bits.map(|bits| (bits as i32 >> 16) as f32);
    (Vec4::from_array(x), Vec4::from_array(y))
}

/// Gradient noise (Perlin, "Improving Noise", 2002) of `periods` cells a tile along u and v: about -1..1.
#[inline]
pub(super) fn gradient_noise(place: Vec2, periods: [u32; 2], seed: u32) -> f32 {
    let [across, down] = periods;
    let (x, fx) = cell(place.x, across);
    let (y, fy) = cell(place.y, down);
    let seed = seed.wrapping_mul(0x9e37_79b1) ^ (seed >> 16);
    let (x0, x1) = (half_bits(x, 0x85eb_ca6b), half_bits(after(x, across), 0x85eb_ca6b));
    let (y0, y1) = (half_bits(y, 0xc2b2_ae35) ^ seed, half_bits(after(y, down), 0xc2b2_ae35) ^ seed);
    let (tx, ty) = (fade(fx), fade(fy));
    // The four corners side by side: left and right above, left and right below.
    let (gradient_x, gradient_y) = gradients([x0 ^ y0, x1 ^ y0, x0 ^ y1, x1 ^ y1]);
    let products =
        gradient_x * vec4(fx, fx - 1.0, fx, fx - 1.0) + gradient_y * vec4(fy, fy, fy - 1.0, fy - 1.0);
    let [top_left, top_right, bottom_left, bottom_right] = products.to_array();
    let top = top_left + tx * (top_right - top_left);
    let bottom = bottom_left + tx * (bottom_right - bottom_left);
    (GRADIENT_SCALE / 32768.0) * (top + ty * (bottom - top))
}

/// Octaves of something, each of twice the frequency and half the height of the one before, with the weights' sum 1. It is told
/// whether it is an odd one.
fn octaves(periods: [u32; 2], count: u32, seed: u32, value: impl Fn([u32; 2], u32, bool) -> f32) -> f32 {
    let [across, down] = periods;
    let (mut sum, mut weights, mut weight) = (0.0, 0.0, 1.0);
    for octave in 0..count {
        sum += weight
            * value([across << octave, down << octave], seed.wrapping_add(octave * 0x9e37), octave % 2 == 1);
        weights += weight;
        weight *= 0.5;
    }
    sum / weights
}

/// Fractal noise, about -1..1: `periods` cells a tile in the first octave.
pub(super) fn fbm_stretched(place: Vec2, periods: [u32; 2], count: u32, seed: u32) -> f32 {
    1.3 * octaves(periods, count, seed, |periods, seed, _| gradient_noise(place, periods, seed))
}

/// [`fbm_stretched`] that is alike along u and v. Every second octave's lattice is turned, so that none shows.
pub(super) fn fbm(place: Vec2, period: u32, count: u32, seed: u32) -> f32 {
    // By whole numbers, so that it still repeats: by 27 degrees, and smaller by the root of 5.
    let turned = vec2(2.0 * place.x + place.y, 2.0 * place.y - place.x);
    let noise = |[period, _]: [u32; 2], seed, is_turned| {
        if is_turned {
            let period = (period as f32 * 0.447 + 0.5) as u32;
            gradient_noise(turned, [period.max(1); 2], seed)
        } else {
            gradient_noise(place, [period; 2], seed)
        }
    };
    1.3 * octaves([period; 2], count, seed, noise)
}

/// Fractal noise with sharp ridges, 0..1: 1 on a ridge.
pub(super) fn ridges(place: Vec2, period: u32, count: u32, seed: u32) -> f32 {
    let ridge = |periods, seed, _| {
        let value = 1.0 - gradient_noise(place, periods, seed).abs();
        value.max(0.0) * value.max(0.0)
    };
    octaves([period; 2], count, seed, ridge)
}

/// A place led astray by noise, by about `amount` tiles at most.
pub(super) fn warped(place: Vec2, period: u32, count: u32, amount: f32, seed: u32) -> Vec2 {
    let shift = vec2(fbm(place, period, count, seed), fbm(place, period, count, seed ^ 0x5bd1_e995));
    place + amount * shift
}

/// What cellular noise knows of a place (Worley, "A Cellular Texture Basis Function", 1996).
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells {
    /// The distance to the nearest point, in cells.
    pub nearest: f32,
    /// To the second nearest.
    pub second: f32,
    /// Random bits of the nearest point.
    pub id: u32,
}

impl Cells {
    /// The way to the border between the two nearest points, in cells; about 0..0.6.
    pub(super) fn border(&self) -> f32 {
        0.5 * (self.second - self.nearest)
    }

    /// A number of the cell, 0..1, by a seed.
    pub(super) fn random(&self, seed: u32) -> f32 {
        bits_to_uniform(hash(self.id, seed, 17))
    }
}

/// Cellular noise of one point a cell, which lies anywhere in it but at its rim: two that nearly fall together would have a wide border.
pub(super) fn cells(place: Vec2, periods: [u32; 2], seed: u32) -> Cells {
    let [across, down] = periods;
    let (x, fx) = cell(place.x, across);
    let (y, fy) = cell(place.y, down);
    let (mut nearest, mut second, mut id) = (f32::MAX, f32::MAX, 0);
    let columns = [(before(x, across), -1.0 - fx), (x, -fx), (after(x, across), 1.0 - fx)];
    for (row, dy) in [(before(y, down), -1.0 - fy), (y, -fy), (after(y, down), 1.0 - fy)] {
        for (column, dx) in columns {
            let bits = hash(column, row, seed);
            let point_x = dx + RIM + (bits & 0xffff) as f32 * ((1.0 - 2.0 * RIM) / 65536.0);
            let point_y = dy + RIM + (bits >> 16) as f32 * ((1.0 - 2.0 * RIM) / 65536.0);
            let squared = point_x * point_x + point_y * point_y;
            if squared < nearest {
                (second, nearest, id) = (nearest, squared, bits);
            } else if squared < second {
                second = squared;
            }
        }
    }
    Cells { nearest: nearest.sqrt(), second: second.sqrt(), id }
}

/// 0 below `from`, 1 above `to`, smooth between.
#[inline(always)]
pub(super) fn smooth(from: f32, to: f32, value: f32) -> f32 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_goes_on_into_the_next_tile() {
        for step in 0..64 {
            // Binary fractions, so that a tile further is exactly that.
            let place = vec2(step as f32 / 64.0 + 1.0 / 512.0, ((step * 37) % 64) as f32 / 64.0);
            for next in [place + Vec2::X, place + Vec2::Y, place - Vec2::ONE] {
                assert_eq!(fbm(place, 5, 4, 3), fbm(next, 5, 4, 3));
                assert_eq!(ridges(place, 3, 3, 3), ridges(next, 3, 3, 3));
                assert_eq!(cells(place, [7, 9], 3).id, cells(next, [7, 9], 3).id);
            }
        }
    }

    #[test]
    fn noise_fills_its_range_and_keeps_to_it() {
        let values: Vec<f32> = (0..4096)
            .map(|index| fbm(vec2((index % 64) as f32 / 64.0, (index / 64) as f32 / 64.0), 7, 4, 1))
            .collect();
        let mean = values.iter().sum::<f32>() / 4096.0;
        let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f32>() / 4096.0).sqrt();
        assert!(mean.abs() < 0.05, "{mean}");
        assert!((0.2..0.5).contains(&deviation), "{deviation}");
        assert!(values.iter().all(|value| value.abs() < 1.5));
    }
}
