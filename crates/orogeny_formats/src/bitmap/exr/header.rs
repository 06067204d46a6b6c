//! What an EXR file's header declares, and whether a file of its length can hold that.
//!
//! The crate `exr` reads headers too, but allocates what they declare, however small the file.

use exr::compression::Compression;
use exr::meta::attribute::SampleType;

use super::bytes::Bytes;
use crate::bitmap::MAX_BITMAP_SIDE;
use crate::error::Result;
use crate::place::Place;

/// Flags in the word with the version.
const TILED: u32 = 1 << 9;
const LONG_NAMES: u32 = 1 << 10;
const DEEP: u32 = 1 << 11;
const PARTS: u32 = 1 << 12;

/// One number of every pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Channel<'a> {
    pub name: &'a [u8],
    pub kind: SampleType,
    /// Bytes of the channels before it in a pixel.
    pub offset: usize,
}

/// A header of one part with flat pixels.
#[derive(Debug)]
pub(super) struct Header<'a> {
    pub width: u32,
    pub height: u32,
    /// The number that blocks of rows call the top row.
    pub first_row: i32,
    pub channels: Vec<Channel<'a>>,
    /// Bytes of all channels of a pixel.
    pub pixel_bytes: usize,
    pub compression: Compression,
    /// Width and height of a tile, where there are tiles.
    pub tile: Option<(u32, u32)>,
    /// What follows the header: the places of the blocks, and the blocks.
    pub after: &'a [u8],
}

/// The attributes that say how pixels are stored, as they are in the file.
#[derive(Default)]
struct Attributes<'a> {
    channels: Option<&'a [u8]>,
    compression: Option<&'a [u8]>,
    data_window: Option<&'a [u8]>,
    tiles: Option<&'a [u8]>,
}

impl<'a> Header<'a> {
    /// Reads the header of a file that begins as EXR files do.
    pub fn read(place: &Place, file: &'a [u8]) -> Result<Self> {
        let mut rest = Bytes(file);
        let version = rest.u32().and_then(|_signature| rest.u32()).ok_or_else(|| place.truncated())?;
        if version & (DEEP | PARTS) != 0 {
            return Err(
                place.unsupported("it has deep pixels or several parts; one part of flat pixels is read")
            );
        }
        if version & !(TILED | LONG_NAMES) != 2 {
            return Err(place.unsupported("it is not of version 2"));
        }
        let attributes = Attributes::read(place, &mut rest)?;

        let missing = |what: &str| place.malformed(format!("it does not say its {what}"));
        let (width, height, first_row) = attributes.window().ok_or_else(|| missing("data window"))?;
        let (width, height) = place.check_size(width, height, MAX_BITMAP_SIDE)?;
        let compression = match attributes.compression {
            Some([kind]) => compression(place, *kind)?,
            _ => return Err(missing("compression")),
        };
        let tile = match attributes.tile() {
            _ if version & TILED == 0 => None,
            Some((tile_width, tile_height)) if tile_width > 0 && tile_height > 0 => {
                Some((tile_width.min(width), tile_height.min(height)))
            }
            _ => return Err(missing("size of tiles")),
        };
        let channels = channels(place, attributes.channels.ok_or_else(|| missing("channels"))?)?;
        let pixel_bytes = channels.iter().map(|channel| channel.kind.bytes_per_sample()).sum();

        // What a header says and a file of this length cannot hold.
        let picture_bytes = (u64::from(width) * u64::from(height)).saturating_mul(pixel_bytes as u64);
        if picture_bytes > (file.len() as u64).saturating_mul(growth(compression)) {
            return Err(place.truncated());
        }
        Ok(Self { width, height, first_row, channels, pixel_bytes, compression, tile, after: rest.0 })
    }
}

impl<'a> Attributes<'a> {
    /// Reads up to the end of the header.
    fn read(place: &Place, rest: &mut Bytes<'a>) -> Result<Self> {
        let truncated = || place.truncated();
        let mut attributes = Self::default();
        loop {
            let name = rest.text().ok_or_else(truncated)?;
            if name.is_empty() {
                return Ok(attributes);
            }
            let kind = rest.text().ok_or_else(truncated)?;
            let length = rest.i32().ok_or_else(truncated)?;
            let length = usize::try_from(length)
                .map_err(|_| place.malformed(format!("an attribute of its header has {length} bytes")))?;
            let value = rest.take(length).ok_or_else(truncated)?;
            match (name, kind) {
                (b"channels", b"chlist") => attributes.channels = Some(value),
                (b"compression", b"compression") => attributes.compression = Some(value),
                (b"dataWindow", b"box2i") => attributes.data_window = Some(value),
                (b"tiles", b"tiledesc") => attributes.tiles = Some(value),
                _ => {}
            }
        }
    }

    /// Width, height and first row of the data window; a side is 0 where its ends are the wrong way round.
    fn window(&self) -> Option<(u64, u64, i32)> {
        let mut value = Bytes(self.data_window?);
        let (left, top, right, bottom) = (value.i32()?, value.i32()?, value.i32()?, value.i32()?);
        let side = |first, last| u64::try_from(i64::from(last) - i64::from(first) + 1).unwrap_or(0);
        Some((side(left, right), side(top, bottom), top))
    }

    /// Width and height of a tile.
    fn tile(&self) -> Option<(u32, u32)> {
        let mut value = Bytes(self.tiles?);
        Some((value.u32()?, value.u32()?))
    }
}

fn compression(place: &Place, kind: u8) -> Result<Compression> {
    match kind {
        0 => Ok(Compression::Uncompressed),
        1 => Ok(Compression::RLE),
        2 => Ok(Compression::ZIP1),
        3 => Ok(Compression::ZIP16),
        4 => Ok(Compression::PIZ),
        5 => Ok(Compression::PXR24),
        // The decoders of B44 and DWA panic or abort on damaged files (exr 1.74.2).
        _ => Err(place
            .unsupported(format!("compression {kind} is not read; none, RLE, ZIPS, ZIP, PIZ and PXR24 are"))),
    }
}

/// By how much the best-packed data of each kind can grow.
fn growth(compression: Compression) -> u64 {
    match compression {
        Compression::Uncompressed => 1,
        Compression::RLE => 64,
        // Deflate, of which PXR24 makes four bytes from three. PIZ grows by less.
        _ => 1032 * 4 / 3,
    }
}

/// The channels in the order in which their samples are stored.
fn channels<'a>(place: &Place, value: &'a [u8]) -> Result<Vec<Channel<'a>>> {
    let malformed = || place.malformed("its list of channels is damaged");
    let mut rest = Bytes(value);
    let (mut channels, mut offset) = (Vec::new(), 0);
    loop {
        let name = rest.text().ok_or_else(malformed)?;
        if name.is_empty() {
            return if channels.is_empty() { Err(malformed()) } else { Ok(channels) };
        }
        let kind = match rest.u32().ok_or_else(malformed)? {
            0 => SampleType::U32,
            1 => SampleType::F16,
            2 => SampleType::F32,
            _ => return Err(malformed()),
        };
        // A hint for lossy compressions, and three zeroes.
        rest.take(4).ok_or_else(malformed)?;
        if (rest.u32().ok_or_else(malformed)?, rest.u32().ok_or_else(malformed)?) != (1, 1) {
            return Err(place.unsupported("a channel has fewer samples than the picture has pixels"));
        }
        channels.push(Channel { name, kind, offset });
        offset += kind.bytes_per_sample();
    }
}
