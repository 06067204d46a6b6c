//! Samples one after another, row after row: what headless files, HGT tiles and NumPy arrays hold.

use std::io::Read;

use crate::error::Result;
use crate::place::Place;
use crate::sample::Decoding;
use crate::source::RowSource;

/// Rows of samples from a reader that stands at the first.
pub(crate) struct FlatRows<R> {
    reader: R,
    decoding: Decoding,
    /// One row as stored.
    bytes: Vec<u8>,
    place: Place,
}

impl<R: Read + Send> FlatRows<R> {
    /// Rows of `width` samples.
    pub fn new(reader: R, decoding: Decoding, width: u32, place: &Place) -> Self {
        let bytes = vec![0; decoding.row_bytes(width) as usize];
        Self { reader, decoding, bytes, place: place.clone() }
    }
}

impl<R: Read + Send> RowSource for FlatRows<R> {
    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        self.reader.read_exact(&mut self.bytes).map_err(|err| self.place.reading(err))?;
        self.decoding.decode(&self.bytes, row);
        Ok(())
    }
}
