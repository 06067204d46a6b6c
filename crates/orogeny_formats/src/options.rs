//! What a caller may say about a file.

use crate::error::{Error, Result};
use crate::format::{ByteOrder, Format, SampleType};
use crate::turn::{Flip, Turn};

/// The greatest magnitude of a height, metres. What lies beyond is no height: Earth's relief is a thousandth of it.
pub const MAX_HEIGHT_M: f32 = 1.0e7;

/// The longest side of a raster, samples.
pub const MAX_SAMPLES_PER_SIDE: u32 = 1 << 20;

/// What becomes of samples that have no usable height: nodata, voids, NaN, infinities, and magnitudes above
/// [`MAX_HEIGHT_M`].
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum NodataPolicy {
    /// The import fails and says how many there are and where the first is.
    #[default]
    Refuse,
    /// Holes are filled smoothly from their surroundings.
    Fill,
    /// Each gets this height, metres.
    Value(f32),
}

/// How to read a file. The default reads what the file says of itself. As JSON it holds what decides about heights, and not
/// the limits of size and memory, which are the reader's own.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImportOptions {
    /// The format; the file's ending tells it if none is given.
    pub format: Option<Format>,
    /// Width and depth in samples, for the headless formats `.raw`, `.r16` and `.r32`.
    pub size: Option<(u32, u32)>,
    /// The sample type, for `.raw`: u8, u16, i16 or f32.
    pub sample: Option<SampleType>,
    /// The byte order of the headless formats; little-endian if none is given.
    pub byte_order: Option<ByteOrder>,
    /// Heights in metres of the sample 0 and of the greatest sample (255 or 65,535), for PNG, `.r16` and unsigned
    /// `.raw`. Without it a sample is a height in metres.
    #[serde(rename = "range")]
    pub range_m: Option<(f64, f64)>,
    /// What becomes of samples with no data.
    pub nodata: NodataPolicy,
    /// Takes the samples as they are, this many metres apart, whatever the file says of its spacing.
    #[serde(rename = "spacing")]
    pub spacing_m: Option<f64>,
    /// Degrees that the raster is turned by, clockwise as it is seen from above: 0, 90, 180 or 270.
    #[serde(rename = "rotate", skip_serializing_if = "is_zero")]
    pub rotate_degrees: u16,
    /// Which of its sides change places, once it is turned.
    #[serde(skip_serializing_if = "Flip::is_none")]
    pub flip: Flip,
    /// The longest side that is accepted, samples; at most [`MAX_SAMPLES_PER_SIDE`].
    #[serde(skip)]
    pub max_samples_per_side: u32,
    /// The most memory that work which cannot stream may hold, bytes: one band of TIFF tiles or one compressed
    /// strip, an interlaced PNG, a Fortran-ordered array, a raster whose holes are filled.
    #[serde(skip)]
    pub memory_limit_bytes: u64,
}

impl Default for ImportOptions {
    fn default() -> Self {
        Self {
            format: None,
            size: None,
            sample: None,
            byte_order: None,
            range_m: None,
            nodata: NodataPolicy::default(),
            spacing_m: None,
            rotate_degrees: 0,
            flip: Flip::None,
            max_samples_per_side: MAX_SAMPLES_PER_SIDE,
            memory_limit_bytes: 1 << 30,
        }
    }
}

/// Whether it is not turned: what does nothing is not written down.
const fn is_zero(degrees: &u16) -> bool {
    *degrees == 0
}

impl ImportOptions {
    /// Where a place of the file comes to lie once it is turned and mirrored; both in shares of the raster's width and depth from its
    /// north-west corner on. So `[0.0, 0.0]` gives the corner that the file begins in.
    #[must_use]
    pub fn turned(&self, place: [f64; 2]) -> [f64; 2] {
        Turn::of(self).place(place)
    }

    /// Refuses options that are out of range or that `format` does not take.
    pub(crate) fn check(&self, format: Format) -> Result<()> {
        check_range(self.range_m)?;
        check_spacing(self.spacing_m)?;
        if !(1..=MAX_SAMPLES_PER_SIDE).contains(&self.max_samples_per_side) {
            let reason = format!("{} is not 1 to {MAX_SAMPLES_PER_SIDE}", self.max_samples_per_side);
            return Err(Error::Option { option: "max_samples_per_side", reason });
        }
        if let NodataPolicy::Value(height_m) = self.nodata
            && (!height_m.is_finite() || height_m.abs() > MAX_HEIGHT_M)
        {
            let reason = format!("{height_m} m is no height: give one within ±{MAX_HEIGHT_M} m");
            return Err(Error::Option { option: "nodata", reason });
        }
        if ![0, 90, 180, 270].contains(&self.rotate_degrees) {
            let reason =
                format!("{} degrees are no quarter turns: give 0, 90, 180 or 270", self.rotate_degrees);
            return Err(Error::Option { option: "rotate_degrees", reason });
        }
        let headless = matches!(format, Format::Raw | Format::R16 | Format::R32);
        let ranged = match format {
            Format::Png | Format::R16 => true,
            Format::Raw => self.sample.is_none_or(|sample| sample.range_maximum().is_some()),
            _ => false,
        };
        let raw_sample = [SampleType::U8, SampleType::U16, SampleType::I16, SampleType::F32]
            .map(Some)
            .contains(&self.sample);
        refuse_unless(self.size.is_none() || headless, "size", format, "it says its size itself")?;
        refuse_unless(
            self.byte_order.is_none() || headless,
            "byte_order",
            format,
            "it says its byte order itself",
        )?;
        refuse_unless(self.range_m.is_none() || ranged, "range_m", format, "its samples are metres already")?;
        refuse_unless(
            self.sample.is_none() || (format == Format::Raw && raw_sample),
            "sample",
            format,
            "only .raw takes one: u8, u16, i16 or f32",
        )
    }
}

/// How to write a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ExportOptions {
    /// The format; the file's ending tells it if none is given.
    pub format: Option<Format>,
    /// How samples are stored: u8 or u16 for PNG; u8, u16, i16 or f32 for `.raw`. If none is given, u16.
    pub sample: Option<SampleType>,
    /// The byte order of the headless formats; little-endian if none is given.
    pub byte_order: Option<ByteOrder>,
    /// Heights in metres that become the sample 0 and the greatest sample (255 or 65,535), for PNG, `.r16` and
    /// unsigned `.raw`. Without it heights are rounded to whole metres.
    pub range_m: Option<(f64, f64)>,
    /// Distance between samples, metres: kept in TIFF and in the sidecar.
    pub spacing_m: Option<f64>,
}

impl ExportOptions {
    /// The sample type that `format` is written with, if these options fit it.
    pub(crate) fn check(&self, format: Format) -> Result<SampleType> {
        check_range(self.range_m)?;
        check_spacing(self.spacing_m)?;
        let (sample, allowed): (SampleType, &[SampleType]) = match format {
            Format::Png => (SampleType::U16, &[SampleType::U8, SampleType::U16]),
            Format::R16 => (SampleType::U16, &[SampleType::U16]),
            Format::Raw => {
                (SampleType::U16, &[SampleType::U8, SampleType::U16, SampleType::I16, SampleType::F32])
            }
            Format::Hgt => (SampleType::I16, &[SampleType::I16]),
            Format::R32 | Format::Tiff | Format::Npy | Format::Exr => (SampleType::F32, &[SampleType::F32]),
        };
        let sample = self.sample.unwrap_or(sample);
        refuse_unless(allowed.contains(&sample), "sample", format, "it cannot hold that sample type")?;
        let headless = matches!(format, Format::Raw | Format::R16 | Format::R32);
        refuse_unless(
            self.byte_order.is_none() || headless,
            "byte_order",
            format,
            "its byte order is fixed",
        )?;
        let ranged =
            matches!(format, Format::Png | Format::R16 | Format::Raw) && sample.range_maximum().is_some();
        refuse_unless(self.range_m.is_none() || ranged, "range_m", format, "its samples are metres")?;
        Ok(sample)
    }
}

fn refuse_unless(fits: bool, option: &'static str, format: Format, why: &str) -> Result<()> {
    if fits {
        return Ok(());
    }
    Err(Error::Option { option, reason: format!("{format} does not take it here: {why}") })
}

fn check_range(range_m: Option<(f64, f64)>) -> Result<()> {
    let limit = f64::from(MAX_HEIGHT_M);
    match range_m {
        Some((low, high)) if !(low < high && low >= -limit && high <= limit) => Err(Error::Option {
            option: "range_m",
            reason: format!(
                "{low} to {high} m is no range: the first must be below the second, both within ±{limit} m"
            ),
        }),
        _ => Ok(()),
    }
}

fn check_spacing(spacing_m: Option<f64>) -> Result<()> {
    match spacing_m {
        Some(spacing) if !(spacing.is_finite() && spacing > 0.0) => Err(Error::Option {
            option: "spacing_m",
            reason: format!("{spacing} m is no distance: give a number above 0"),
        }),
        _ => Ok(()),
    }
}
