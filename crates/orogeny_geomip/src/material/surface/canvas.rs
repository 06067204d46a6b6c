//! What a surface is painted on: a square of texels that wraps round, and planes of numbers of the same size.

use glam::{Vec2, Vec3, vec2};
use rayon::prelude::*;

/// One texel as it is painted.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Texel {
    /// The relief's height, in any unit: the whole is brought to 0..1 afterwards.
    pub height: f32,
    /// Albedo, linear light; the whole is brought to the surface's brightness afterwards.
    pub colour: Vec3,
    /// Roughness, 0..1.
    pub roughness: f32,
}

/// A square of `size` texels a side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Canvas {
    /// A power of two.
    pub size: u32,
    /// What makes one texture of a surface differ from another.
    pub seed: u32,
}

impl Canvas {
    /// A seed of the canvas' own for one of its noises.
    pub(super) const fn seed(&self, which: u32) -> u32 {
        self.seed.wrapping_mul(0x85eb_ca6b) ^ which.wrapping_mul(0x9e37_79b9)
    }

    /// Every texel of its place, in tiles.
    pub(super) fn texels<T: Send>(&self, texel: impl Fn(Vec2, usize) -> T + Sync) -> Vec<T> {
        let size = self.size as usize;
        let step = 1.0 / self.size as f32;
        (0..size * size)
            .into_par_iter()
            .with_min_len(size)
            .map(|index| {
                let place = vec2((index % size) as f32 + 0.5, (index / size) as f32 + 0.5) * step;
                texel(place, index)
            })
            .collect()
    }
}

/// Numbers of a canvas, row by row.
#[derive(Debug, Clone)]
pub(super) struct Plane {
    size: usize,
    values: Vec<f32>,
}

impl Plane {
    /// `values` of a canvas of that size.
    pub(super) const fn new(size: u32, values: Vec<f32>) -> Self {
        Self { size: size as usize, values }
    }

    /// Values a side.
    pub(super) const fn size(&self) -> u32 {
        // Made from a `u32`.
        self.size as u32
    }

    pub(super) fn values(&self) -> &[f32] {
        &self.values
    }

    /// The value of a texel; columns and rows go round.
    #[inline(always)]
    pub(super) fn at(&self, x: i32, z: i32) -> f32 {
        let mask = self.size - 1;
        let (x, z) = (x as usize & mask, z as usize & mask);
        self.values.get(z * self.size + x).copied().unwrap_or_default()
    }

    /// Every value changed.
    pub(super) fn map(mut self, change: impl Fn(f32) -> f32 + Sync) -> Self {
        self.values.par_iter_mut().for_each(|value| *value = change(*value));
        self
    }

    /// The mean of all values.
    pub(super) fn mean(&self) -> f32 {
        // By rows, so that the sum of many small numbers keeps its digits.
        let rows = self.values.chunks(self.size.max(1)).map(|row| f64::from(row.iter().sum::<f32>()));
        (rows.sum::<f64>() / self.values.len().max(1) as f64) as f32
    }

    /// Smoothed by two boxes of `radius` texels to each side, which go round.
    pub(super) fn blurred(&self, radius: u32) -> Self {
        let radius = (radius as usize).min(self.size / 2 - usize::from(self.size > 1));
        self.rows_blurred(radius).transposed().rows_blurred(radius).transposed()
    }

    fn rows_blurred(&self, radius: usize) -> Self {
        let size = self.size;
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(size.max(1)).zip(self.values.par_chunks(size.max(1))).for_each(
            |(target, source)| {
                let once = box_blurred(source, radius);
                target.copy_from_slice(&box_blurred(&once, radius));
            },
        );
        Self { size, values }
    }

    fn transposed(&self) -> Self {
        let size = self.size;
        let at = |index: usize| self.values.get(index % size * size + index / size);
        let values = (0..size * size).into_par_iter().with_min_len(size.max(1));
        Self { size, values: values.map(|index| at(index).copied().unwrap_or_default()).collect() }
    }
}

/// The mean of each value and `radius` on either side, round the ends.
fn box_blurred(source: &[f32], radius: usize) -> Vec<f32> {
    let length = source.len();
    let share = 1.0 / (2 * radius + 1) as f32;
    let around = || source.iter().cycle();
    let mut sum: f32 = around().skip(length - radius).take(2 * radius + 1).sum();
    let incoming = around().skip(radius + 1);
    let outgoing = around().skip(length - radius);
    let step = |(incoming, outgoing): (&f32, &f32)| {
        let mean = sum * share;
        sum += incoming - outgoing;
        mean
    };
    incoming.zip(outgoing).map(step).take(length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blur_keeps_the_mean_and_goes_round() {
        let mut values = vec![0.0; 64];
        values[0] = 1.0;
        let blurred = Plane::new(8, values).blurred(1);
        assert!((blurred.mean() - 1.0 / 64.0).abs() < 1.0e-6);
        assert!(blurred.at(-1, -1) > 0.0 && (blurred.at(-1, -1) - blurred.at(1, 1)).abs() < 1.0e-6);
        assert!(blurred.at(3, 0).abs() < 1.0e-6);
    }
}
