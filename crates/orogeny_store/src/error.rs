//! What can go wrong with a terrain file.

use std::path::{Path, PathBuf};

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
    /// The file is truncated or damaged in a place that is no page and no history entry. Restore it from a copy.
    #[error("`{}` is damaged: {detail}; restore it from a copy", path.display())]
    Damaged {
        /// The terrain.
        path: PathBuf,
        /// What was found.
        detail: String,
    },
    /// A page cannot be trusted. The others can; undoing or restoring from a copy may bring it back.
    #[error(
        "the page at column {} row {} of level {} of field {} is damaged: {detail}",
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
    /// Another process, or another part of this one, is writing. Try again when it is done.
    #[error("`{}` is being written by another process: try again when it is done", path.display())]
    Busy {
        /// The terrain.
        path: PathBuf,
    },
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

fn page_suffix(page: Option<&PageKey>) -> String {
    page.map_or_else(String::new, |key| {
        format!(" at column {} row {} of level {} of field {}", key.x, key.z, key.level, key.field.0)
    })
}

impl Error {
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
                ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked => Self::Busy { path },
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
