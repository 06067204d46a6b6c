//! TIFF, BigTIFF and GeoTIFF with one band: strips or tiles, plain, PackBits, LZW or deflated, predictors 1 to 3.
//!
//! The `tiff` crate decodes. [`layout`] reads the directory before it and refuses what it must not be asked to
//! allocate; [`geo`] reads where the raster lies; [`rows`] streams.

mod geo;
mod layout;
mod rows;

use std::fs::File;
use std::io::BufReader;

use tiff::TiffError;
use tiff::decoder::{Decoder, Limits};
use tiff::tags::{CompressionMethod, Tag};

use self::layout::{Chunks, Layout};
use crate::error::{Error, Result};
use crate::format::{ByteOrder, SampleType};
use crate::options::ImportOptions;
use crate::place::Place;
use crate::sample::Decoding;
use crate::source::{Header, Source};

/// The GDAL tag with an XML text of metadata.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// The most that the values of one tag may take in memory: those of two million chunks.
const MAX_TAG_BYTES: usize = 64 << 20;

type TiffDecoder = Decoder<BufReader<File>>;

/// Opens an image file; its first image is the raster.
pub(crate) fn open(place: &Place, options: &ImportOptions) -> Result<Source> {
    let (mut reader, bytes) = place.open()?;
    let layout = Layout::read(place, &mut reader, bytes, options.max_samples_per_side)?;
    // Chunks are checked against the memory limit, and the values of tags against the file's length.
    let mut limits = Limits::default();
    limits.decoding_buffer_size = MAX_TAG_BYTES;
    limits.intermediate_buffer_size = usize::MAX;
    let mut decoder = Decoder::new(reader).map_err(|err| reading(place, err))?.with_limits(limits);
    let sample = sample_type(place, &mut decoder)?;
    let chunks = Chunks::read(place, &mut decoder, &layout, sample, bytes, options.memory_limit_bytes)?;
    let geo = geo::read(place, &mut decoder, (layout.width, layout.depth))?;

    let mut notices = geo.notices;
    if decoder.more_images() {
        notices.push("only its first image is read; the others, often overviews, are left out".to_owned());
    }
    let nodata = nodata(place, &mut decoder)?;
    let byte_order = match chunks.compression {
        CompressionMethod::None if chunks.is_plain_strips => decoder_byte_order(&decoder),
        _ if cfg!(target_endian = "big") => ByteOrder::Big,
        _ => ByteOrder::Little,
    };
    let decoding = Decoding::new(sample, byte_order).with_void(nodata).with_unit(geo.metres_per_height_unit);
    let header = Header {
        width: layout.width,
        depth: layout.depth,
        sample,
        spacing: geo.spacing,
        georeference: geo.georeference,
        notices,
        needs_scan: decoding.may_be_void()
            || chunks.compression != CompressionMethod::None
            || chunks.has_gaps(),
    };
    Ok(Source { header, rows: rows::open(decoder, layout, chunks, decoding, place) })
}

fn decoder_byte_order(decoder: &TiffDecoder) -> ByteOrder {
    match decoder.byte_order() {
        tiff::tags::ByteOrder::LittleEndian => ByteOrder::Little,
        tiff::tags::ByteOrder::BigEndian => ByteOrder::Big,
    }
}

fn sample_type(place: &Place, decoder: &mut TiffDecoder) -> Result<SampleType> {
    let mut first = |tag, default| -> Result<u16> {
        let values = decoder.find_tag_unsigned_vec::<u16>(tag).map_err(|err| reading(place, err))?;
        Ok(values.and_then(|values| values.first().copied()).unwrap_or(default))
    };
    let photometric = first(Tag::PhotometricInterpretation, 1)?;
    if photometric != 1 {
        return Err(place.unsupported(format!(
            "its samples are of photometric kind {photometric}; heights are of kind 1, black is zero"
        )));
    }
    let (bits, format) = (first(Tag::BitsPerSample, 1)?, first(Tag::SampleFormat, 1)?);
    match (format, bits) {
        (1, 8) => Ok(SampleType::U8),
        (1, 16) => Ok(SampleType::U16),
        (1, 32) => Ok(SampleType::U32),
        (2, 8) => Ok(SampleType::I8),
        (2, 16) => Ok(SampleType::I16),
        (2, 32) => Ok(SampleType::I32),
        (3, 32) => Ok(SampleType::F32),
        (3, 64) => Ok(SampleType::F64),
        _ => Err(place.unsupported(format!(
            "samples of {bits} bits and format {format} are not read; integers of 8, 16 and 32 bits and floats of 32 and 64 are"
        ))),
    }
}

/// The value that GDAL's tag says means "no data".
fn nodata(place: &Place, decoder: &mut TiffDecoder) -> Result<Option<f64>> {
    let Some(value) = decoder.find_tag(Tag::GdalNodata).map_err(|err| reading(place, err))? else {
        return Ok(None);
    };
    let text = value.into_string().map_err(|err| reading(place, err))?;
    match text.trim().trim_end_matches('\0').parse() {
        Ok(value) => Ok(Some(value)),
        Err(_) => Err(place.malformed(format!("its nodata value `{text}` is no number"))),
    }
}

fn reading(place: &Place, err: TiffError) -> Error {
    match err {
        TiffError::IoError(err) => place.reading(err),
        TiffError::UnsupportedError(err) => place.unsupported(err.to_string()),
        err => place.malformed(err.to_string()),
    }
}
