//! Pictures of 24-bit colour: ramps of colours, PNG in memory and as a file.

use std::path::Path;

use crate::palette::Indexed;
use crate::{Error, Result, whole_file};

/// The longest side of a picture, in pixels.
pub(crate) const MAX_SIDE_PX: u32 = 8192;

/// Whether a picture may have so many pixels along x and y.
///
/// # Errors
/// [`Error::PictureSize`].
pub(crate) fn check_size([width, height]: [u32; 2]) -> Result<()> {
    let is_side = |side: u32| (1..=MAX_SIDE_PX).contains(&side);
    if is_side(width) && is_side(height) {
        Ok(())
    } else {
        Err(Error::PictureSize { width, height, limit: MAX_SIDE_PX })
    }
}

/// Colours (sRGB, 0..255) at places from 0 to 1, in order.
pub(crate) type Ramp<const N: usize> = [(f32, [f32; 3]); N];

/// The colour at `t`, between its neighbours; beyond the ends the last one.
pub(crate) fn colour_at<const N: usize>(ramp: &Ramp<N>, t: f32) -> [f32; 3] {
    let mut colour = ramp.first().map(|(_, first)| *first).unwrap_or_default();
    for pair in ramp.windows(2) {
        if let [(start, from), (end, to)] = pair
            && t >= *start
        {
            let share = ((t - start) / (end - start)).min(1.0);
            for (channel, (from, to)) in colour.iter_mut().zip(from.iter().zip(to)) {
                *channel = from + share * (to - from);
            }
        }
    }
    colour
}

/// A picture in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels along x.
    pub width_px: u32,
    /// Pixels along y.
    pub height_px: u32,
    /// Red, green and blue of each pixel, row by row from the top.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// A picture of one colour.
    ///
    /// # Errors
    /// [`Error::PictureSize`].
    pub(crate) fn new(width_px: u32, height_px: u32, colour: [u8; 3]) -> Result<Self> {
        check_size([width_px, height_px])?;
        let rgb = colour.repeat(width_px as usize * height_px as usize);
        Ok(Self { width_px, height_px, rgb })
    }

    /// A pixel, if it lies within.
    pub(crate) fn pixel_mut(&mut self, x: u32, y: u32) -> Option<&mut [u8]> {
        if x >= self.width_px {
            return None;
        }
        let start = 3 * (y as usize * self.width_px as usize + x as usize);
        self.rgb.get_mut(start..start + 3)
    }

    /// Copies another picture into this one; what does not fit is left out.
    pub(crate) fn paste(&mut self, other: &Self, left: u32, top: u32) {
        let num_pixels = other.width_px.min(self.width_px.saturating_sub(left)) as usize;
        for (y, row) in (top..self.height_px).zip(other.rgb.chunks_exact(3 * other.width_px as usize)) {
            let start = 3 * (y as usize * self.width_px as usize + left as usize);
            if let (Some(to), Some(from)) =
                (self.rgb.get_mut(start..start + 3 * num_pixels), row.get(..3 * num_pixels))
            {
                to.copy_from_slice(from);
            }
        }
    }

    /// As a PNG.
    ///
    /// # Errors
    /// [`Error::Png`] should the encoder refuse it.
    pub fn to_png(&self) -> Result<Vec<u8>> {
        encoded(self.width_px, self.height_px, png::ColorType::Rgb, None, &self.rgb)
    }

    /// As a PNG of few colours, which is much smaller.
    ///
    /// # Errors
    /// [`Error::Png`] should the encoder refuse it.
    pub fn to_small_png(&self) -> Result<Vec<u8>> {
        let Indexed { palette, indices } = Indexed::of(&self.rgb);
        encoded(self.width_px, self.height_px, png::ColorType::Indexed, Some(palette), &indices)
    }

    /// Writes it as a PNG, which appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Png`], [`Error::Write`].
    pub fn write(&self, path: &Path) -> Result<()> {
        whole_file::write(path, &self.to_png()?)
    }

    /// As [`Self::write`], of few colours.
    ///
    /// # Errors
    /// [`Error::Png`], [`Error::Write`].
    pub fn write_small(&self, path: &Path) -> Result<()> {
        whole_file::write(path, &self.to_small_png()?)
    }
}

fn encoded(
    width_px: u32,
    height_px: u32,
    colour: png::ColorType,
    palette: Option<Vec<u8>>,
    data: &[u8],
) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width_px, height_px);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    if let Some(palette) = palette {
        encoder.set_palette(palette);
        // Neighbouring indices say nothing about each other's colours.
        encoder.set_filter(png::Filter::NoFilter);
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_run_from_the_first_to_the_last() {
        let ramp = [(0.0, [0.0; 3]), (0.5, [10.0; 3]), (1.0, [30.0; 3])];
        for (t, channel) in
            [(-1.0, 0.0), (0.0, 0.0), (0.25, 5.0), (0.5, 10.0), (0.75, 20.0), (1.0, 30.0), (2.0, 30.0)]
        {
            assert_eq!(colour_at(&ramp, t), [channel; 3], "{t}");
        }
    }

    #[test]
    fn a_pasted_picture_is_cut_at_the_edges() {
        let mut picture = Picture::new(3, 2, [0; 3]).unwrap();
        picture.paste(&Picture::new(2, 5, [9; 3]).unwrap(), 2, 1);
        let lit: Vec<_> = picture.rgb.chunks(3).map(|pixel| pixel == [9; 3]).collect();
        assert_eq!(lit, [false, false, false, false, false, true]);
        assert!(picture.pixel_mut(3, 0).is_none() && picture.pixel_mut(0, 2).is_none());
    }

    #[test]
    fn a_picture_of_no_pixels_or_of_too_many_is_refused() {
        for (width, height) in [(0, 5), (5, 0), (MAX_SIDE_PX + 1, 5)] {
            assert!(matches!(Picture::new(width, height, [0; 3]), Err(Error::PictureSize { .. })));
        }
    }
}
