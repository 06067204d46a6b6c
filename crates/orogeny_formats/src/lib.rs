//! Reading and writing heightfields in other programs' file formats.
//!
//! [`open`] gives an [`Import`], which delivers heights in metres, row by row, the north row first; [`create`] gives
//! an [`Export`], which takes them the same way. Files stream: memory is a few rows or one band of tiles, and the
//! cases that need more (a Fortran-ordered array, an interlaced picture, filled holes) are held to
//! [`ImportOptions::memory_limit_bytes`].
//!
//! What holds for every format:
//!
//! - Row 0 is north, heights are metres, [`f32`].
//! - A sample with no data never becomes a height. It is refused, filled or replaced as [`NodataPolicy`] says.
//! - A raster is turned and mirrored on its way where [`ImportOptions`] say so: rows are those of the turned one.
//! - A raster in degrees or with oblong pixels is resampled to square metres, unless a spacing is given.
//! - Whatever was resampled, rounded, lost or assumed is said in [`RasterInfo::notices`] or [`Exported::notices`].
//! - Declared sizes are checked against limits and against the file's length before anything is allocated.
//! - An export appears under its name whole or not at all.
//!
//! [`read_bitmap`] reads a picture, PNG or OpenEXR, as the alpha bitmap of a brush.
//!
//! This crate knows nothing of terrains, layers or pages; it depends on no other crate of the workspace.
//!
//! ```
//! use orogeny_formats::{ExportOptions, ImportOptions, create, open};
//!
//! # fn main() -> orogeny_formats::Result<()> {
//! # let folder = tempfile::tempdir().map_err(|source| orogeny_formats::Error::Io {
//! #     path: "temporary folder".into(), doing: "make", source })?;
//! let path = folder.path().join("hill.npy");
//! let mut export = create(&path, &ExportOptions::default(), 3, 2)?;
//! export.write_rows(&[0.0, 1.5, 0.0, 0.5, 2.5, 0.5])?;
//! export.finish()?;
//!
//! let mut import = open(&path, &ImportOptions::default())?;
//! assert_eq!((import.info().width, import.info().depth), (3, 2));
//! let mut rows = [0.0; 6];
//! assert_eq!(import.read_rows(&mut rows)?, 2);
//! assert_eq!(rows, [0.0, 1.5, 0.0, 0.5, 2.5, 0.5]);
//! # Ok(())
//! # }
//! ```

mod bitmap;
mod error;
mod export;
mod fill;
mod format;
mod geodesy;
mod import;
mod info;
mod options;
mod place;
mod read;
mod resample;
mod sample;
mod sidecar;
mod source;
mod turn;
mod write;

pub use bitmap::{Bitmap, MAX_BITMAP_SIDE, read_bitmap};
pub use error::{Error, Result};
pub use export::{Export, Exported, create, temporary_beside};
pub use format::{ByteOrder, Direction, Format, SampleType};
pub use geodesy::{metres_per_degree_of_latitude, metres_per_degree_of_longitude};
pub use import::{Import, open};
pub use info::{Georeference, RasterInfo};
pub use options::{ExportOptions, ImportOptions, MAX_HEIGHT_M, MAX_SAMPLES_PER_SIDE, NodataPolicy};
pub use sidecar::Sidecar;
pub use turn::Flip;
