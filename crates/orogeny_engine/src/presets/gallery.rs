//! All presets at a glance: their thumbnails in a grid, each with its name below.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::Presets;
use crate::picture::MAX_SIDE_PX;
use crate::progress::report;
use crate::{Error, Observer, Picture, Result, relief};

const WEIGHT: FontWeight = FontWeight::Regular;
const TEXT_HEIGHT: RasterHeight = RasterHeight::Size16;
/// Pixels from one line of text to the next, and below the last.
const LINE_PX: u32 = 17;
const BELOW_TEXT_PX: u32 = 7;
/// Lines that a name may take.
const MAX_LINES: usize = 2;
/// What names are written in (sRGB).
const INK: [u8; 3] = [70, 66, 60];
/// The narrowest cell, in pixels: names must have room in it.
const MIN_CELL_PX: u32 = 64;

/// All presets at a glance.
#[derive(Debug)]
pub struct Gallery {
    /// What was drawn.
    pub picture: Picture,
    /// Presets that could not be drawn, and why: their names stand there alone.
    pub notices: Vec<String>,
}

impl Presets {
    /// Draws all presets in a grid of cells of `cell_px` pixels, in the order of their names.
    ///
    /// # Errors
    /// [`Error::PictureSize`] when a cell is too small for a name or the picture too large; [`Error::Cancelled`].
    pub fn draw_gallery(&self, cell_px: u32, observer: &mut dyn Observer) -> Result<Gallery> {
        let num_presets = self.known.len() as u32;
        let num_columns = columns_for(num_presets);
        let num_rows = num_presets.div_ceil(num_columns);
        let letters_a_line = cell_px as usize / get_raster_width(WEIGHT, TEXT_HEIGHT);
        if !(MIN_CELL_PX..=MAX_SIDE_PX).contains(&cell_px) {
            return Err(Error::PictureSize { width: cell_px, height: cell_px, limit: MAX_SIDE_PX });
        }
        let names = self.iter().map(|known| lines_of(&known.preset.name, letters_a_line));
        let names: Vec<_> = names.collect();
        let num_lines = names.iter().map(Vec::len).max().unwrap_or_default() as u32;
        let picture_px = cell_px * 3 / 4;
        let row_px = picture_px + num_lines * LINE_PX + BELOW_TEXT_PX;
        let mut notices = Vec::new();
        let mut picture = Picture::new(num_columns * cell_px, num_rows * row_px, relief::BACKGROUND)?;
        for (index, (known, lines)) in (0..).zip(self.iter().zip(names)) {
            let (left, top) = (index % num_columns * cell_px, index / num_columns * row_px);
            match known.preset.draw_thumbnail(cell_px) {
                Ok(thumbnail) => picture.paste(&thumbnail, left, top),
                Err(err) => {
                    notices.push(format!("the preset `{}` could not be drawn: {err}", known.preset.name))
                }
            }
            for (line, text) in (0..).zip(lines) {
                write(&mut picture, &text, left + cell_px / 2, top + picture_px + line * LINE_PX);
            }
            report(observer, "drawing", u64::from(index) + 1, num_presets.into())?;
        }
        Ok(Gallery { picture, notices })
    }
}

/// Columns of a grid that is about as wide as high.
fn columns_for(num_cells: u32) -> u32 {
    let side = num_cells.isqrt();
    if side * side < num_cells { side + 1 } else { side.max(1) }
}

/// A name cut between words into lines; what has no room ends in `..`.
fn lines_of(name: &str, letters_a_line: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in name.split_whitespace() {
        let fits = |line: &String| line.chars().count() + 1 + word.chars().count() <= letters_a_line;
        let is_full = lines.len() == MAX_LINES;
        match lines.last_mut() {
            Some(line) if fits(line) || is_full => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    for line in &mut lines {
        if line.chars().count() > letters_a_line {
            *line = line.chars().take(letters_a_line.saturating_sub(2)).chain("..".chars()).collect();
        }
    }
    lines
}

/// Writes a line of text around `centre`.
fn write(picture: &mut Picture, text: &str, centre: u32, top: u32) {
    let width = text.chars().count() * get_raster_width(WEIGHT, TEXT_HEIGHT);
    let mut left = centre.saturating_sub(width as u32 / 2);
    for letter in text.chars() {
        let glyph = get_raster(letter, WEIGHT, TEXT_HEIGHT).or_else(|| get_raster('?', WEIGHT, TEXT_HEIGHT));
        let Some(glyph) = glyph else { continue };
        for (y, row) in (top..).zip(glyph.rows()) {
            for (x, cover) in (left..).zip(row) {
                for (channel, ink) in picture.pixel_mut(x, y).into_iter().flatten().zip(INK) {
                    let (from, to) = (i32::from(*channel), i32::from(ink));
                    *channel = (from + (to - from) * i32::from(*cover) / 255) as u8;
                }
            }
        }
        left += glyph.width() as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_cut_between_words_and_at_the_end() {
        assert_eq!(lines_of("Soft hill", 12), ["Soft hill"]);
        assert_eq!(lines_of("Soft rolling hills", 12), ["Soft rolling", "hills"]);
        assert_eq!(lines_of("Soft rolling hills of old", 12), ["Soft rolling", "hills of old"]);
        assert_eq!(lines_of("Soft rolling hills of yore", 12), ["Soft rolling", "hills of y.."]);
        assert_eq!(lines_of("Incomprehensible", 12), ["Incomprehe.."]);
    }

    #[test]
    fn a_grid_is_about_as_wide_as_high() {
        assert_eq!([0, 1, 2, 4, 5, 6, 36, 37].map(columns_for), [1, 1, 2, 2, 3, 3, 6, 7]);
    }

    #[test]
    fn text_is_dark_and_stays_within_the_picture() {
        let mut picture = Picture::new(40, 16, [255; 3]).unwrap();
        write(&mut picture, "Wide names ß 山", 20, 0);
        assert!(picture.rgb.iter().any(|channel| *channel < 100));
    }
}
