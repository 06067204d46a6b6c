//! From rows of heights to a file.
//!
//! Rows go into a temporary file beside the target, which takes the target's name when all is written and synced.
//! Until then, and after any error, what was there before is untouched; an [`Export`] that is dropped leaves nothing.

use std::io;
use std::path::Path;

use tempfile::NamedTempFile;

use crate::error::{Error, Result};
use crate::format::{ByteOrder, Direction, Format, SampleType};
use crate::options::{ExportOptions, MAX_SAMPLES_PER_SIDE};
use crate::place::Place;
use crate::sample::Encoding;
use crate::sidecar::Sidecar;
use crate::write::{self, RowSink, Target};

/// A file that is being written.
pub struct Export {
    target: Target,
    options: ExportOptions,
    // Before the temporary file, so that it has let go of that when it is removed.
    sink: Box<dyn RowSink>,
    temporary: NamedTempFile,
    rows_written: u64,
    /// Lowest and highest height so far, metres.
    heights_m: (f32, f32),
    do_all_fit: bool,
    worst_error_m: f64,
}

/// A file that was written.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Exported {
    /// What was rounded or cannot be told from the file, one sentence each, for people.
    pub notices: Vec<String>,
}

impl std::fmt::Debug for Export {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Export")
            .field("target", &self.target)
            .field("rows_written", &self.rows_written)
            .finish_non_exhaustive()
    }
}

/// Begins to write `depth` rows of `width` heights to `path`.
///
/// # Errors
///
/// [`Error::EmptyPath`], [`Error::NotFound`] if the folder is not there, [`Error::NotAFile`] if something else is at
/// `path`, [`Error::UnknownEnding`], [`Error::Option`] for options that do not fit the format, [`Error::Size`], and
/// [`Error::Io`].
pub fn create(path: impl AsRef<Path>, options: &ExportOptions, width: u32, depth: u32) -> Result<Export> {
    let path = path.as_ref();
    if path.as_os_str().is_empty() {
        return Err(Error::EmptyPath);
    }
    if path.metadata().is_ok_and(|metadata| !metadata.is_file()) {
        return Err(Error::NotAFile { path: path.to_path_buf() });
    }
    let format = match options.format {
        Some(format) => format,
        None => Format::from_path(path, Direction::Export)?,
    };
    let sample = options.check(format)?;
    let place = Place { path: path.to_path_buf(), format };
    place.check_size(u64::from(width), u64::from(depth), MAX_SAMPLES_PER_SIDE)?;
    if format == Format::Hgt && !(width == depth && matches!(width, 1201 | 3601)) {
        let reason = format!("a tile has 1201 x 1201 or 3601 x 3601 samples, not {width} x {depth}");
        return Err(place.unsupported(reason));
    }

    let byte_order = match format {
        Format::Png | Format::Hgt => ByteOrder::Big,
        _ => options.byte_order.unwrap_or(ByteOrder::Little),
    };
    let encoding = Encoding::new(sample, byte_order, options.range_m);
    let target = Target { place, width, depth, sample, encoding, spacing_m: options.spacing_m };
    let temporary = temporary_beside(path)?;
    let file = temporary.as_file().try_clone().map_err(|err| target.place.writing(err))?;
    let sink = write::create(file, &target)?;
    Ok(Export {
        target,
        options: options.clone(),
        temporary,
        sink,
        rows_written: 0,
        heights_m: (f32::INFINITY, f32::NEG_INFINITY),
        do_all_fit: true,
        worst_error_m: 0.0,
    })
}

impl Export {
    /// Writes whole rows of heights in metres, the north row first.
    ///
    /// Heights that the samples cannot hold are told by [`Export::finish`], which by then knows the range to give.
    ///
    /// # Errors
    ///
    /// [`Error::Buffer`] unless `rows` holds whole rows, [`Error::RowCount`] for more rows than the export was made
    /// for, [`Error::NotFinite`], [`Error::Io`]. After an error nothing can be made of the export but to drop it.
    pub fn write_rows(&mut self, rows: &[f32]) -> Result<()> {
        let Target { width, depth, encoding, .. } = self.target;
        if !rows.len().is_multiple_of(width as usize) {
            return Err(Error::Buffer { samples: rows.len(), width });
        }
        for row in rows.chunks_exact(width as usize) {
            if self.rows_written == u64::from(depth) {
                let given = self.rows_written + (rows.len() / width as usize) as u64;
                return Err(self.row_count(given));
            }
            for (column, &height_m) in (0_u32..).zip(row) {
                if !height_m.is_finite() {
                    let row = u32::try_from(self.rows_written).unwrap_or(u32::MAX);
                    return Err(Error::NotFinite { path: self.target.place.path.clone(), column, row });
                }
                self.heights_m = (self.heights_m.0.min(height_m), self.heights_m.1.max(height_m));
                if encoding.fits(height_m) {
                    self.worst_error_m = self.worst_error_m.max(encoding.error_m(height_m));
                } else {
                    self.do_all_fit = false;
                }
            }
            self.sink.write_row(row)?;
            self.rows_written += 1;
        }
        Ok(())
    }

    /// Ends the file, and gives it its name.
    ///
    /// # Errors
    ///
    /// [`Error::RowCount`] if rows are missing, [`Error::HeightsDoNotFit`] with the range to give, [`Error::Io`]. The
    /// target is then as it was before; only if the sidecar's writing fails is the file there without it.
    pub fn finish(self) -> Result<Exported> {
        if self.rows_written != u64::from(self.target.depth) {
            return Err(self.row_count(self.rows_written));
        }
        if !self.do_all_fit {
            return Err(self.does_not_fit());
        }
        let notices = self.notices();
        let Self { target, options, temporary, sink, .. } = self;
        sink.finish()?;
        temporary.as_file().sync_all().map_err(|err| target.place.writing(err))?;
        let path = &target.place.path;
        temporary.persist(path).map_err(|err| Error::Io {
            path: path.clone(),
            doing: "give the written file its name",
            source: err.error,
        })?;
        match options.range_m {
            Some(range_m) => sidecar(&target, &options, range_m).write(path)?,
            None => Sidecar::remove(path)?,
        }
        Ok(Exported { notices })
    }

    fn row_count(&self, actual: u64) -> Error {
        Error::RowCount { path: self.target.place.path.clone(), expected: self.target.depth, actual }
    }

    fn does_not_fit(&self) -> Error {
        let Target { place, sample, encoding, .. } = &self.target;
        let ((min_m, max_m), (low_m, high_m)) = (self.heights_m, encoding.range_m());
        let advice = match (place.format, sample.range_maximum()) {
            (Format::Png | Format::R16 | Format::Raw, Some(_)) => {
                let (low, high) = (min_m.floor(), max_m.ceil());
                format!("give the range {low},{}", if high > low { high } else { low + 1.0 })
            }
            _ => "write .r32, .tif or .npy instead".to_owned(),
        };
        Error::HeightsDoNotFit { path: place.path.clone(), min_m, max_m, low_m, high_m, advice }
    }

    fn notices(&self) -> Vec<String> {
        let Target { place, width, depth, encoding, .. } = &self.target;
        let mut notices = Vec::new();
        if self.worst_error_m > 0.0 {
            notices.push(format!(
                "heights were rounded to steps of {:.6} m, by at most {:.6} m",
                encoding.step_m(),
                self.worst_error_m
            ));
        }
        let is_headless = matches!(place.format, Format::R16 | Format::R32 | Format::Raw);
        if place.format == Format::Raw || (is_headless && width != depth) {
            notices.push(format!("the file does not say its size: a reader must be told {width} x {depth}"));
        }
        if place.format == Format::Hgt {
            notices.push(
                "a reader places the tile by its name, as in N34W119.hgt, and spaces it in arc seconds"
                    .to_owned(),
            );
        }
        notices
    }
}

fn sidecar(target: &Target, options: &ExportOptions, range_m: (f64, f64)) -> Sidecar {
    let is_big = target.place.format == Format::Png || options.byte_order == Some(ByteOrder::Big);
    Sidecar {
        range_m,
        width: target.width,
        depth: target.depth,
        spacing_m: target.spacing_m,
        sample: if target.sample == SampleType::U8 { "u8" } else { "u16" }.to_owned(),
        byte_order: if is_big { "big" } else { "little" }.to_owned(),
    }
}

/// A temporary file in the folder of `path`, with the permissions a new file there would have: to be written, then
/// persisted as `path`, so that a file appears there whole or not at all.
///
/// # Errors
///
/// [`Error::NotFound`] if the folder is not there, [`Error::Io`].
pub fn temporary_beside(path: &Path) -> Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".orogeny-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // The system takes from these what the user's mask says.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder).map_err(|source| match source.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
            Error::NotFound { path: folder.to_path_buf(), what: "folder" }
        }
        _ => Error::Io { path: path.to_path_buf(), doing: "make a temporary file beside it", source },
    })
}
