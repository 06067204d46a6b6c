//! What a TIFF's directory declares, and whether a file of its length can hold that.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};

use tiff::decoder::ChunkType;
use tiff::tags::{CompressionMethod, Tag};

use super::{TiffDecoder, reading};
use crate::error::Result;
use crate::format::{ByteOrder, SampleType};
use crate::place::Place;

/// The longest side of a tile, samples. Programs write 128 to 4,096.
const MAX_TILE_SIDE: u64 = 1 << 16;

const IMAGE_WIDTH: u16 = 256;
const IMAGE_LENGTH: u16 = 257;
const SAMPLES_PER_PIXEL: u16 = 277;
const TILE_WIDTH: u16 = 322;
const TILE_LENGTH: u16 = 323;

/// The size of the first image, before the decoder has seen it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub width: u32,
    pub depth: u32,
    /// Width and length of a tile, where there are tiles.
    tile: Option<(u32, u32)>,
}

impl Layout {
    /// Reads the first directory, and puts the reader back at the start.
    ///
    /// No entry may claim more bytes than the file has, so the decoder can allocate no more than that for one.
    pub fn read(place: &Place, reader: &mut BufReader<File>, bytes: u64, max_side: u32) -> Result<Self> {
        let directory = Directory::read(place, reader, bytes)?;
        let required = |tag, name| {
            directory.unsigned(tag).ok_or_else(|| place.malformed(format!("it does not say its {name}")))
        };
        let (width, depth) = (required(IMAGE_WIDTH, "width")?, required(IMAGE_LENGTH, "length")?);
        let (width, depth) = place.check_size(width, depth, max_side)?;
        let bands = directory.unsigned(SAMPLES_PER_PIXEL).unwrap_or(1);
        if bands != 1 {
            return Err(place.unsupported(format!("it has {bands} bands, a heightfield has 1")));
        }
        let tile = match (directory.unsigned(TILE_WIDTH), directory.unsigned(TILE_LENGTH)) {
            (None, None) => None,
            (tile_width, tile_length) => {
                let side = |side: Option<u64>| {
                    let side = side.filter(|side| (1..=MAX_TILE_SIDE).contains(side))?;
                    u32::try_from(side).ok()
                };
                match (side(tile_width), side(tile_length)) {
                    (Some(width), Some(length)) => Some((width, length)),
                    _ => {
                        return Err(place
                            .malformed(format!("a side of its tiles is not 1 to {MAX_TILE_SIDE} samples")));
                    }
                }
            }
        };
        reader.rewind().map_err(|err| place.reading(err))?;
        Ok(Self { width, depth, tile })
    }
}

/// The first directory: what fits into its entries themselves.
struct Directory {
    /// Tag to the value, where it is one unsigned integer.
    unsigned: BTreeMap<u16, u64>,
}

impl Directory {
    fn read(place: &Place, reader: &mut BufReader<File>, bytes: u64) -> Result<Self> {
        let mut signature = [0; 4];
        reader.read_exact(&mut signature).map_err(|err| place.reading(err))?;
        let (byte_order, is_big) = match &signature {
            b"II\x2a\0" => (ByteOrder::Little, false),
            b"II\x2b\0" => (ByteOrder::Little, true),
            b"MM\0\x2a" => (ByteOrder::Big, false),
            b"MM\0\x2b" => (ByteOrder::Big, true),
            _ => return Err(place.malformed("it does not begin as a TIFF does")),
        };
        let mut numbers = Numbers { reader, byte_order };
        let read = |err| place.reading(err);
        let (count_bytes, field_bytes) = if is_big { (8, 8) } else { (2, 4) };
        if is_big {
            // The size of an offset, which is always 8, and a zero.
            numbers.unsigned(4).map_err(read)?;
        }
        let offset = numbers.unsigned(field_bytes).map_err(read)?;
        if offset >= bytes {
            return Err(place.truncated());
        }
        numbers.reader.seek(SeekFrom::Start(offset)).map_err(read)?;
        let num_entries = numbers.unsigned(count_bytes).map_err(read)?;
        let mut unsigned = BTreeMap::new();
        for _ in 0..num_entries {
            let tag = numbers.unsigned(2).map_err(read)?;
            let kind = numbers.unsigned(2).map_err(read)?;
            let count = numbers.unsigned(field_bytes).map_err(read)?;
            let value_bytes = match kind {
                1 | 2 | 6 | 7 => 1,
                3 | 8 => 2,
                4 | 9 | 11 | 13 => 4,
                5 | 10 | 12 | 16..=18 => 8,
                _ => return Err(place.malformed(format!("its tag {tag} is of the unknown type {kind}"))),
            };
            if count.saturating_mul(value_bytes) > bytes {
                return Err(
                    place.malformed(format!("its tag {tag} claims {count} values, more than the file holds"))
                );
            }
            let mut field = [0; 8];
            let (field, _) = field.split_at_mut(field_bytes);
            numbers.reader.read_exact(field).map_err(read)?;
            let is_unsigned = matches!(kind, 1 | 3 | 4 | 16) && count == 1;
            if let (true, Ok(tag)) = (is_unsigned, u16::try_from(tag)) {
                let value = field.iter().take(value_bytes as usize);
                unsigned.insert(tag, assemble(value, byte_order));
            }
        }
        Ok(Self { unsigned })
    }

    fn unsigned(&self, tag: u16) -> Option<u64> {
        self.unsigned.get(&tag).copied()
    }
}

/// Unsigned integers of 1 to 8 bytes from a file.
struct Numbers<'a> {
    reader: &'a mut BufReader<File>,
    byte_order: ByteOrder,
}

impl Numbers<'_> {
    fn unsigned(&mut self, num_bytes: usize) -> io::Result<u64> {
        let mut bytes = [0; 8];
        let (bytes, _) = bytes.split_at_mut(num_bytes);
        self.reader.read_exact(bytes)?;
        Ok(assemble(bytes.iter(), self.byte_order))
    }
}

fn assemble<'a>(bytes: impl DoubleEndedIterator<Item = &'a u8>, byte_order: ByteOrder) -> u64 {
    let join = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
    match byte_order {
        ByteOrder::Little => bytes.rev().fold(0, join),
        ByteOrder::Big => bytes.fold(0, join),
    }
}

/// The strips or tiles of the image.
#[derive(Debug)]
pub(super) struct Chunks {
    pub compression: CompressionMethod,
    /// Samples along x and z in a whole one.
    pub width: u32,
    pub depth: u32,
    /// How many lie side by side.
    pub num_across: u32,
    /// Where each begins in the file; none where it was left out, as GDAL does with those that have no data.
    pub offsets: Vec<Option<u64>>,
    /// Whether rows of samples lie in the file as they are, so that they need no chunk in memory.
    pub is_plain_strips: bool,
}

impl Chunks {
    /// Reads where the chunks are, and refuses those that the file or the memory limit cannot hold.
    pub fn read(
        place: &Place,
        decoder: &mut TiffDecoder,
        layout: &Layout,
        sample: SampleType,
        file_bytes: u64,
        memory_limit_bytes: u64,
    ) -> Result<Self> {
        let is_tiled = decoder.get_chunk_type() == ChunkType::Tile;
        let (width, depth) = match (is_tiled, layout.tile) {
            (false, None) => (layout.width, decoder.chunk_dimensions().1.min(layout.depth)),
            (true, Some(tile)) => tile,
            _ => return Err(place.malformed("it mixes strips and tiles")),
        };
        let find = |err| reading(place, err);
        let (offsets, byte_counts) = match is_tiled {
            true => (Tag::TileOffsets, Tag::TileByteCounts),
            false => (Tag::StripOffsets, Tag::StripByteCounts),
        };
        let offsets = decoder.find_tag_unsigned_vec::<u64>(offsets).map_err(find)?.unwrap_or_default();
        let byte_counts =
            decoder.find_tag_unsigned_vec::<u64>(byte_counts).map_err(find)?.unwrap_or_default();
        let compression = decoder.find_tag_unsigned::<u16>(Tag::Compression).map_err(find)?.unwrap_or(1);
        let compression = CompressionMethod::from_u16_exhaustive(compression);
        let has_predictor =
            decoder.find_tag_unsigned::<u16>(Tag::Predictor).map_err(find)?.is_some_and(|kind| kind > 1);

        // By how much the best-packed data of each kind can grow.
        let growth = match compression {
            CompressionMethod::None => 1,
            CompressionMethod::PackBits => 64,
            CompressionMethod::Deflate | CompressionMethod::OldDeflate => 1032,
            CompressionMethod::LZW => 2731,
            method => {
                return Err(place.unsupported(format!(
                    "compression {method:?} is not read; none, PackBits, LZW and deflate are"
                )));
            }
        };
        let num_across = layout.width.div_ceil(width);
        let expected = u64::from(num_across) * u64::from(layout.depth.div_ceil(depth));
        if offsets.len() as u64 != expected || byte_counts.len() as u64 != expected {
            return Err(
                place.malformed(format!("it has {} chunks where its size makes {expected}", offsets.len()))
            );
        }
        let row_bytes = u64::from(width) * u64::from(sample.bytes());
        let mut total_bytes = 0_u64;
        for (index, (&offset, &byte_count)) in (0_u32..).zip(offsets.iter().zip(&byte_counts)) {
            if offset == 0 && byte_count == 0 {
                continue;
            }
            let rows = depth.min(layout.depth.saturating_sub(index / num_across * depth));
            total_bytes = total_bytes.saturating_add(byte_count);
            if offset.checked_add(byte_count).is_none_or(|end| end > file_bytes) {
                return Err(place.truncated());
            }
            if byte_count.saturating_mul(growth) < row_bytes * u64::from(rows) {
                return Err(place.malformed(format!(
                    "its chunk {index} has {byte_count} bytes, too few for its samples"
                )));
            }
        }
        if total_bytes > file_bytes {
            return Err(place.malformed("its chunks overlap in the file"));
        }

        let is_plain_strips = !is_tiled && compression == CompressionMethod::None && !has_predictor;
        let band_bytes = u64::from(layout.width) * u64::from(depth) * 4;
        if !is_plain_strips {
            place.check_memory(
                "a band of its tiles or strips",
                band_bytes.saturating_add(row_bytes * u64::from(depth)),
                memory_limit_bytes,
                "save it with smaller ones",
            )?;
        }
        let offsets =
            offsets.into_iter().zip(byte_counts).map(|chunk| (chunk != (0, 0)).then_some(chunk.0)).collect();
        Ok(Self { compression, width, depth, num_across, offsets, is_plain_strips })
    }

    /// Whether some chunks were left out.
    pub fn has_gaps(&self) -> bool {
        self.offsets.iter().any(Option::is_none)
    }
}
