//! HGT: a tile of SRTM or NASADEM, one degree square, as it is or inside a zip.
//!
//! Whole metres as big-endian i16, −32768 where there is none; 1201² samples 3 arc seconds apart, or 3601² samples
//! 1 arc second apart, the outer ones on the tile's edges. Where the tile lies is in its name: `N34W119` is its
//! south-west corner.

use std::fs::File;
use std::io::{self, BufReader, Cursor, Read};

use zip::ZipArchive;
use zip::result::ZipError;

use super::flat::FlatRows;
use crate::error::{Error, Result};
use crate::format::{ByteOrder, SampleType};
use crate::info::Georeference;
use crate::options::ImportOptions;
use crate::place::Place;
use crate::sample::Decoding;
use crate::source::{Header, RowSource, Source, Spacing};

/// The stored value that means "no data".
const VOID: f64 = -32768.0;

/// The EPSG code of WGS84 longitude and latitude.
const WGS84: u16 = 4326;

/// Opens a tile.
pub(crate) fn open(place: &Place, options: &ImportOptions) -> Result<Source> {
    let (reader, bytes) = place.open()?;
    let is_zip = place
        .path
        .extension()
        .and_then(|ending| ending.to_str())
        .is_some_and(|ending| ending.eq_ignore_ascii_case("zip"));
    let file_name =
        place.path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();

    if !is_zip {
        let side = side(bytes).ok_or_else(|| wrong_size(place, bytes))?;
        return source(place, options, side, corner(&file_name), |decoding| {
            Box::new(FlatRows::new(reader, decoding, side, place))
        });
    }
    let (entry_name, tile) = unzip(place, reader)?;
    let side = side(tile.len() as u64).ok_or_else(|| wrong_size(place, tile.len() as u64))?;
    let corner = corner(&entry_name).or_else(|| corner(&file_name));
    source(place, options, side, corner, |decoding| {
        Box::new(FlatRows::new(Cursor::new(tile), decoding, side, place))
    })
}

fn source(
    place: &Place,
    options: &ImportOptions,
    side: u32,
    corner: Option<(f64, f64)>,
    rows: impl FnOnce(Decoding) -> Box<dyn RowSource>,
) -> Result<Source> {
    let (side, _) = place.check_size(u64::from(side), u64::from(side), options.max_samples_per_side)?;
    let decoding = Decoding::new(SampleType::I16, ByteOrder::Big).with_void(Some(VOID));
    let pixel = 1.0 / (f64::from(side) - 1.0);
    let spacing = match corner {
        Some((_, latitude)) => Spacing::Degrees { x: pixel, z: pixel, latitude: latitude + 0.5 },
        None => Spacing::Unplaced {
            what: "arc seconds",
            instead: "name the file after its tile, as in N34W119.hgt, or give a spacing",
        },
    };
    let header = Header {
        width: side,
        depth: side,
        sample: SampleType::I16,
        spacing,
        georeference: corner.map(|(longitude, latitude)| Georeference {
            epsg: Some(WGS84),
            origin: (longitude, latitude + 1.0),
            pixel: (pixel, pixel),
            is_geographic: true,
            is_point: true,
        }),
        notices: Vec::new(),
        needs_scan: decoding.may_be_void(),
    };
    Ok(Source { header, rows: rows(decoding) })
}

/// Samples a side in a tile of `bytes`.
fn side(bytes: u64) -> Option<u32> {
    [1201_u32, 3601].into_iter().find(|&side| u64::from(side) * u64::from(side) * 2 == bytes)
}

fn wrong_size(place: &Place, bytes: u64) -> Error {
    place.malformed(format!(
        "a tile has 1201 x 1201 samples (2884802 bytes) or 3601 x 3601 (25934402 bytes), this one has {bytes} bytes"
    ))
}

/// Longitude and latitude of the south-west corner that a tile's name tells, as `N34W119` does.
fn corner(name: &str) -> Option<(f64, f64)> {
    let name = name.rsplit(['/', '\\']).next()?;
    let signed = |letter: u8, digits: &str, positive: u8, negative: u8, limit: f64| {
        let sign = match letter.to_ascii_uppercase() {
            letter if letter == positive => 1.0,
            letter if letter == negative => -1.0,
            _ => return None,
        };
        let is_number = digits.bytes().all(|digit| digit.is_ascii_digit());
        let degrees = digits.parse::<f64>().ok().filter(|&degrees| is_number && degrees <= limit)?;
        Some(sign * degrees)
    };
    let letters = (*name.as_bytes().first()?, *name.as_bytes().get(3)?);
    let latitude = signed(letters.0, name.get(1..3)?, b'N', b'S', 90.0)?;
    let longitude = signed(letters.1, name.get(4..7)?, b'E', b'W', 180.0)?;
    Some((longitude, latitude))
}

/// The one tile in a zip, with its name. Its size is known before it is unpacked, and no more is.
fn unzip(place: &Place, reader: BufReader<File>) -> Result<(String, Vec<u8>)> {
    let damaged = |err: ZipError| match err {
        ZipError::Io(err) => place.reading(err),
        ZipError::UnsupportedArchive(_)
        | ZipError::CompressionMethodNotSupported(_)
        | ZipError::InvalidPassword => {
            place.unsupported(format!("{err}; stored and deflated tiles are read"))
        }
        err => place.malformed(err.to_string()),
    };
    let mut archive = ZipArchive::new(reader).map_err(damaged)?;
    let mut tiles = Vec::new();
    for index in 0..archive.len() {
        let entry = archive.by_index_raw(index).map_err(damaged)?;
        let name = String::from_utf8_lossy(entry.name_raw()).into_owned();
        if entry.is_file() && name.to_ascii_lowercase().ends_with(".hgt") {
            tiles.push((index, name, entry.size()));
        }
    }
    let [(index, name, bytes)] = tiles.as_slice() else {
        return Err(place.malformed(format!("the zip holds {} .hgt files, one is needed", tiles.len())));
    };
    if side(*bytes).is_none() {
        return Err(wrong_size(place, *bytes));
    }
    let mut entry = archive.by_index(*index).map_err(damaged)?;
    let mut tile = vec![0; *bytes as usize];
    entry.read_exact(&mut tile).map_err(|err| place.reading(err))?;
    // Reading on past the end makes the checksum be looked at, and shows a tile longer than its header says.
    if io::copy(&mut entry.take(1), &mut io::sink()).map_err(|err| place.reading(err))? != 0 {
        return Err(place.malformed("the tile in the zip is longer than the zip says"));
    }
    Ok((name.clone(), tile))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_the_south_west_corner() {
        assert_eq!(corner("N34W119.hgt"), Some((-119.0, 34.0)));
        assert_eq!(corner("some/folder/s07e110.SRTMGL1.hgt"), Some((110.0, -7.0)));
        for name in
            ["", "N34", "tile.hgt", "N99E000.hgt", "N34W181.hgt", "N3é4W119", "X34W119.hgt", "N-4W119.hgt"]
        {
            assert_eq!(corner(name), None, "{name}");
        }
    }

    #[test]
    fn only_whole_tiles_have_a_side() {
        assert_eq!(side(2_884_802), Some(1201));
        assert_eq!(side(25_934_402), Some(3601));
        assert_eq!((side(0), side(2_884_800), side(1 << 40)), (None, None, None));
    }
}
