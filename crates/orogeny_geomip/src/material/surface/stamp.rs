//! Many small things strewn over a canvas: blades, leaves, stones. The highest at a place is what is seen there.

use glam::{Vec2, vec2};
use orogeny_field::hash::{bits_to_uniform, hash};
use rayon::prelude::*;

use super::canvas::Canvas;

/// Rows that are stamped together.
const BAND_ROWS: usize = 16;

/// One thing that lies on the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stamp {
    /// Its middle, in tiles.
    pub place: Vec2,
    /// The way along it: a unit vector.
    pub along: Vec2,
    /// Half its length and half its width, in tiles.
    pub half: Vec2,
    /// What it lies on: added to its height.
    pub base: f32,
    /// Random bits of its own.
    pub id: u32,
}

impl Stamp {
    /// A stamp anywhere on the tile, by its number.
    pub(super) fn strewn(number: u32, seed: u32) -> Self {
        let id = hash(number, 0x51ed, seed);
        let angle = std::f32::consts::TAU * random(id, 2);
        Self {
            place: vec2(random(id, 0), random(id, 1)),
            along: Vec2::from_angle(angle),
            half: vec2(0.01, 0.01),
            base: 0.0,
            id,
        }
    }
}

/// A number of a stamp, 0..1.
#[inline(always)]
pub(super) fn random(id: u32, which: u32) -> f32 {
    bits_to_uniform(hash(id, which, 0x2f0b))
}

/// What lies on top at a texel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    /// Its height; [`f32::MIN`] where nothing lies.
    pub height: f32,
    /// Where on the stamp, -1..1 along and across.
    pub on: Vec2,
    /// The stamp's random bits.
    pub id: u32,
}

impl Hit {
    const NONE: Self = Self { height: f32::MIN, on: Vec2::ZERO, id: 0 };

    /// Whether anything lies there.
    pub(super) fn is_any(&self) -> bool {
        self.height > f32::MIN
    }
}

/// What lies on top at each texel. `height` is that of a stamp at a place on it, -1..1 along and across, or `None` beside it.
pub(super) fn strew(
    canvas: &Canvas,
    stamps: &[Stamp],
    height: impl Fn(&Stamp, Vec2) -> Option<f32> + Sync,
) -> Vec<Hit> {
    let size = canvas.size as usize;
    let mut hits = vec![Hit::NONE; size * size];
    hits.par_chunks_mut(size * BAND_ROWS).enumerate().for_each(|(band, rows)| {
        for stamp in stamps {
            let stamp = Placed::new(stamp, canvas.size as f32);
            if !stamp.touches(band) {
                continue;
            }
            for (row, texels) in rows.chunks_mut(size).enumerate() {
                stamp.draw(band * BAND_ROWS + row, texels, &height);
            }
        }
    });
    hits
}

/// A stamp in texels.
struct Placed<'a> {
    stamp: &'a Stamp,
    size: f32,
    centre: Vec2,
    half: Vec2,
    /// Half the rows that it touches.
    half_rows: f32,
}

impl<'a> Placed<'a> {
    fn new(stamp: &'a Stamp, size: f32) -> Self {
        // Thinner than a texel it would come and go.
        let half = (stamp.half * size).max(Vec2::splat(0.55));
        let half_rows = half.x * stamp.along.y.abs() + half.y * stamp.along.x.abs();
        Self { stamp, size, centre: stamp.place * size - 0.5, half, half_rows }
    }

    /// The rows from `row` to the middle of the stamp, the short way round.
    fn rows_from_centre(&self, row: f32) -> f32 {
        let rows = row - self.centre.y;
        rows - self.size * (rows / self.size).round()
    }

    fn touches(&self, band: usize) -> bool {
        let half_band = 0.5 * BAND_ROWS as f32;
        self.rows_from_centre((band * BAND_ROWS) as f32 + half_band).abs() <= self.half_rows + half_band
    }

    fn draw(&self, row: usize, texels: &mut [Hit], height: impl Fn(&Stamp, Vec2) -> Option<f32>) {
        let dz = self.rows_from_centre(row as f32);
        if dz.abs() > self.half_rows {
            return;
        }
        // Where the row crosses the stamp: |along · d| <= half.x and |across · d| <= half.y, both linear in dx.
        let Vec2 { x: cos, y: sin } = self.stamp.along;
        let (mut from, mut to) = (-0.5 * self.size, 0.5 * self.size);
        for (slope, offset, half) in [(cos, dz * sin, self.half.x), (-sin, dz * cos, self.half.y)] {
            if slope.abs() > 1.0e-4 {
                let (one, other) = ((-half - offset) / slope, (half - offset) / slope);
                from = from.max(one.min(other));
                to = to.min(one.max(other));
            }
        }
        let first = (self.centre.x + from).ceil() as i32;
        let last = (self.centre.x + to).floor() as i32;
        for column in first..=last {
            let dx = column as f32 - self.centre.x;
            let on = vec2(dx * cos + dz * sin, dz * cos - dx * sin) / self.half;
            let Some(own) = height(self.stamp, on) else { continue };
            let texel = texels.get_mut(column.rem_euclid(self.size as i32) as usize);
            if let Some(hit) = texel.filter(|hit| hit.height < own + self.stamp.base) {
                *hit = Hit { height: own + self.stamp.base, on, id: self.stamp.id };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stamp_over_the_corner_shows_in_all_four() {
        let canvas = Canvas { size: 16, seed: 0 };
        let stamp = Stamp { place: Vec2::ZERO, half: vec2(0.2, 0.2), ..Stamp::strewn(0, 0) };
        let round = |_: &Stamp, on: Vec2| (on.length_squared() <= 1.0).then_some(1.0);
        let hits = strew(&canvas, &[stamp], round);
        for index in [0, 15, 240, 255] {
            assert!(hits[index].is_any(), "{index}");
        }
        assert!(!hits[8 * 16 + 8].is_any());
        // As many texels as a disc of that size has, about.
        let count = hits.iter().filter(|hit| hit.is_any()).count() as f32;
        assert!((count - std::f32::consts::PI * 3.2 * 3.2).abs() < 8.0, "{count}");
    }
}
