//! What can go wrong between a file and a heightfield.

use std::io;
use std::path::PathBuf;

use crate::format::Format;

/// The result of reading or writing a raster.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A raster that cannot be read or written, with what to do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A path of no characters.
    #[error("the path is empty: give the name of a file")]
    EmptyPath,
    /// Nothing is there, or an export's folder is not. Check the path.
    #[error("{path}: there is no such {what}", path = path.display())]
    NotFound {
        /// The path that was looked for.
        path: PathBuf,
        /// `file` or `folder`.
        what: &'static str,
    },
    /// A folder, a device or another thing that is not a plain file.
    #[error("{path} is not a file: give the name of a file", path = path.display())]
    NotAFile {
        /// The path given.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("{path}: could not {doing}: {source}", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
        /// The system's reason.
        #[source]
        source: io::Error,
    },
    /// A file name that tells no format. Rename the file or name the format.
    #[error("{path}: the ending tells no format; known are {known}", path = path.display())]
    UnknownEnding {
        /// The path given.
        path: PathBuf,
        /// The endings that are known in this direction.
        known: &'static str,
    },
    /// A file whose first bytes tell no format. Convert it.
    #[error("{path}: it is no picture that is read here; {known} are", path = path.display())]
    UnknownContent {
        /// The file.
        path: PathBuf,
        /// The formats that are known.
        known: &'static str,
    },
    /// A headless file whose size does not follow from its length. Give the size.
    #[error(
        "{path}: {bytes} bytes of {sample_bytes}-byte samples are no square, so the size cannot be told: \
         give width and depth",
        path = path.display()
    )]
    SizeNeeded {
        /// The file.
        path: PathBuf,
        /// Its length.
        bytes: u64,
        /// Bytes in one sample.
        sample_bytes: u32,
    },
    /// A format that says nothing of itself, without the options that do.
    #[error("{path}: nothing is guessed from a .raw file of {bytes} bytes: give {missing}", path = path.display())]
    RawNeeds {
        /// The file.
        path: PathBuf,
        /// Its length.
        bytes: u64,
        /// The options that are missing.
        missing: &'static str,
    },
    /// A file whose length is not what its size and sample type make.
    #[error("{path}: {expected} bytes are needed for its size and sample type, the file has {actual}", path = path.display())]
    WrongLength {
        /// The file.
        path: PathBuf,
        /// Bytes that width, depth and sample type make.
        expected: u64,
        /// Bytes there are.
        actual: u64,
    },
    /// A file that ends too early. Get it again.
    #[error("{path}: the {format} file ends too early: it is cut off or damaged", path = path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// What it was read as.
        format: Format,
    },
    /// A file that breaks the rules of its format.
    #[error("{path}: not a sound {format} file: {reason}", path = path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What it was read as.
        format: Format,
        /// What is wrong with it.
        reason: String,
    },
    /// A sound file of a kind that is not read here. Convert it.
    #[error("{path}: this kind of {format} file is not supported: {reason}", path = path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What it was read as.
        format: Format,
        /// What is not supported, and what is.
        reason: String,
    },
    /// A raster with no samples, or with too many. Cut it or raise the limit.
    #[error("{path}: {width} x {depth} samples cannot be used: each side takes 1 to {limit}", path = path.display())]
    Size {
        /// The file.
        path: PathBuf,
        /// Samples from west to east.
        width: u64,
        /// Samples from north to south.
        depth: u64,
        /// The longest side.
        limit: u32,
    },
    /// Work that cannot stream and would need too much memory. Raise the limit or convert the file.
    #[error(
        "{path}: {what} needs {needed} bytes of memory, the limit is {limit}: raise it, or {instead}",
        path = path.display()
    )]
    Memory {
        /// The file.
        path: PathBuf,
        /// What cannot stream.
        what: &'static str,
        /// Bytes it would hold.
        needed: u64,
        /// [`crate::ImportOptions::memory_limit_bytes`].
        limit: u64,
        /// The other way out.
        instead: &'static str,
    },
    /// Samples without data. Fill them, give them a height, or repair the file.
    #[error(
        "{path}: {count} of {total} samples have no usable height, the first at column {column}, row {row}: \
         fill them (nodata `fill`) or give them a height",
        path = path.display()
    )]
    Nodata {
        /// The file.
        path: PathBuf,
        /// How many have none: nodata, NaN, infinite, or beyond [`crate::MAX_HEIGHT_M`].
        count: u64,
        /// How many samples there are.
        total: u64,
        /// Column of the first, from 0 in the west.
        column: u32,
        /// Row of the first, from 0 in the north.
        row: u32,
    },
    /// A raster with no data at all: there is nothing to fill from.
    #[error("{path}: none of its samples has a height: there is nothing to fill from", path = path.display())]
    AllNodata {
        /// The file.
        path: PathBuf,
    },
    /// A file that was changed by another program while it was read. Try again.
    #[error("{path} changed while it was read: try again when nothing writes to it", path = path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// A raster in degrees that does not say where on Earth it is.
    #[error(
        "{path}: its samples are {what}, but where it lies is not known, so their spacing in metres is not either: \
         {instead}",
        path = path.display()
    )]
    LocationNeeded {
        /// The file.
        path: PathBuf,
        /// What the samples are spaced by.
        what: &'static str,
        /// What to do.
        instead: &'static str,
    },
    /// An option outside its range, or one that this format does not take.
    #[error("the option `{option}` cannot be used: {reason}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The value, the limit and what to give.
        reason: String,
    },
    /// Values that do not make a bitmap.
    #[error("a bitmap of {width} x {height} cannot be made: {reason}")]
    Bitmap {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// What is wrong, and the limit.
        reason: String,
    },
    /// A buffer that does not hold whole rows.
    #[error("a buffer of {samples} heights cannot be used: give one or more whole rows of {width}")]
    Buffer {
        /// Heights it holds.
        samples: usize,
        /// Heights in a row.
        width: u32,
    },
    /// Heights that the file's samples cannot hold. Nothing was written; export again with the range named.
    #[error(
        "{path}: heights from {min_m} to {max_m} m do not fit samples for {low_m} to {high_m} m: \
         {advice}",
        path = path.display()
    )]
    HeightsDoNotFit {
        /// The file that was to be written.
        path: PathBuf,
        /// Lowest height, metres.
        min_m: f32,
        /// Highest height, metres.
        max_m: f32,
        /// Lowest height that fits, metres.
        low_m: f64,
        /// Highest height that fits, metres.
        high_m: f64,
        /// The range to give, or the format to use.
        advice: String,
    },
    /// A height to export that is NaN or infinite. Nothing was written.
    #[error("{path}: the height at column {column}, row {row} is not finite and cannot be written", path = path.display())]
    NotFinite {
        /// The file that was to be written.
        path: PathBuf,
        /// Its column, from 0 in the west.
        column: u32,
        /// Its row, from 0 in the north.
        row: u32,
    },
    /// An export that was given too many rows, or finished with too few. Nothing was written.
    #[error("{path}: {expected} rows were to be written, {actual} were given", path = path.display())]
    RowCount {
        /// The file that was to be written.
        path: PathBuf,
        /// Rows the export was made for.
        expected: u32,
        /// Rows it got.
        actual: u64,
    },
}
