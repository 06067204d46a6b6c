//! OpenEXR as a bitmap: one part of flat pixels, in rows or tiles.
//!
//! [`header`] and [`blocks`] find where the pixels are, since nothing may be allocated for what a file only claims; the
//! crate `exr` unpacks them, a block at a time. The layout of a file: <https://openexr.com/en/latest/OpenEXRFileLayout.html>.

mod blocks;
mod bytes;
mod header;

use exr::meta::attribute::SampleType;
use exr::prelude::f16;

use self::blocks::Blocks;
use self::header::{Channel, Header};
use super::{Bitmap, LUMINANCE};
use crate::error::Result;
use crate::place::Place;

/// What every EXR file begins with.
pub(super) const SIGNATURE: &[u8] = b"\x76\x2f\x31\x01";

/// The greatest value, and its negative the least.
const MAX_VALUE: f32 = 1e7;

/// Reads a picture.
pub(super) fn read(place: &Place, bytes: &[u8]) -> Result<Bitmap> {
    let header = Header::read(place, bytes)?;
    let mixture = Mixture::new(place, &header.channels)?;
    let blocks = Blocks::new(place, bytes, &header)?;

    let width = header.width as usize;
    let mut values = vec![0.0_f32; width * header.height as usize];
    for block in blocks.decode() {
        let block = block?;
        let rows = values.chunks_exact_mut(width).skip(block.top);
        for (row, stored) in rows.zip(block.samples.chunks_exact(block.width * header.pixel_bytes)) {
            let row = row.iter_mut().skip(block.left).take(block.width);
            for (index, value) in row.enumerate() {
                *value = mixture.value(stored, block.width, index);
            }
        }
    }
    if let Some((index, value)) =
        values.iter().enumerate().find(|(_, value)| !value.is_finite() || value.abs() > MAX_VALUE)
    {
        return Err(place.unsupported(format!(
            "the value at column {}, row {} is {value}; finite ones within ±{MAX_VALUE} are read",
            index % width,
            index / width
        )));
    }
    Bitmap::new(header.width, header.height, values)
}

/// The channels that make a value.
struct Mixture<'a> {
    /// Those that are added up, and how much each of them counts.
    colours: Vec<(Channel<'a>, f64)>,
    alpha: Option<Channel<'a>>,
}

impl<'a> Mixture<'a> {
    fn new(place: &Place, channels: &[Channel<'a>]) -> Result<Self> {
        let find = |name: &[u8]| channels.iter().copied().find(|channel| channel.name == name);
        let alpha = find(b"A");
        let one = |channel, alpha| Ok(Self { colours: vec![(channel, 1.0)], alpha });
        if let Some(luminance) = find(b"Y") {
            return one(luminance, alpha);
        }
        match (find(b"R"), find(b"G"), find(b"B")) {
            (Some(red), Some(green), Some(blue)) => {
                let colours = [red, green, blue].into_iter().zip(LUMINANCE).collect();
                return Ok(Self { colours, alpha });
            }
            (Some(red), ..) => return one(red, alpha),
            _ => {}
        }
        let mut others = channels.iter().copied().filter(|channel| channel.name != b"A");
        match (others.next(), others.next(), alpha) {
            (Some(only), None, _) => one(only, alpha),
            (None, None, Some(alpha)) => one(alpha, None),
            _ => Err(place.unsupported(format!(
                "none of its {} channels is named Y or R; these, R, G and B, or one channel alone are read",
                channels.len()
            ))),
        }
    }

    /// The value of a pixel of a stored row.
    fn value(&self, stored: &[u8], width: usize, index: usize) -> f32 {
        let light: f64 =
            self.colours.iter().map(|(channel, weight)| weight * channel.sample(stored, width, index)).sum();
        let alpha = self.alpha.map_or(1.0, |channel| channel.sample(stored, width, index));
        (light * alpha) as f32
    }
}

impl Channel<'_> {
    /// The number of a pixel of a stored row of so many pixels.
    fn sample(&self, stored: &[u8], width: usize, index: usize) -> f64 {
        let size = self.kind.bytes_per_sample();
        let start = self.offset * width + index * size;
        match (self.kind, stored.get(start..start + size)) {
            (SampleType::F16, Some(&[a, b])) => f16::from_ne_bytes([a, b]).to_f64(),
            (SampleType::F32, Some(&[a, b, c, d])) => f32::from_ne_bytes([a, b, c, d]).into(),
            (SampleType::U32, Some(&[a, b, c, d])) => u32::from_ne_bytes([a, b, c, d]).into(),
            // No row is shorter than its pixels.
            _ => f64::NAN,
        }
    }
}
