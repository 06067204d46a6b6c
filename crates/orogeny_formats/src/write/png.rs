//! PNG: grey, 8 or 16 bits.

use std::fs::File;
use std::io::{self, BufWriter, Write};

use png::{BitDepth, ColorType, EncodingError, StreamWriter};

use super::{RowSink, Target};
use crate::error::{Error, Result};
use crate::format::SampleType;
use crate::place::Place;
use crate::sample::Encoding;

/// Begins a picture.
pub(super) fn create(file: BufWriter<File>, target: &Target) -> Result<Box<dyn RowSink>> {
    let mut encoder = png::Encoder::new(file, target.width, target.depth);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(if target.sample == SampleType::U8 { BitDepth::Eight } else { BitDepth::Sixteen });
    let writer = encoder
        .write_header()
        .and_then(|writer| writer.into_stream_writer())
        .map_err(|err| writing(&target.place, err))?;
    Ok(Box::new(PngSink {
        writer,
        encoding: target.encoding,
        bytes: Vec::new(),
        place: target.place.clone(),
    }))
}

struct PngSink {
    writer: StreamWriter<'static, BufWriter<File>>,
    encoding: Encoding,
    /// One row as stored.
    bytes: Vec<u8>,
    place: Place,
}

impl RowSink for PngSink {
    fn write_row(&mut self, row: &[f32]) -> Result<()> {
        self.encoding.encode(row, &mut self.bytes);
        self.writer.write_all(&self.bytes).map_err(|err| self.place.writing(err))
    }

    fn finish(self: Box<Self>) -> Result<()> {
        let Self { writer, place, .. } = *self;
        writer.finish().map_err(|err| writing(&place, err))
    }
}

fn writing(place: &Place, err: EncodingError) -> Error {
    place.writing(match err {
        EncodingError::IoError(err) => err,
        err => io::Error::other(err),
    })
}
