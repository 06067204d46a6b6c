//! PNG of every kind as a bitmap.

use std::io::Cursor;

use ::png::Transformations;

use super::{Bitmap, LUMINANCE, MAX_BITMAP_SIDE};
use crate::error::Result;
use crate::place::Place;
use crate::read::png::{MAX_DEFLATE_RATIO, decoder, reading};

/// What every PNG file begins with.
pub(super) const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Reads a picture.
pub(super) fn read(place: &Place, bytes: &[u8]) -> Result<Bitmap> {
    // Palettes become colours, samples of less than 8 bits are spread over 8, and transparent colours become alpha.
    let mut decoder = decoder(Cursor::new(bytes), Transformations::EXPAND);
    // The header alone, before the decoder makes buffers for it.
    let info = decoder.read_header_info().map_err(|err| reading(place, err))?;
    let (width, height) = place.check_size(u64::from(info.width), u64::from(info.height), MAX_BITMAP_SIDE)?;
    if info.raw_bytes() as u64 > (bytes.len() as u64).saturating_mul(MAX_DEFLATE_RATIO) {
        // What a header says and a file of this length cannot hold.
        return Err(place.truncated());
    }
    let mut reader = decoder.read_info().map_err(|err| reading(place, err))?;
    let mut picture = vec![0; reader.output_buffer_size().ok_or_else(|| place.truncated())?];
    let frame = reader.next_frame(&mut picture).map_err(|err| reading(place, err))?;
    // What ends a picture comes after its rows; without it the file was cut off.
    reader.finish().map_err(|err| reading(place, err))?;
    if (frame.width, frame.height) != (width, height) {
        return Err(place.malformed("its first frame is smaller than the picture"));
    }

    let sample_bytes = frame.bit_depth as usize / 8;
    let pixel_bytes = frame.color_type.samples() * sample_bytes;
    let weights: &[f64] = if frame.color_type.samples() < LUMINANCE.len() { &[1.0] } else { &LUMINANCE };
    let value = |pixel: &[u8]| {
        let mut samples = pixel.chunks_exact(sample_bytes).map(sample);
        let light: f64 = weights.iter().zip(&mut samples).map(|(weight, sample)| weight * sample).sum();
        // What is left is alpha.
        (light * samples.next().unwrap_or(1.0)) as f32
    };
    Bitmap::new(width, height, picture.chunks_exact(pixel_bytes).map(value).collect())
}

/// One sample, 0 to 1.
fn sample(stored: &[u8]) -> f64 {
    match *stored {
        [high, low] => f64::from(u16::from_be_bytes([high, low])) / f64::from(u16::MAX),
        [byte] => f64::from(byte) / f64::from(u8::MAX),
        _ => 0.0,
    }
}
