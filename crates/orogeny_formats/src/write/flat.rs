//! Samples one after another: headless files, HGT tiles, and NumPy arrays after their header.

use std::fs::File;
use std::io::{BufWriter, Write};

use super::{RowSink, Target};
use crate::error::Result;
use crate::place::Place;
use crate::sample::Encoding;

/// The array's bytes begin at a multiple of this, as NumPy writes them.
const NPY_ALIGNMENT: usize = 64;

/// Begins a file that is samples alone.
pub(super) fn create(file: BufWriter<File>, target: &Target) -> Result<Box<dyn RowSink>> {
    Ok(Box::new(FlatSink { file, encoding: target.encoding, bytes: Vec::new(), place: target.place.clone() }))
}

/// Begins a NumPy array of little-endian f32 in C order.
pub(super) fn create_npy(mut file: BufWriter<File>, target: &Target) -> Result<Box<dyn RowSink>> {
    let dictionary = format!(
        "{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}), }}",
        target.depth, target.width
    );
    // Magic, version and length take 10 bytes, a line feed ends the header.
    let unpadded = 10 + dictionary.len() + 1;
    let padding = unpadded.next_multiple_of(NPY_ALIGNMENT) - unpadded;
    // Two numbers of at most ten digits keep this far below 65,536.
    let length = u16::try_from(dictionary.len() + padding + 1).unwrap_or(u16::MAX);
    let written = file
        .write_all(b"\x93NUMPY\x01\x00")
        .and_then(|()| file.write_all(&length.to_le_bytes()))
        .and_then(|()| writeln!(file, "{dictionary}{:padding$}", ""));
    written.map_err(|err| target.place.writing(err))?;
    create(file, target)
}

struct FlatSink {
    file: BufWriter<File>,
    encoding: Encoding,
    /// One row as stored.
    bytes: Vec<u8>,
    place: Place,
}

impl RowSink for FlatSink {
    fn write_row(&mut self, row: &[f32]) -> Result<()> {
        self.encoding.encode(row, &mut self.bytes);
        self.file.write_all(&self.bytes).map_err(|err| self.place.writing(err))
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        self.file.flush().map_err(|err| self.place.writing(err))
    }
}
