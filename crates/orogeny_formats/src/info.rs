//! What is known of a raster before its heights are read.

use crate::format::{Format, SampleType};

/// A raster as it will be delivered.
#[derive(Debug, Clone, PartialEq)]
pub struct RasterInfo {
    /// Samples from west to east, as delivered.
    pub width: u32,
    /// Rows from north to south, as delivered.
    pub depth: u32,
    /// Distance between delivered samples, metres; none if neither the file nor the caller says.
    pub spacing_m: Option<f64>,
    /// What was resampled, filled, lost or assumed, one sentence each, for people.
    pub notices: Vec<String>,
    /// What the file was read as.
    pub format: Format,
    /// How the file stores a sample.
    pub sample: SampleType,
    /// Where on Earth the file says it lies.
    pub georeference: Option<Georeference>,
}

/// Where a raster lies, in its own coordinate system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Georeference {
    /// The EPSG code of the coordinate system, if the file names one.
    pub epsg: Option<u16>,
    /// Model coordinates of the north-west sample (its centre): easting and northing in the system's unit, or
    /// longitude and latitude in degrees.
    pub origin: (f64, f64),
    /// Distance between the file's samples along x and y, in the system's unit, both above 0.
    pub pixel: (f64, f64),
    /// Whether coordinates are degrees of longitude and latitude.
    pub is_geographic: bool,
    /// Whether a sample stands for a point (a grid node), not for the area of its pixel.
    pub is_point: bool,
}
