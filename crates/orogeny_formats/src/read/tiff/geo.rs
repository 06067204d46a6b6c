//! Where a GeoTIFF lies (OGC GeoTIFF 1.1, 19-008r4): pixel scale and tie point or a transformation, and the keys
//! that say what their numbers mean.

use tiff::tags::Tag;

use super::{GDAL_METADATA, TiffDecoder, reading};
use crate::error::Result;
use crate::info::Georeference;
use crate::place::Place;
use crate::source::Spacing;

const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;
const GEOGRAPHIC_SYSTEM: u16 = 2048;
const ANGULAR_UNITS: u16 = 2054;
const PROJECTED_SYSTEM: u16 = 3072;
const LINEAR_UNITS: u16 = 3076;
const VERTICAL_UNITS: u16 = 4099;

/// What the keys call a system that has no code.
const USER_DEFINED: u16 = 32767;
/// The EPSG code of degrees.
const DEGREE: u16 = 9102;
/// The EPSG code of Web Mercator.
const WEB_MERCATOR: u16 = 3857;

/// What a file says of its place.
pub(super) struct Geo {
    pub spacing: Spacing,
    pub georeference: Option<Georeference>,
    pub metres_per_height_unit: f64,
    pub notices: Vec<String>,
}

/// Reads the tags of a raster of `size` samples.
pub(super) fn read(place: &Place, decoder: &mut TiffDecoder, size: (u32, u32)) -> Result<Geo> {
    let keys = Keys::read(place, decoder)?;
    let mut notices = Vec::new();
    let metres_per_height_unit = match keys.get(VERTICAL_UNITS) {
        None => 1.0,
        Some(code) => metres_in(code)
            .ok_or_else(|| place.unsupported(format!("its heights are in the unknown unit {code} (EPSG)")))?,
    };
    if metres_per_height_unit != 1.0 {
        notices.push(format!(
            "its heights are in feet and were taken to metres, {metres_per_height_unit} m each"
        ));
    }
    let metadata = decoder.find_tag(GDAL_METADATA).map_err(|err| reading(place, err))?;
    if metadata
        .and_then(|value| value.into_string().ok())
        .is_some_and(|xml| xml.contains("role=\"scale\"") || xml.contains("role=\"offset\""))
    {
        notices
            .push("its metadata name a scale or an offset of its samples, which were not applied".to_owned());
    }

    let Some(grid) = Grid::read(place, decoder)? else {
        return Ok(Geo { spacing: Spacing::Unknown, georeference: None, metres_per_height_unit, notices });
    };
    let is_point = keys.get(RASTER_TYPE) == Some(2);
    let origin = grid.origin.map(|(x, y)| match is_point {
        true => (x, y),
        false => (x + grid.pixel.0 / 2.0, y - grid.pixel.1 / 2.0),
    });
    let model_type = keys.get(MODEL_TYPE);
    let spacing = match model_type {
        Some(1) => match keys.get(LINEAR_UNITS).map(metres_in) {
            Some(None) => Spacing::Unplaced { what: "spaced in an unknown unit", instead: "give a spacing" },
            unit => {
                let metres = unit.flatten().unwrap_or(1.0);
                if unit.is_none() {
                    notices.push("it does not name its unit of length: metres are assumed".to_owned());
                }
                Spacing::Metres { x: grid.pixel.0 * metres, z: grid.pixel.1 * metres }
            }
        },
        Some(2) => match (origin, keys.get(ANGULAR_UNITS).unwrap_or(DEGREE)) {
            (Some((_, north)), DEGREE) => {
                let latitude = north - (f64::from(size.1) - 1.0) / 2.0 * grid.pixel.1;
                if !(-90.0..=90.0).contains(&latitude) {
                    return Err(place.malformed(format!("its centre lies at latitude {latitude}")));
                }
                Spacing::Degrees { x: grid.pixel.0, z: grid.pixel.1, latitude }
            }
            (None, _) => Spacing::Unplaced { what: "spaced in degrees", instead: "give a spacing" },
            _ => Spacing::Unplaced { what: "spaced in an unknown unit of angle", instead: "give a spacing" },
        },
        _ => Spacing::Unplaced { what: "spaced in a unit it does not name", instead: "give a spacing" },
    };
    let is_geographic = model_type == Some(2);
    let epsg = keys.get(if is_geographic { GEOGRAPHIC_SYSTEM } else { PROJECTED_SYSTEM });
    let epsg = epsg.filter(|&code| code != USER_DEFINED && code != 0);
    if epsg == Some(WEB_MERCATOR) && !is_geographic {
        notices.push(
            "its metres are those of Web Mercator, longer than on the ground away from the equator"
                .to_owned(),
        );
    }
    let georeference =
        origin.map(|origin| Georeference { epsg, origin, pixel: grid.pixel, is_geographic, is_point });
    Ok(Geo { spacing, georeference, metres_per_height_unit, notices })
}

/// Metres in the unit of length of an EPSG code: the metre, the foot and the US survey foot.
fn metres_in(code: u16) -> Option<f64> {
    match code {
        9001 => Some(1.0),
        9002 => Some(0.3048),
        9003 => Some(1200.0 / 3937.0),
        _ => None,
    }
}

/// Where the corner of the raster is (the centre of its first sample where samples are points), and a pixel's size.
struct Grid {
    origin: Option<(f64, f64)>,
    pixel: (f64, f64),
}

impl Grid {
    fn read(place: &Place, decoder: &mut TiffDecoder) -> Result<Option<Self>> {
        let mut numbers = |tag| -> Result<Option<Vec<f64>>> {
            let value = decoder.find_tag(tag).map_err(|err| reading(place, err))?;
            value.map(|value| value.into_f64_vec().map_err(|err| reading(place, err))).transpose()
        };
        let scale = numbers(Tag::ModelPixelScaleTag)?;
        let tie = numbers(Tag::ModelTiepointTag)?;
        let transformation = numbers(Tag::ModelTransformationTag)?;
        let grid = match (scale.as_deref(), transformation.as_deref()) {
            (Some(&[x, y, ..]), _) => {
                let origin = match tie.as_deref() {
                    Some(&[column, row, _, east, north, ..]) => Some((east - column * x, north + row * y)),
                    _ => None,
                };
                Self { origin, pixel: (x, y) }
            }
            (None, Some(&[x, skew_x, _, east, skew_y, y, _, north, ..])) => {
                if skew_x != 0.0 || skew_y != 0.0 {
                    return Err(place.unsupported("its rows do not run from west to east: turn it north up"));
                }
                Self { origin: Some((east, north)), pixel: (x, -y) }
            }
            (None, None) => return Ok(None),
            _ => return Err(place.malformed("its pixel scale or transformation is too short")),
        };
        let numbers =
            [grid.pixel.0, grid.pixel.1].into_iter().chain(grid.origin.into_iter().flat_map(|(x, y)| [x, y]));
        if numbers.into_iter().any(|number| !number.is_finite()) || grid.pixel.0 == 0.0 || grid.pixel.1 == 0.0
        {
            return Err(place.malformed("its pixel scale or place is no number"));
        }
        if grid.pixel.0 < 0.0 || grid.pixel.1 < 0.0 {
            return Err(place.unsupported("its first sample is not its north-west one: turn it north up"));
        }
        Ok(Some(grid))
    }
}

/// The short values of the key directory.
struct Keys(Vec<u16>);

impl Keys {
    fn read(place: &Place, decoder: &mut TiffDecoder) -> Result<Self> {
        let keys =
            decoder.find_tag_unsigned_vec(Tag::GeoKeyDirectoryTag).map_err(|err| reading(place, err))?;
        Ok(Self(keys.unwrap_or_default()))
    }

    /// The value of a key, if it is there and short. A header of four shorts comes first, then four for each key: its
    /// number, where its value is (0: right here), how many values, and the value.
    fn get(&self, key: u16) -> Option<u16> {
        let (quads, _) = self.0.as_chunks::<4>();
        quads
            .iter()
            .skip(1)
            .find(|[number, place, ..]| (*number, *place) == (key, 0))
            .map(|[.., value]| *value)
    }
}
