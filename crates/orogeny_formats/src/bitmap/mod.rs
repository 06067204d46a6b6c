//! Alpha bitmaps for brushes: the values of a PNG or an OpenEXR picture that is in memory.

mod exr;
mod png;

use std::path::PathBuf;

use crate::error::{Error, Result};
use crate::format::Format;
use crate::place::Place;

/// The longest side of a bitmap.
pub const MAX_BITMAP_SIDE: u32 = 4096;

/// How much red, green and blue add to luminance (Rec. 709).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// One value for each pixel of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Bitmap {
    width: u32,
    height: u32,
    values: Vec<f32>,
}

impl Bitmap {
    /// A bitmap of these values, row after row, the top row first.
    ///
    /// # Errors
    ///
    /// [`Error::Bitmap`] when a side is not 1 to [`MAX_BITMAP_SIDE`], when the values are not as many as the sides
    /// make, and when one is not finite.
    pub fn new(width: u32, height: u32, values: Vec<f32>) -> Result<Self> {
        let refuse = |reason: String| Err(Error::Bitmap { width, height, reason });
        let sides = 1..=MAX_BITMAP_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return refuse(format!("each side takes 1 to {MAX_BITMAP_SIDE}"));
        }
        if values.len() as u64 != u64::from(width) * u64::from(height) {
            return refuse(format!("it has {} values", values.len()));
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return refuse(format!("value {index} is not finite"));
        }
        Ok(Self { width, height, values })
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The values, row after row, the top row first.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The values, row after row, the top row first, for another kind of picture.
    pub fn into_values(self) -> Vec<f32> {
        self.values
    }
}

/// Reads a picture from the bytes of a whole file. Its first bytes tell the format; `name` is what errors call it.
///
/// - PNG of every kind. 0 to 1: grey, or the Rec. 709 luminance of the samples as they are stored (no gamma is
///   applied), times alpha where there is alpha. The first frame of an animation.
/// - OpenEXR of one part with flat pixels, plain or packed with RLE, ZIPS, ZIP, PIZ or PXR24. The numbers as they are:
///   of channel `Y`, else the luminance of `R`, `G` and `B`, else of `R`, else of the only channel; times `A` where
///   there is one. The data window is the picture, at its full resolution; they are finite and within ±1e7.
///
/// # Errors
///
/// [`Error::UnknownContent`] for other bytes, [`Error::Size`] for sides that are not 1 to [`MAX_BITMAP_SIDE`],
/// [`Error::Truncated`], [`Error::Malformed`], [`Error::Unsupported`], and [`Error::Memory`] for an EXR file of huge
/// tiles. Declared sizes are checked against the limits and the length before anything is allocated.
pub fn read_bitmap(bytes: &[u8], name: &str) -> Result<Bitmap> {
    let place = |format| Place { path: PathBuf::from(name), format };
    if bytes.starts_with(png::SIGNATURE) {
        png::read(&place(Format::Png), bytes)
    } else if bytes.starts_with(exr::SIGNATURE) {
        exr::read(&place(Format::Exr), bytes)
    } else {
        Err(Error::UnknownContent { path: PathBuf::from(name), known: "PNG and OpenEXR" })
    }
}
