//! From a file to rows of heights.
//!
//! A file is read twice where only reading it shows that it is sound: once to decode every row and count the samples
//! without a height, once to deliver. So an [`Import`] that was opened is one whose data were seen whole, and a caller
//! that opens before it changes anything changes nothing on an error.

use std::path::Path;

use crate::error::{Error, Result};
use crate::fill;
use crate::format::{Direction, Format};
use crate::info::RasterInfo;
use crate::options::{ImportOptions, NodataPolicy};
use crate::place::{Place, plain_file};
use crate::read;
use crate::resample::{Plan, Resampled};
use crate::source::{Header, MemoryRows, Patched, RowSource, Source};
use crate::turn::Turn;

/// A file that is being read.
pub struct Import {
    info: RasterInfo,
    rows: Box<dyn RowSource>,
    rows_left: u32,
}

impl std::fmt::Debug for Import {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Import")
            .field("info", &self.info)
            .field("rows_left", &self.rows_left)
            .finish_non_exhaustive()
    }
}

/// Opens a file, checks it, and makes ready to deliver its heights.
///
/// # Errors
///
/// Every [`Error`] that is about reading: a path that is no file, options that do not fit the format, a file that is
/// damaged, too large or of a kind that is not supported, and samples without data under [`NodataPolicy::Refuse`].
pub fn open(path: impl AsRef<Path>, options: &ImportOptions) -> Result<Import> {
    let path = path.as_ref();
    plain_file(path)?;
    let format = match options.format {
        Some(format) => format,
        None => Format::from_path(path, Direction::Import)?,
    };
    options.check(format)?;
    let place = Place { path: path.to_path_buf(), format };

    let source = read::open(&place, options)?;
    let mut header = source.header.clone();
    let plan = Plan::new(&header, options, &place)?;
    let rows = with_heights_everywhere(source, &mut header, options, &place)?;

    header.notices.extend(plan.notice(&header));
    let turn = Turn::of(options);
    let size = [plan.width, plan.depth];
    let [width, depth] = turn.size(size);
    let info = RasterInfo {
        width,
        depth,
        spacing_m: plan.spacing_m,
        notices: header.notices.clone(),
        format,
        sample: header.sample,
        georeference: header.georeference,
    };
    let rows = if plan.is_as_it_is() { rows } else { Box::new(Resampled::new(rows, &header, &plan)) };
    let rows = turn.rows(rows, size, &place);
    Ok(Import { rows_left: info.depth, info, rows })
}

impl Import {
    /// What is delivered.
    pub fn info(&self) -> &RasterInfo {
        &self.info
    }

    /// Reads the next whole rows into `rows`, [`RasterInfo::width`] heights in metres each, the north row first, and
    /// returns how many it read: as many as fit, fewer at the end, 0 after it. Every height is finite and within
    /// ±[`crate::MAX_HEIGHT_M`].
    ///
    /// # Errors
    ///
    /// [`Error::Buffer`] unless `rows` holds whole rows; reading errors, where the file was changed since it was
    /// opened.
    pub fn read_rows(&mut self, rows: &mut [f32]) -> Result<usize> {
        let width = self.info.width as usize;
        if rows.is_empty() || !rows.len().is_multiple_of(width) {
            return Err(Error::Buffer { samples: rows.len(), width: self.info.width });
        }
        let mut num_read = 0;
        for row in rows.chunks_exact_mut(width).take(self.rows_left as usize) {
            self.rows.read_row(row)?;
            self.rows_left -= 1;
            num_read += 1;
        }
        Ok(num_read)
    }
}

/// The rows of `source` under the nodata policy.
fn with_heights_everywhere(
    source: Source,
    header: &mut Header,
    options: &ImportOptions,
    place: &Place,
) -> Result<Box<dyn RowSource>> {
    let patched = |inner, replacement_m| Box::new(Patched { inner, replacement_m, place: place.clone() });
    if !header.needs_scan {
        return Ok(patched(source.rows, None));
    }
    let gaps = scan(source, header)?;
    // The file as it now is must be the one that was scanned.
    let again = read::open(place, options)?;
    if (again.header.width, again.header.depth) != (header.width, header.depth) {
        return Err(Error::Changed { path: place.path.clone() });
    }
    let Some((column, row)) = gaps.first else { return Ok(patched(again.rows, None)) };

    let (count, total) = (gaps.count, u64::from(header.width) * u64::from(header.depth));
    let share = 100.0 * count as f64 / total as f64;
    match options.nodata {
        NodataPolicy::Refuse => Err(Error::Nodata { path: place.path.clone(), count, total, column, row }),
        NodataPolicy::Value(height_m) => {
            header
                .notices
                .push(format!("{count} samples ({share:.1} %) had no data and became {height_m} m"));
            Ok(patched(again.rows, Some(height_m)))
        }
        NodataPolicy::Fill => {
            if count == total {
                return Err(Error::AllNodata { path: place.path.clone() });
            }
            header
                .notices
                .push(format!("{count} samples ({share:.1} %) had no data and were filled from around them"));
            let filled = fill_from(again, count, options, place)?;
            Ok(patched(Box::new(MemoryRows::new(filled)), None))
        }
    }
}

/// The whole raster with its holes filled.
fn fill_from(mut source: Source, count: u64, options: &ImportOptions, place: &Place) -> Result<Vec<f32>> {
    let (width, depth) = (source.header.width as usize, source.header.depth as usize);
    let needed = fill::memory_bytes(width as u64 * depth as u64, count);
    place.check_memory("filling its holes", needed, options.memory_limit_bytes, "give them one height")?;
    let mut heights_m = vec![0.0; width * depth];
    for row in heights_m.chunks_exact_mut(width) {
        source.rows.read_row(row)?;
    }
    fill::fill(&mut heights_m, width);
    Ok(heights_m)
}

/// Samples without a height.
struct Gaps {
    count: u64,
    /// Column and row of the first.
    first: Option<(u32, u32)>,
}

/// Reads every row once and counts the samples without a height.
fn scan(mut source: Source, header: &Header) -> Result<Gaps> {
    let mut gaps = Gaps { count: 0, first: None };
    let mut heights_m = vec![0.0_f32; header.width as usize];
    for row in 0..header.depth {
        source.rows.read_row(&mut heights_m)?;
        for (column, _) in (0_u32..).zip(&heights_m).filter(|(_, height_m)| height_m.is_nan()) {
            gaps.count += 1;
            gaps.first.get_or_insert((column, row));
        }
    }
    Ok(gaps)
}
