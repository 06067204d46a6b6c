//! Rows of a TIFF: straight from the file where they lie there as they are, else by bands of chunks.

use std::io::{Read, Seek, SeekFrom};

use super::layout::{Chunks, Layout};
use super::{TiffDecoder, reading};
use crate::error::Result;
use crate::place::Place;
use crate::sample::{Decoding, NO_HEIGHT};
use crate::source::RowSource;

/// Rows of the decoder's image.
pub(super) fn open(
    decoder: TiffDecoder,
    layout: Layout,
    chunks: Chunks,
    decoding: Decoding,
    place: &Place,
) -> Box<dyn RowSource> {
    let (place, next_row) = (place.clone(), 0);
    if chunks.is_plain_strips {
        let bytes = vec![0; decoding.row_bytes(layout.width) as usize];
        return Box::new(PlainRows { decoder, chunks, decoding, bytes, next_row, place });
    }
    Box::new(BandRows {
        decoder,
        layout,
        chunks,
        decoding,
        bytes: Vec::new(),
        band: Vec::new(),
        next_row,
        place,
    })
}

/// Rows that lie in the file as they are.
struct PlainRows {
    decoder: TiffDecoder,
    chunks: Chunks,
    decoding: Decoding,
    /// One row as stored.
    bytes: Vec<u8>,
    next_row: u32,
    place: Place,
}

impl RowSource for PlainRows {
    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        let (strip, row_in_strip) = (self.next_row / self.chunks.depth, self.next_row % self.chunks.depth);
        self.next_row += 1;
        let Some(offset) = self.chunks.offsets.get(strip as usize).copied().flatten() else {
            row.fill(NO_HEIGHT);
            return Ok(());
        };
        let offset = offset + u64::from(row_in_strip) * self.bytes.len() as u64;
        let reader = self.decoder.inner();
        let here = reader.stream_position().map_err(|err| self.place.reading(err))?;
        if here != offset {
            reader.seek(SeekFrom::Start(offset)).map_err(|err| self.place.reading(err))?;
        }
        reader.read_exact(&mut self.bytes).map_err(|err| self.place.reading(err))?;
        self.decoding.decode(&self.bytes, row);
        Ok(())
    }
}

/// Rows of strips or tiles that must be decoded whole.
struct BandRows {
    decoder: TiffDecoder,
    layout: Layout,
    chunks: Chunks,
    decoding: Decoding,
    /// One chunk's samples.
    bytes: Vec<u8>,
    /// Heights of the chunks that lie side by side, in whole rows.
    band: Vec<f32>,
    next_row: u32,
    place: Place,
}

impl BandRows {
    /// Decodes the band that begins at `first_row`.
    fn load(&mut self, first_row: u32) -> Result<()> {
        let Self { layout, chunks, .. } = self;
        let depth = chunks.depth.min(layout.depth - first_row);
        self.band.clear();
        self.band.resize(layout.width as usize * depth as usize, NO_HEIGHT);
        let first_chunk = first_row / chunks.depth * chunks.num_across;
        for across in 0..chunks.num_across {
            let chunk = first_chunk + across;
            if chunks.offsets.get(chunk as usize).copied().flatten().is_none() {
                continue;
            }
            let first_column = across * chunks.width;
            let width = chunks.width.min(layout.width - first_column);
            let row_bytes = self.decoding.row_bytes(width) as usize;
            self.bytes.clear();
            self.bytes.resize(row_bytes * depth as usize, 0);
            self.decoder.read_chunk_bytes(chunk, &mut self.bytes).map_err(|err| reading(&self.place, err))?;
            let rows = self.band.chunks_exact_mut(layout.width as usize);
            for (row, stored) in rows.zip(self.bytes.chunks_exact(row_bytes)) {
                let (_, row) = row.split_at_mut(first_column as usize);
                self.decoding.decode(stored, row);
            }
        }
        Ok(())
    }
}

impl RowSource for BandRows {
    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        let row_in_band = self.next_row % self.chunks.depth;
        if row_in_band == 0 {
            self.load(self.next_row)?;
        }
        let width = self.layout.width as usize;
        let heights_m = self.band.chunks_exact(width).nth(row_in_band as usize);
        row.copy_from_slice(heights_m.ok_or_else(|| self.place.truncated())?);
        self.next_row += 1;
        Ok(())
    }
}
