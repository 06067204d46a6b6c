//! The formats, and how they are told from a file's name.

use std::fmt;
use std::path::Path;

use crate::error::{Error, Result};

/// A file format: those of heightfields, and one more of the bitmaps of brushes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Format {
    /// Grey PNG of 8 or 16 bits, `.png`.
    Png,
    /// Headless u16 samples, `.r16`, square unless the size is given.
    R16,
    /// Headless samples of any type, `.raw`; size and type must be given.
    Raw,
    /// Headless f32 metres, `.r32`, square unless the size is given.
    R32,
    /// TIFF, BigTIFF and GeoTIFF with one band, `.tif` and `.tiff`.
    Tiff,
    /// SRTM tiles of whole metres, `.hgt`, and inside a zip, `.hgt.zip` or `.zip`, for reading.
    Hgt,
    /// NumPy arrays, `.npy`.
    Npy,
    /// OpenEXR, for bitmaps ([`crate::read_bitmap`]) and not for heights.
    Exr,
}

/// Which way a file goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// From the file.
    Import,
    /// To the file.
    Export,
}

/// How one sample is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SampleType {
    /// Unsigned, 8 bits.
    U8,
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 16 bits.
    I16,
    /// Unsigned, 32 bits.
    U32,
    /// Signed, 32 bits.
    I32,
    /// IEEE 754, 32 bits.
    F32,
    /// IEEE 754, 64 bits.
    F64,
}

/// Which byte of a sample comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ByteOrder {
    /// The least significant.
    Little,
    /// The most significant.
    Big,
}

impl Format {
    /// The format that a file name's ending tells, in capitals or not.
    ///
    /// # Errors
    ///
    /// [`Error::EmptyPath`]; [`Error::UnknownEnding`], which lists the endings known in this direction.
    pub fn from_path(path: &Path, direction: Direction) -> Result<Self> {
        if path.as_os_str().is_empty() {
            return Err(Error::EmptyPath);
        }
        let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
        match (ending.as_deref(), direction) {
            (Some("png"), _) => Ok(Self::Png),
            (Some("r16"), _) => Ok(Self::R16),
            (Some("raw"), _) => Ok(Self::Raw),
            (Some("r32"), _) => Ok(Self::R32),
            (Some("tif" | "tiff"), _) => Ok(Self::Tiff),
            (Some("hgt"), _) | (Some("zip"), Direction::Import) => Ok(Self::Hgt),
            (Some("npy"), _) => Ok(Self::Npy),
            _ => Err(Error::UnknownEnding {
                path: path.to_path_buf(),
                known: match direction {
                    Direction::Import => ".png .r16 .raw .r32 .tif .tiff .hgt .hgt.zip .npy",
                    Direction::Export => ".png .r16 .raw .r32 .tif .tiff .hgt .npy",
                },
            }),
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Png => "PNG",
            Self::R16 => "R16",
            Self::Raw => "RAW",
            Self::R32 => "R32",
            Self::Tiff => "TIFF",
            Self::Hgt => "HGT",
            Self::Npy => "NPY",
            Self::Exr => "EXR",
        })
    }
}

impl SampleType {
    /// Bytes in one sample.
    pub const fn bytes(self) -> u32 {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The greatest sample, where samples are 8 or 16 bits without a sign: those that a range of heights maps to.
    pub const fn range_maximum(self) -> Option<u16> {
        match self {
            Self::U8 => Some(u8::MAX as u16),
            Self::U16 => Some(u16::MAX),
            _ => None,
        }
    }
}

impl fmt::Display for SampleType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::U8 => "u8",
            Self::I8 => "i8",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::U32 => "u32",
            Self::I32 => "i32",
            Self::F32 => "f32",
            Self::F64 => "f64",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_tell_the_format_in_any_case() {
        let import = |name: &str| Format::from_path(Path::new(name), Direction::Import).unwrap();
        assert_eq!(import("a/b.PNG"), Format::Png);
        assert_eq!(import("x.tiff"), Format::Tiff);
        assert_eq!(import("N34W119.hgt.zip"), Format::Hgt);
        assert_eq!(import("N34W119.SRTMGL1.zip"), Format::Hgt);
    }

    #[test]
    fn unknown_endings_list_the_known_ones() {
        for (name, direction) in [
            ("a.exr", Direction::Import),
            ("a", Direction::Export),
            ("a.zip", Direction::Export),
            (".png", Direction::Import),
        ] {
            let message = Format::from_path(Path::new(name), direction).unwrap_err().to_string();
            assert!(message.contains(".tif") && message.contains(".npy"), "{name}: {message}");
        }
        assert!(matches!(Format::from_path(Path::new(""), Direction::Import), Err(Error::EmptyPath)));
    }
}
