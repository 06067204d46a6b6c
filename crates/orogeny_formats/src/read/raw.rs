//! `.r16`, `.r32` and `.raw`: samples and nothing else.
//!
//! The first two are square unless a size is given; of the last nothing is guessed.

use super::flat::FlatRows;
use crate::error::{Error, Result};
use crate::format::{ByteOrder, Format, SampleType};
use crate::options::ImportOptions;
use crate::place::Place;
use crate::sample::Decoding;
use crate::sidecar;
use crate::source::{Header, Source, Spacing};

/// Opens a headless file.
pub(crate) fn open(place: &Place, options: &ImportOptions) -> Result<Source> {
    let (reader, bytes) = place.open()?;
    let sample = sample_type(place, options, bytes)?;
    let (width, depth) = match options.size {
        Some((width, depth)) => (u64::from(width), u64::from(depth)),
        None => square(place, bytes, sample)?,
    };
    let (width, depth) = place.check_size(width, depth, options.max_samples_per_side)?;
    let expected = u64::from(width) * u64::from(depth) * u64::from(sample.bytes());
    if expected != bytes {
        return Err(Error::WrongLength { path: place.path.clone(), expected, actual: bytes });
    }

    let byte_order = options.byte_order.unwrap_or(ByteOrder::Little);
    let decoding = Decoding::new(sample, byte_order).with_range(options.range_m);
    let header = Header {
        width,
        depth,
        sample,
        spacing: Spacing::Unknown,
        georeference: None,
        notices: sidecar::import_notices(place, sample, options),
        needs_scan: decoding.may_be_void(),
    };
    Ok(Source { header, rows: Box::new(FlatRows::new(reader, decoding, width, place)) })
}

fn sample_type(place: &Place, options: &ImportOptions, bytes: u64) -> Result<SampleType> {
    let needs = |missing| Error::RawNeeds { path: place.path.clone(), bytes, missing };
    match (place.format, options.sample, options.size) {
        (Format::R16, ..) => Ok(SampleType::U16),
        (Format::R32, ..) => Ok(SampleType::F32),
        (_, Some(sample), Some(_)) => Ok(sample),
        (_, None, Some(_)) => Err(needs("the sample type")),
        (_, Some(_), None) => Err(needs("width and depth")),
        (_, None, None) => Err(needs("width, depth and the sample type")),
    }
}

/// The sides of a square file of `bytes`.
fn square(place: &Place, bytes: u64, sample: SampleType) -> Result<(u64, u64)> {
    let side = (bytes / u64::from(sample.bytes())).isqrt();
    // A side's square times a sample's bytes is at most `bytes`, so it does not overflow.
    if side * side * u64::from(sample.bytes()) != bytes {
        return Err(Error::SizeNeeded { path: place.path.clone(), bytes, sample_bytes: sample.bytes() });
    }
    Ok((side, side))
}
