//! One encoder per format; each is a [`RowSink`].

mod flat;
mod png;
mod tiff;

use std::fs::File;
use std::io::BufWriter;

use crate::error::Result;
use crate::format::{Format, SampleType};
use crate::place::Place;
use crate::sample::Encoding;

/// Takes rows, the north row first.
pub(crate) trait RowSink: Send {
    /// Writes a whole row of finite heights in metres.
    fn write_row(&mut self, row: &[f32]) -> Result<()>;

    /// Writes what comes after the last row, and all that is still held back.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// A raster that is to be written.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    pub place: Place,
    pub width: u32,
    pub depth: u32,
    pub sample: SampleType,
    pub encoding: Encoding,
    pub spacing_m: Option<f64>,
}

/// Begins a file.
pub(crate) fn create(file: File, target: &Target) -> Result<Box<dyn RowSink>> {
    let file = BufWriter::with_capacity(1 << 16, file);
    match target.place.format {
        Format::Png => png::create(file, target),
        Format::Tiff => tiff::create(file, target),
        Format::Npy => flat::create_npy(file, target),
        Format::R16 | Format::Raw | Format::R32 | Format::Hgt => flat::create(file, target),
        Format::Exr => Err(target.place.unsupported("it is read as the bitmap of a brush, and not written")),
    }
}
