//! A relief: the ground as a block, seen from the south and above, drawn in software.
//!
//! The picture plane stands upright, as in a camera with a shifted lens, so that what is above each other stays so. Then each
//! column of pixels sees one line over the ground, which is walked from front to back; what rises above all before it is
//! drawn. Light is worked out once for every sample, before.

mod light;

use self::light::{linear, lit_colours, srgb};
use crate::Result;
use crate::ground::Ground;
use crate::picture::Picture;

/// How far above the horizon the eye stands.
const ELEVATION_DEGREES: f32 = 35.0;
/// From the eye to the middle of the block, in widths of it: far enough that its edges hardly run together.
const DISTANCE: f32 = 4.2;
/// Pixels are made of this many rays each way.
const RAYS: u32 = 2;
/// Free room at the sides and above, and below, as a share of the picture.
const MARGIN: f32 = 0.035;
const MARGIN_BELOW: f32 = 0.07;
/// How thick the block is below its lowest ground, in widths of it.
const THICKNESS: f32 = 0.035;
/// Steps over the ground, a sample.
const STEPS_A_SAMPLE: f32 = 2.0;

/// Behind the block (sRGB).
pub(crate) const BACKGROUND: [u8; 3] = [245, 244, 241];
/// The cut through the ground in front, at its top and at its bottom (sRGB).
const CUT_TOP: [f32; 3] = [150.0, 138.0, 124.0];
const CUT_BOTTOM: [f32; 3] = [112.0, 103.0, 94.0];
/// The shadow under the block: how dark, and how far down, as a share of the picture.
const SHADOW: f32 = 0.16;
const SHADOW_DEPTH: f32 = 0.035;

/// How a relief is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Relief {
    /// The picture, in pixels.
    pub(crate) size_px: [u32; 2],
    /// What heights are multiplied by.
    pub(crate) exaggeration: f32,
    /// Heights of the first and the last tint, in metres, before that.
    pub(crate) tint_range_m: [f32; 2],
}

/// A picture of linear light, several rays a pixel, and how the ground lies in it.
struct Canvas<'a> {
    ground: &'a Ground,
    colours: &'a [[f32; 3]],
    width: usize,
    height: usize,
    rays: Vec<[f32; 3]>,
    view: View,
}

/// Places on the ground → rays. Everything is in samples.
struct View {
    /// Distance of the southern edge from the eye, and the eye's height above the block's foot.
    near: f32,
    eye_height: f32,
    /// Rays a unit of the picture plane, along x and along y.
    scale: [f32; 2],
    /// The ray that the eye looks along.
    centre: [f32; 2],
}

impl View {
    /// How far down something at a height and distance is seen.
    fn row(&self, height: f32, distance: f32) -> f32 {
        self.centre[1] + self.scale[1] * (self.eye_height - height) / distance
    }
}

/// Draws the ground.
///
/// # Errors
/// [`crate::Error::PictureSize`].
pub(crate) fn draw(ground: &Ground, relief: &Relief) -> Result<Picture> {
    let [width_px, height_px] = relief.size_px;
    let mut picture = Picture::new(width_px, height_px, BACKGROUND)?;
    // Heights in samples, as drawn, above the foot of the block.
    let measure = relief.exaggeration / ground.spacing_m;
    let lowest_m = ground.range_m()[0];
    let foot = THICKNESS * ground.width as f32;
    let drawn = Ground {
        width: ground.width,
        heights: ground.heights.iter().map(|height_m| foot + (height_m - lowest_m) * measure).collect(),
        spacing_m: 1.0,
    };
    let colours = lit_colours(&drawn, relief.tint_range_m.map(|tint_m| foot + (tint_m - lowest_m) * measure));
    let (width, height) = ((width_px * RAYS) as usize, (height_px * RAYS) as usize);
    let view = framed(&drawn, [width as f32, height as f32]);
    let rays = vec![BACKGROUND.map(|channel| linear(f32::from(channel))); width * height];
    let mut canvas = Canvas { ground: &drawn, colours: &colours, width, height, rays, view };
    for column in 0..width {
        canvas.draw_column(column);
    }
    canvas.develop(&mut picture);
    Ok(picture)
}

/// The view in which the block fills the picture's width, or its height if that is less, and stands at its lower edge: so
/// pictures beside each other stand on one line.
fn framed(ground: &Ground, [width, height]: [f32; 2]) -> View {
    let (elevation, side) = (ELEVATION_DEGREES.to_radians(), ground.width as f32);
    let depth = ground.depth() as f32;
    let middle = DISTANCE * side.max(depth);
    let near = middle - 0.5 * depth;
    let eye_height = middle * elevation.tan();
    // Upright, the plane stretches what is seen from above: this takes it back.
    let squeeze = elevation.cos();
    let scale = width * (1.0 - 2.0 * MARGIN) * near / side;
    let mut view = View { near, eye_height, scale: [scale, scale * squeeze], centre: [0.5 * width, 0.0] };
    let (mut top, bottom) = (f32::INFINITY, view.row(0.0, near));
    for (z, row) in ground.heights.chunks_exact(ground.width).enumerate() {
        let distance = near + depth - 1.0 - z as f32;
        let highest = row.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        top = top.min(view.row(highest, distance));
    }
    let shrink = (height * (1.0 - MARGIN - MARGIN_BELOW) / (bottom - top)).min(1.0);
    view.scale = view.scale.map(|scale| scale * shrink);
    view.centre[1] = height * (1.0 - MARGIN_BELOW) - shrink * bottom;
    view
}

impl Canvas<'_> {
    /// Walks over the ground behind one column of rays.
    fn draw_column(&mut self, column: usize) {
        let (last_x, last_z) = ((self.ground.width - 1) as f32, (self.ground.depth() - 1) as f32);
        let across = (column as f32 + 0.5 - self.view.centre[0]) / self.view.scale[0];
        let num_steps = (last_z * STEPS_A_SAMPLE) as usize;
        // Everything from this row down is drawn.
        let mut covered = self.height;
        let mut before: Option<(f32, [f32; 3])> = None;
        for step in 0..=num_steps {
            let run = step as f32 / STEPS_A_SAMPLE;
            let distance = self.view.near + run;
            let place = [0.5 * last_x + across * distance, last_z - run];
            if !(0.0..=last_x).contains(&place[0]) {
                break;
            }
            let height = self.ground.between(place);
            let row = self.view.row(height, distance);
            let colour = self.colour_between(place);
            let (row_before, colour_before) = match before {
                Some(before) => before,
                None => {
                    covered = self.draw_cut(column, row);
                    (row, colour)
                }
            };
            let first = row.ceil().clamp(0.0, self.height as f32) as usize;
            for y in (first..covered).rev() {
                let share = ((row_before - y as f32) / (row_before - row).max(1.0e-6)).clamp(0.0, 1.0);
                let mut mixed = colour;
                for (channel, from) in mixed.iter_mut().zip(colour_before) {
                    *channel = from + share * (*channel - from);
                }
                self.put(column, y, mixed);
            }
            covered = covered.min(first);
            before = Some((row, colour));
        }
    }

    /// The cut through the ground in front, below `top`; the first row of it.
    fn draw_cut(&mut self, column: usize, top: f32) -> usize {
        let bottom = self.view.row(0.0, self.view.near);
        let rows = [top, bottom].map(|row| row.ceil().clamp(0.0, self.height as f32) as usize);
        for y in rows[0]..rows[1] {
            let share = ((y as f32 - top) / (bottom - top).max(1.0)).clamp(0.0, 1.0);
            let mut colour = [0.0; 3];
            for (channel, (upper, lower)) in colour.iter_mut().zip(CUT_TOP.iter().zip(CUT_BOTTOM)) {
                *channel = linear(upper + share * (lower - upper));
            }
            self.put(column, y, colour);
        }
        let depth = SHADOW_DEPTH * self.height as f32;
        for y in rows[1]..(rows[1] + depth as usize).min(self.height) {
            let fade = 1.0 - (y as f32 - bottom) / depth;
            let darkness = SHADOW * fade * fade;
            self.put(column, y, BACKGROUND.map(|channel| (1.0 - darkness) * linear(f32::from(channel))));
        }
        rows[0]
    }

    fn put(&mut self, column: usize, row: usize, colour: [f32; 3]) {
        if let Some(ray) = self.rays.get_mut(row * self.width + column) {
            *ray = colour;
        }
    }

    /// The colour at a place between samples.
    fn colour_between(&self, [x, z]: [f32; 2]) -> [f32; 3] {
        let width = self.ground.width;
        let (column, row) = (x as usize, z as usize);
        let (right, down) = (x - column as f32, z - row as f32);
        let (next_column, next_row) = ((column + 1).min(width - 1), (row + 1).min(self.ground.depth() - 1));
        let corners = [
            (column, row, (1.0 - right) * (1.0 - down)),
            (next_column, row, right * (1.0 - down)),
            (column, next_row, (1.0 - right) * down),
            (next_column, next_row, right * down),
        ];
        let mut mixed = [0.0; 3];
        for (column, row, share) in corners {
            let colour = self.colours.get(row * width + column).copied().unwrap_or_default();
            for (channel, value) in mixed.iter_mut().zip(colour) {
                *channel += share * value;
            }
        }
        mixed
    }

    /// Rays → pixels.
    fn develop(&self, picture: &mut Picture) {
        let num_rays = (RAYS * RAYS) as f32;
        for y in 0..picture.height_px {
            for x in 0..picture.width_px {
                let mut sum = [0.0; 3];
                for (dy, dx) in (0..RAYS).flat_map(|dy| (0..RAYS).map(move |dx| (dy, dx))) {
                    let index = (y * RAYS + dy) as usize * self.width + (x * RAYS + dx) as usize;
                    for (channel, value) in
                        sum.iter_mut().zip(self.rays.get(index).copied().unwrap_or_default())
                    {
                        *channel += value / num_rays;
                    }
                }
                if let Some(pixel) = picture.pixel_mut(x, y) {
                    pixel.copy_from_slice(&sum.map(srgb));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE_PX: [u32; 2] = [80, 60];

    fn drawn(height: impl Fn(f32, f32) -> f32) -> Picture {
        let heights = (0..64 * 64).map(|k| height((k % 64) as f32, (k / 64) as f32)).collect();
        let ground = Ground { width: 64, heights, spacing_m: 1.0 };
        draw(&ground, &Relief { size_px: SIZE_PX, exaggeration: 1.0, tint_range_m: [-20.0, 20.0] }).unwrap()
    }

    /// Rows of a column that show something, from the first to the last.
    fn rows(picture: &Picture, x: u32) -> Vec<u32> {
        let is_drawn = |y: &u32| picture.rgb[3 * (y * picture.width_px + x) as usize..][..3] != BACKGROUND;
        (0..picture.height_px).filter(is_drawn).collect()
    }

    #[test]
    fn a_plain_is_a_block_with_nothing_beside_it() {
        let picture = drawn(|_, _| 0.0);
        assert!(rows(&picture, 0).is_empty() && rows(&picture, 79).is_empty());
        let middle = rows(&picture, 40);
        assert!(middle.len() > 25 && middle.windows(2).all(|pair| pair[1] == pair[0] + 1), "{middle:?}");
        // The far edge is narrower, and the picture as wide on both sides.
        assert!(rows(&picture, 4).len() < middle.len());
        assert_eq!(rows(&picture, 10).len(), rows(&picture, 69).len());
    }

    #[test]
    fn what_is_high_stands_out_above_and_blocks_stand_on_one_line() {
        let (plain, peak) = (drawn(|_, _| 0.0), drawn(|x, z| 25.0 - (x - 32.0).hypot(z - 32.0).min(25.0)));
        let (plain, peak) = (rows(&plain, 40), rows(&peak, 40));
        assert!(peak[0] + 2 < plain[0], "{peak:?} {plain:?}");
        assert_eq!(peak.last(), plain.last());
    }

    #[test]
    fn what_is_very_high_is_drawn_smaller_not_cut() {
        let picture = drawn(|x, z| 300.0 - 10.0 * (x - 32.0).hypot(z - 32.0).min(30.0));
        assert!(rows(&picture, 40)[0] > 0);
    }
}
