//! PNG: grey, 8 or 16 bits, without an alpha channel.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek};

use png::{BitDepth, ColorType, Decoder, DecodingError, Limits, Reader, Transformations};

use crate::error::Result;
use crate::format::{ByteOrder, SampleType};
use crate::options::ImportOptions;
use crate::place::Place;
use crate::sample::Decoding;
use crate::sidecar;
use crate::source::{Header, RowSource, Source, Spacing};

/// No deflate stream grows by more than this factor.
pub(crate) const MAX_DEFLATE_RATIO: u64 = 1032;

/// What the decoder may hold beside the rows, bytes.
const DECODER_BYTES: usize = 64 << 20;

/// Opens a picture.
pub(crate) fn open(place: &Place, options: &ImportOptions) -> Result<Source> {
    let (reader, bytes) = place.open()?;
    let mut decoder = decoder(reader, Transformations::IDENTITY);
    // The header alone, before the decoder makes buffers for it.
    let info = decoder.read_header_info().map_err(|err| reading(place, err))?;
    let (width, depth) =
        place.check_size(u64::from(info.width), u64::from(info.height), options.max_samples_per_side)?;
    let sample = match (info.color_type, info.bit_depth) {
        (ColorType::Grayscale, BitDepth::Eight) => SampleType::U8,
        (ColorType::Grayscale, BitDepth::Sixteen) => SampleType::U16,
        (color, depth) => {
            return Err(place.unsupported(format!(
                "{color:?} with {} bits is no heightfield; grey with 8 or 16 bits is",
                depth as u8
            )));
        }
    };
    let row_bytes = u64::from(width) * u64::from(sample.bytes());
    if row_bytes * u64::from(depth) > bytes.saturating_mul(MAX_DEFLATE_RATIO) {
        // What a header says and a file of this length cannot hold.
        return Err(place.truncated());
    }
    let is_interlaced = info.interlaced;
    if is_interlaced {
        let needed = row_bytes * u64::from(depth);
        place.check_memory(
            "an interlaced PNG",
            needed,
            options.memory_limit_bytes,
            "save it without interlacing",
        )?;
    }

    let mut reader = decoder.read_info().map_err(|err| reading(place, err))?;
    let mut notices = sidecar::import_notices(place, sample, options);
    // A PNG may name one grey that is transparent: there is nothing there.
    let transparent = match reader.info().trns.as_deref() {
        Some(&[high, low]) => Some(f64::from(u16::from_be_bytes([high, low]))),
        _ => None,
    };
    if let Some(grey) = transparent {
        notices.push(format!("the grey {grey} is transparent and read as no data"));
    }
    let decoding = Decoding::new(sample, ByteOrder::Big).with_void(transparent).with_range(options.range_m);
    let rows: Box<dyn RowSource> = if is_interlaced {
        let mut picture = vec![0; reader.output_buffer_size().ok_or_else(|| place.truncated())?];
        reader.next_frame(&mut picture).and_then(|_| reader.finish()).map_err(|err| reading(place, err))?;
        Box::new(super::flat::FlatRows::new(std::io::Cursor::new(picture), decoding, width, place))
    } else {
        Box::new(PngRows { reader, decoding, rows_left: depth, place: place.clone() })
    };
    let header = Header {
        width,
        depth,
        sample,
        spacing: Spacing::Unknown,
        georeference: None,
        notices,
        needs_scan: true,
    };
    Ok(Source { header, rows })
}

struct PngRows {
    reader: Reader<BufReader<File>>,
    decoding: Decoding,
    rows_left: u32,
    place: Place,
}

impl RowSource for PngRows {
    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        match self.reader.next_row().map_err(|err| reading(&self.place, err))? {
            Some(stored) => self.decoding.decode(stored.data(), row),
            None => return Err(self.place.truncated()),
        }
        self.rows_left = self.rows_left.saturating_sub(1);
        if self.rows_left == 0 {
            // What ends a picture comes after its rows; without it the file was cut off.
            self.reader.finish().map_err(|err| reading(&self.place, err))?;
        }
        Ok(())
    }
}

/// A decoder that reads no more than the picture, and holds little beside it.
pub(crate) fn decoder<R: BufRead + Seek>(reader: R, transformations: Transformations) -> Decoder<R> {
    let mut decoder = Decoder::new_with_limits(reader, Limits { bytes: DECODER_BYTES });
    decoder.set_transformations(transformations);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder
}

/// An error of the decoder.
pub(crate) fn reading(place: &Place, err: DecodingError) -> crate::Error {
    match err {
        DecodingError::IoError(err) => place.reading(err),
        DecodingError::LimitsExceeded => {
            place.malformed("it asks for more memory than a picture of its size needs")
        }
        err => place.malformed(err.to_string()),
    }
}
