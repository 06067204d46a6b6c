//! What every decoder gives: a header, and rows of heights.

use crate::error::{Error, Result};
use crate::format::SampleType;
use crate::info::Georeference;
use crate::place::Place;

/// A stream of rows, the north row first.
pub(crate) trait RowSource: Send {
    /// Fills `row`, which holds a whole row, with heights in metres; NaN where there is none.
    fn read_row(&mut self, row: &mut [f32]) -> Result<()>;
}

/// An opened file.
pub(crate) struct Source {
    pub header: Header,
    pub rows: Box<dyn RowSource>,
}

/// What a decoder knows before it reads heights.
#[derive(Debug, Clone)]
pub(crate) struct Header {
    pub width: u32,
    pub depth: u32,
    pub sample: SampleType,
    pub spacing: Spacing,
    pub georeference: Option<Georeference>,
    pub notices: Vec<String>,
    /// Whether only reading every row shows that the file is sound and has a height everywhere.
    pub needs_scan: bool,
}

/// How far apart a file says its samples are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Spacing {
    /// It does not say.
    Unknown,
    /// Metres along x and z.
    Metres { x: f64, z: f64 },
    /// Degrees along x and z, and the latitude of the raster's centre.
    Degrees { x: f64, z: f64, latitude: f64 },
    /// In something, but how many metres that is cannot be told.
    Unplaced { what: &'static str, instead: &'static str },
}

/// Rows that are in memory.
pub(crate) struct MemoryRows {
    heights_m: std::vec::IntoIter<f32>,
}

impl MemoryRows {
    pub fn new(heights_m: Vec<f32>) -> Self {
        Self { heights_m: heights_m.into_iter() }
    }
}

impl RowSource for MemoryRows {
    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        for (to, from) in row.iter_mut().zip(&mut self.heights_m) {
            *to = from;
        }
        Ok(())
    }
}

/// Rows whose missing heights are replaced; without a replacement one more missing height than were counted is an
/// error, for then the file is not the one that was scanned.
pub(crate) struct Patched {
    pub inner: Box<dyn RowSource>,
    pub replacement_m: Option<f32>,
    pub place: Place,
}

impl RowSource for Patched {
    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        self.inner.read_row(row)?;
        for height_m in row.iter_mut().filter(|height_m| height_m.is_nan()) {
            *height_m = self.replacement_m.ok_or_else(|| Error::Changed { path: self.place.path.clone() })?;
        }
        Ok(())
    }
}
