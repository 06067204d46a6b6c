//! What can go wrong with a terrain file.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use orogeny_field::{FieldId, PageKey};
use rusqlite::ErrorCode;

use crate::{EntryId, format};

/// The result of an operation on a terrain file.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why a terrain file could not be made, opened, read or changed. Unless it says otherwise, the file is as it was.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No path was given. Give one.
    #[error("the path of the terrain is empty: give a file name such as NAME.{}", format::FILE_EXTENSION)]
    EmptyPath,
    /// There is no such file. Check the path, or make the terrain first.
    #[error("there is no terrain `{}`: check the path, or make it first", path.display())]
    Missing {
        /// What was to be opened.
        path: PathBuf,
    },
    /// The path names a folder. Give the file in it.
    #[error("`{}` is a folder, not a terrain file: give the path of a file", path.display())]
    Directory {
        /// What was given.
        path: PathBuf,
    },
    /// A new terrain would replace a file. Choose another name or remove the file.
    #[error("`{}` exists already: choose another name, or remove it first", path.display())]
    Exists {
        /// The file in the way.
        path: PathBuf,
    },
    /// The file is something else. It was not changed.
    #[error("`{}` is not a terrain file: {detail}", path.display())]
    NotATerrain {
        /// What was opened.
        path: PathBuf,
        /// What was found instead.
        detail: String,
    },
    /// A newer version of Orogeny wrote the file. Open it with that; it was not changed.
    #[error(
        "`{}` has format version {version}, this program reads up to {supported}: open it with a newer Orogeny",
        path.display()
    )]
    NewerVersion {
        /// What was opened.
        path: PathBuf,
        /// The version found.
        version: i32,
        /// [`format::FORMAT_VERSION`].
        supported: i32,
    },
    /// An older version of Orogeny wrote the file, and it was opened for reading only. Open it for writing once: that brings
    /// it up to date.
    #[error(
        "`{}` has format version {version}, this is {current}: open it for writing once, which brings it up to date",
        path.display()
    )]
    OlderVersion {
        /// What was opened.
        path: PathBuf,
        /// The version found.
        version: i32,
        /// [`format::FORMAT_VERSION`].
        current: i32,
    },
    /// The terrain is older than what was last acknowledged: its log lost its end, or the file was replaced by an older
    /// copy. What is there is whole. `check --repair` goes on with it.
    #[error(
        "`{}` lost its last {} commits: it stands at commit {found}, commit {acknowledged} was on disk. Its log is \
         damaged or missing, or the file was replaced by an older copy. What is there is whole: \
         `check --repair` goes on from there, `salvage` copies it",
        path.display(), acknowledged.saturating_sub(*found).max(1)
    )]
    LostCommits {
        /// The terrain.
        path: PathBuf,
        /// The last commit found.
        found: u64,
        /// The last commit that was acknowledged.
        acknowledged: u64,
    },
    /// The file is truncated or damaged in a place that is no page and no history entry. Restore it from a copy.
    #[error("`{}` is damaged: {detail}; restore it from a copy", path.display())]
    Damaged {
        /// The terrain.
        path: PathBuf,
        /// What was found.
        detail: String,
    },
    /// A page cannot be trusted. The others can. `check --repair` makes it again from the history, where that has it.
    #[error(
        "the page at column {} row {} of level {} of field {} is damaged: {detail}; `check --repair` may bring it back",
        key.x, key.z, key.level, key.field.0
    )]
    DamagedPage {
        /// Which page.
        key: PageKey,
        /// What was found.
        detail: String,
    },
    /// An entry of the history cannot be undone or redone. The terrain as it stands is not concerned.
    #[error("entry {entry} of the history is damaged{}: {detail}", page_suffix(page.as_ref()))]
    DamagedHistory {
        /// Which entry.
        entry: EntryId,
        /// The page whose delta is damaged; `None` when it is the entry itself.
        page: Option<PageKey>,
        /// What was found.
        detail: String,
    },
    /// The file, or the folder that must hold its log, may not be written. Change the permissions or copy the file.
    #[error(
        "`{}` cannot be written: the file or its folder is read-only or belongs to someone else ({detail})",
        path.display()
    )]
    ReadOnly {
        /// The terrain.
        path: PathBuf,
        /// What the system said.
        detail: String,
    },
    /// No space is left. Free some and try again: nothing was changed.
    #[error("no space is left for `{}`: free some and try again, the terrain is as it was", path.display())]
    DiskFull {
        /// The terrain.
        path: PathBuf,
    },
    /// Another process, or another part of this one, has it open for writing. Try again when it is done; reading is
    /// possible meanwhile.
    #[error(
        "`{}` is open for writing in {}: close it there, or open it for reading",
        path.display(), holder.as_ref().map_or_else(|| "another process".to_owned(), ToString::to_string)
    )]
    Busy {
        /// The terrain.
        path: PathBuf,
        /// Who has it, where that is known.
        holder: Option<Holder>,
    },
    /// The terrain was opened for reading.
    #[error("`{}` was opened for reading: open it for writing to change it", path.display())]
    OpenedToRead {
        /// The terrain.
        path: PathBuf,
    },
    /// The disk failed in mid-commit, so that what it holds is not known until it is read again. Nothing more is written.
    /// Open the terrain again.
    #[error(
        "`{}` is not written to any more, since its disk failed ({detail}): open it again, what was acknowledged is there",
        path.display()
    )]
    DiskFailed {
        /// The terrain.
        path: PathBuf,
        /// What the system said.
        detail: String,
    },
    /// There is no such entry in the history: it never was, or was dropped.
    #[error("the history has no entry {entry}: `log` lists those there are")]
    UnknownEntry {
        /// Which.
        entry: EntryId,
    },
    /// There is no such data from outside.
    #[error("the terrain does not hold the data {hash}")]
    UnknownBlob {
        /// Its blake3 hash, in hexadecimal digits.
        hash: String,
    },
    /// Data from outside could not be read in, or what the terrain holds of it is damaged.
    #[error("the data {hash} cannot be used: {detail}")]
    Blob {
        /// Its blake3 hash, in hexadecimal digits; empty where it is not known yet.
        hash: String,
        /// Why.
        detail: String,
    },
    /// The thread that makes operations durable is gone.
    #[error(
        "the thread that writes the terrain ended unexpectedly: open the terrain again, what was acknowledged is there"
    )]
    WriterGone,
    /// The system could not read or write.
    #[error("reading or writing `{}` failed: {detail}", path.display())]
    Io {
        /// The terrain.
        path: PathBuf,
        /// What the system said.
        detail: String,
    },
    /// Anything else that SQLite reports.
    #[error("the database of `{}` failed: {source}", path.display())]
    Database {
        /// The terrain.
        path: PathBuf,
        /// What SQLite said.
        source: rusqlite::Error,
    },
    /// A page could not be compressed, which happens only when memory runs out.
    #[error("a page could not be compressed: {source}")]
    Compression {
        /// What zstd said.
        source: std::io::Error,
    },
    /// A page holds a height that must not be stored: NaN, infinite or beyond ±1e7 m. Nothing was written.
    #[error(
        "the height {height_m} at sample ({x}, {z}) of the page at column {} row {} of field {} cannot be stored: \
         heights are finite and within ±{limit_m} m",
        key.x, key.z, key.field.0
    )]
    Height {
        /// Which page.
        key: PageKey,
        /// Column in the page.
        x: usize,
        /// Row in the page.
        z: usize,
        /// The height, in metres.
        height_m: f32,
        /// [`orogeny_field::MAX_HEIGHT_M`].
        limit_m: f32,
    },
    /// A page that the terrain does not have.
    #[error(
        "the page at column {} row {} of level {} lies outside the terrain: that level has {columns} x {rows} pages",
        key.x, key.z, key.level
    )]
    PageOutside {
        /// Which page.
        key: PageKey,
        /// Columns of pages at that level, 0 where there is no such level.
        columns: u32,
        /// Rows of pages at that level.
        rows: u32,
    },
    /// A page of a coarser level, which is made of those below. Write those.
    #[error(
        "the page at column {} row {} of level {} cannot be written: it is made of level 0, write that",
        key.x, key.z, key.level
    )]
    DerivedPage {
        /// Which page.
        key: PageKey,
    },
    /// A page of another size than the terrain's.
    #[error(
        "a page of {actual} x {actual} samples was given to a terrain with pages of {expected} x {expected}"
    )]
    PageSize {
        /// Samples a side of the terrain's pages.
        expected: u32,
        /// Samples a side of the given one.
        actual: u32,
    },
    /// One page was given twice in one call. Give each once.
    #[error("the page at column {} row {} of field {} was given twice: give it once", key.x, key.z, key.field.0)]
    PageTwice {
        /// Which page.
        key: PageKey,
    },
    /// A field that the terrain does not have.
    #[error("there is no field {}: layers name the fields there are", field.0)]
    UnknownField {
        /// Which.
        field: FieldId,
    },
    /// A layer that the terrain does not have.
    #[error("there is no layer {layer}")]
    UnknownLayer {
        /// Its id.
        layer: u32,
    },
    /// A layer name that is empty or too long.
    #[error("a layer name of {length} bytes cannot be used: give 1 to {limit} bytes")]
    LayerName {
        /// How long it is.
        length: usize,
        /// [`crate::MAX_LAYER_NAME_BYTES`].
        limit: usize,
    },
    /// An operation that is no JSON, or more than the history holds.
    #[error("the operation cannot be recorded: {detail}")]
    Operation {
        /// What is wrong with it.
        detail: String,
    },
    /// The history has given out its last number.
    #[error("the terrain has used up its {limit} {what} numbers: export it into a new one")]
    NumbersUsedUp {
        /// Numbers of what.
        what: &'static str,
        /// How many there were.
        limit: u32,
    },
    /// Something in this transaction failed before, so it can only be dropped.
    #[error("the transaction failed before and cannot be committed: drop it and do its work again")]
    TransactionFailed,
    /// A value that no terrain holds.
    #[error(transparent)]
    Value(#[from] orogeny_field::Error),
}

/// Who has a terrain open for writing.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Holder {
    /// Its process number.
    pub process: u32,
    /// The program, as far as it is known.
    pub program: String,
    /// The machine, as far as it is known.
    pub machine: String,
    /// Since when, in milliseconds since 1970.
    pub since_unix_ms: i64,
}

impl Holder {
    pub(crate) fn this_process() -> Self {
        let program = std::env::current_exe().ok();
        let program = program.as_deref().and_then(Path::file_name).unwrap_or_default();
        // Where the kernel tells it; elsewhere the shell may.
        let machine = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
        let machine = machine.or_else(|| std::env::var("COMPUTERNAME").ok()).unwrap_or_default();
        Self {
            process: std::process::id(),
            program: program.to_string_lossy().into_owned(),
            machine: machine.trim().to_owned(),
            since_unix_ms: unix_ms(SystemTime::now()),
        }
    }
}

impl std::fmt::Display for Holder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "process {}", self.process)?;
        if !self.program.is_empty() {
            write!(f, " (`{}`)", self.program)?;
        }
        if !self.machine.is_empty() {
            write!(f, " on {}", self.machine)?;
        }
        Ok(())
    }
}

/// Milliseconds since 1970; 0 for a clock set before that. For people to read: nothing is ordered by it.
pub(crate) fn unix_ms(time: SystemTime) -> i64 {
    let since_1970 = time.duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since_1970.as_millis()).unwrap_or(i64::MAX)
}

fn page_suffix(page: Option<&PageKey>) -> String {
    page.map_or_else(String::new, |key| {
        format!(" at column {} row {} of level {} of field {}", key.x, key.z, key.level, key.field.0)
    })
}

impl Error {
    /// Whether what was asked for is to blame, and not the file or the machine.
    #[must_use]
    pub const fn is_refusal(&self) -> bool {
        matches!(
            self,
            Self::UnknownEntry { .. }
                | Self::UnknownBlob { .. }
                | Self::Blob { .. }
                | Self::Height { .. }
                | Self::UnknownLayer { .. }
                | Self::LayerName { .. }
                | Self::Operation { .. }
                | Self::Value(_)
        )
    }

    pub(crate) fn damaged(path: &Path, detail: impl Into<String>) -> Self {
        Self::Damaged { path: path.to_owned(), detail: detail.into() }
    }

    pub(crate) fn damaged_page(key: PageKey, detail: impl Into<String>) -> Self {
        Self::DamagedPage { key, detail: detail.into() }
    }

    /// What an error of the system means for a terrain file.
    pub(crate) fn from_io(path: &Path, err: &std::io::Error) -> Self {
        use std::io::ErrorKind;
        let path = path.to_owned();
        match err.kind() {
            ErrorKind::NotFound => Self::Missing { path },
            ErrorKind::AlreadyExists => Self::Exists { path },
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
                Self::ReadOnly { path, detail: err.to_string() }
            }
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Self::DiskFull { path },
            _ => Self::Io { path, detail: err.to_string() },
        }
    }

    /// What an error of SQLite means for a terrain file.
    pub(crate) fn from_sqlite(path: &Path, err: rusqlite::Error) -> Self {
        let path = path.to_owned();
        let detail = err.to_string();
        match &err {
            rusqlite::Error::SqliteFailure(failure, _) => match failure.code {
                ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked => Self::Busy { path, holder: None },
                ErrorCode::DiskFull => Self::DiskFull { path },
                // The log's index could not be made longer, which is always for want of space.
                ErrorCode::SystemIoFailure
                    if failure.extended_code == rusqlite::ffi::SQLITE_IOERR_SHMSIZE =>
                {
                    Self::DiskFull { path }
                }
                ErrorCode::SystemIoFailure => Self::Io { path, detail },
                ErrorCode::ReadOnly | ErrorCode::CannotOpen | ErrorCode::PermissionDenied => {
                    Self::ReadOnly { path, detail }
                }
                // A table or column is not there, or rows contradict each other.
                ErrorCode::DatabaseCorrupt
                | ErrorCode::NotADatabase
                | ErrorCode::Unknown
                | ErrorCode::ConstraintViolation
                | ErrorCode::TypeMismatch => Self::Damaged { path, detail },
                _ => Self::Database { path, source: err },
            },
            // The schema is not ours, a row is missing, or its values are not what the schema says.
            rusqlite::Error::SqlInputError { .. }
            | rusqlite::Error::QueryReturnedNoRows
            | rusqlite::Error::FromSqlConversionFailure(..)
            | rusqlite::Error::IntegralValueOutOfRange(..)
            | rusqlite::Error::InvalidColumnType(..)
            | rusqlite::Error::Utf8Error(..) => Self::Damaged { path, detail },
            _ => Self::Database { path, source: err },
        }
    }
}
