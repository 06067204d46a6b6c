//! A picture that shapes a brush.

use crate::{Error, Result};

/// The longest side of a bitmap, in pixels.
pub const MAX_BITMAP_SIDE: u32 = 4096;

/// Pixels of one value each, row 0 at the top. Covers the square about a brush's circle.
#[derive(Debug, Clone, PartialEq)]
pub struct Bitmap {
    width: u32,
    height: u32,
    values: Vec<f32>,
}

impl Bitmap {
    /// From its rows.
    ///
    /// # Errors
    /// [`Error::Bitmap`] for a side of none or of more than [`MAX_BITMAP_SIDE`] pixels, the wrong number of values, or one that
    /// is not finite and within ±1e7.
    pub fn new(width: u32, height: u32, values: Vec<f32>) -> Result<Self> {
        let is_side = |side: u32| (1..=MAX_BITMAP_SIDE).contains(&side);
        let reason = if !is_side(width) || !is_side(height) {
            format!("each side takes 1 to {MAX_BITMAP_SIDE} pixels")
        } else if values.len() != width as usize * height as usize {
            format!("it needs {} values, {} were given", width as usize * height as usize, values.len())
        } else if let Some(value) = values.iter().find(|value| !crate::is_storable_height(**value)) {
            format!("the value {value} is not within ±{}", crate::MAX_HEIGHT_M)
        } else {
            return Ok(Self { width, height, values });
        };
        Err(Error::Bitmap { width, height, reason })
    }

    /// Pixels along x.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Pixels from top to bottom.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, row after row.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// A pixel; those outside are those of the border.
    #[inline(always)]
    #[must_use]
    pub fn pixel(&self, x: i32, y: i32) -> f32 {
        let x = x.clamp(0, self.width.cast_signed() - 1) as usize;
        let y = y.clamp(0, self.height.cast_signed() - 1) as usize;
        self.values.get(y * self.width as usize + x).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_bitmap_is_refused() {
        for (width, height, values, word) in [
            (0, 1, vec![], "sides"),
            (4097, 1, vec![0.0; 4097], "side"),
            (2, 2, vec![0.0; 3], "needs 4"),
            (1, 1, vec![f32::NAN], "NaN"),
            (1, 1, vec![2.0e7], "within"),
        ] {
            let err = Bitmap::new(width, height, values).unwrap_err().to_string();
            assert!(err.contains(word.trim_end_matches('s')), "{err}");
        }
        let bitmap = Bitmap::new(2, 1, vec![0.25, 1.0]).unwrap();
        assert_eq!((bitmap.pixel(-5, 3), bitmap.pixel(1, 0), bitmap.pixel(9, 0)), (0.25, 1.0, 1.0));
    }
}
