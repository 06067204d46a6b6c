//! The blocks of rows or tiles that an EXR file's pixels are stored in.

use exr::math::{RoundingMode, Vec2};
use exr::meta::BlockDescription;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, LevelMode, LineOrder, Text, TileDescription};
use exr::meta::header::Header as ExrHeader;

use super::bytes::Bytes;
use super::header::Header;
use crate::error::Result;
use crate::place::Place;

/// The most that the pixels of one block may take, bytes: those of a picture of the greatest size that is one tile of
/// four channels.
const MAX_BLOCK_BYTES: u64 = 256 << 20;

/// Bytes of a block's place in the file.
const OFFSET_BYTES: usize = 8;

/// A decoded block.
#[derive(Debug)]
pub(super) struct Block {
    /// Where it is in the picture, pixels.
    pub left: usize,
    pub top: usize,
    pub width: usize,
    /// Row after row, in each the samples of one channel after another, in the machine's byte order.
    pub samples: Vec<u8>,
}

/// Where the blocks of the full resolution are.
pub(super) struct Blocks<'a> {
    place: &'a Place,
    file: &'a [u8],
    header: &'a Header<'a>,
    /// What the decoder is told of the pixels.
    described: ExrHeader,
    /// Width and height of all blocks but those at the right and at the bottom.
    size: (u32, u32),
    num_across: u32,
}

impl<'a> Blocks<'a> {
    /// Refuses blocks that take too much memory.
    pub fn new(place: &'a Place, file: &'a [u8], header: &'a Header<'a>) -> Result<Self> {
        let rows = header.compression.scan_lines_per_block() as u32;
        let size = header.tile.unwrap_or((header.width, rows.min(header.height)));
        let needed = (u64::from(size.0) * u64::from(size.1)).saturating_mul(header.pixel_bytes as u64);
        place.check_memory(
            "a block of an EXR file",
            needed,
            MAX_BLOCK_BYTES,
            "save it with smaller tiles",
        )?;

        // None of the compressions that are read asks for the channels' names.
        let describe = |kind| ChannelDescription::new(Text::default(), kind, false);
        let channels = header.channels.iter().map(|channel| describe(channel.kind)).collect();
        let layout = match header.tile {
            None => BlockDescription::ScanLines,
            Some((width, height)) => BlockDescription::Tiles(TileDescription {
                tile_size: Vec2(width as usize, height as usize),
                level_mode: LevelMode::Singular,
                rounding_mode: RoundingMode::Down,
            }),
        };
        let picture = Vec2(header.width as usize, header.height as usize);
        let described = ExrHeader::new(Text::default(), picture, channels).with_encoding(
            header.compression,
            layout,
            LineOrder::Unspecified,
        );
        Ok(Self { place, file, header, described, size, num_across: header.width.div_ceil(size.0) })
    }

    /// Decodes one block after another; together they cover the picture.
    pub fn decode(&self) -> impl Iterator<Item = Result<Block>> {
        // The blocks of smaller levels come after these, and are not asked for.
        let num_blocks = self.num_across * self.header.height.div_ceil(self.size.1);
        (0..num_blocks).map(|index| self.block(index))
    }

    fn block(&self, index: u32) -> Result<Block> {
        let (column, row) = (index % self.num_across, index / self.num_across);
        let (left, top) = (column * self.size.0, row * self.size.1);
        let (width, height) =
            (self.size.0.min(self.header.width - left), self.size.1.min(self.header.height - top));
        let (is_it, stored) = self.stored(index, column, row).ok_or_else(|| self.place.truncated())?;
        if !is_it {
            return Err(self.place.malformed(format!("its block {index} is not where its list says")));
        }
        let bounds = IntegerBounds::new((0, 0), (width as usize, height as usize));
        let decoded = self.header.compression.decompress_image_section_from_le(
            &self.described,
            stored.to_vec(),
            bounds,
            false,
        );
        let samples = decoded.map_err(|err| match err {
            exr::error::Error::NotSupported(reason) => self.place.unsupported(reason),
            err => self.place.malformed(format!("block {index}: {err}")),
        })?;
        Ok(Block { left: left as usize, top: top as usize, width: width as usize, samples })
    }

    /// Whether what lies in a block's place is that block, and its packed samples; none where the file ends too early.
    fn stored(&self, index: u32, column: u32, row: u32) -> Option<(bool, &'a [u8])> {
        let mut list = Bytes(self.header.after);
        list.take(OFFSET_BYTES.checked_mul(index as usize)?)?;
        let mut block = Bytes(self.file.get(usize::try_from(list.u64()?).ok()?..)?);
        // Each block says which it is, so no two can be the same bytes.
        let is_it = match self.header.tile {
            None => {
                let top = i64::from(self.header.first_row) + i64::from(row) * i64::from(self.size.1);
                i64::from(block.i32()?) == top
            }
            Some(_) => [block.u32()?, block.u32()?, block.u32()?, block.u32()?] == [column, row, 0, 0],
        };
        let length = usize::try_from(block.u32()?).ok()?;
        Some((is_it, block.take(length)?))
    }
}
