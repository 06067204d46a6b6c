//! The SQLite connection: opening it safely, transactions, and what its errors mean.
//!
//! Nothing here opens the file beside SQLite: closing such a handle would drop the locks that SQLite holds on it for
//! the whole process.

use std::cell::{Cell, RefCell};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rusqlite::config::DbConfig;
use rusqlite::{CachedStatement, Connection, OpenFlags};

use crate::cache::PageCache;
use crate::pace::Pace;
use crate::{Error, Result, format};

/// An open terrain file.
pub(crate) struct Database {
    pub(crate) conn: Connection,
    path: PathBuf,
    pub(crate) counters: Counting,
    /// Pages as they are, decoded. Only a writer keeps any: to a reader they may change at any time.
    pub(crate) cache: RefCell<PageCache>,
    is_writer: bool,
    /// Whether what is read is another state than the file's: see [`format::PAST_TABLES`].
    is_past: Cell<bool>,
    /// Asked before each page that is coded or written.
    pub(crate) pace: Arc<Pace>,
}

/// What a store has asked of its database since it was opened.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counters {
    /// Statements run.
    pub num_queries: u64,
    /// Pages and deltas read, coded.
    pub num_pages_read: u64,
    /// Pages and deltas written, coded.
    pub num_pages_written: u64,
    /// Their bytes.
    pub bytes_read: u64,
    /// Their bytes.
    pub bytes_written: u64,
}

#[derive(Debug, Default)]
pub(crate) struct Counting(Cell<Counters>);

impl Counting {
    pub(crate) fn get(&self) -> Counters {
        self.0.get()
    }

    pub(crate) fn add(&self, change: impl FnOnce(&mut Counters)) {
        let mut counters = self.0.get();
        change(&mut counters);
        self.0.set(counters);
    }

    pub(crate) fn read(&self, bytes: &[u8]) {
        self.add(|counters| {
            counters.num_pages_read += 1;
            counters.bytes_read += bytes.len() as u64;
        });
    }

    pub(crate) fn wrote(&self, bytes: &[u8]) {
        self.add(|counters| {
            counters.num_pages_written += 1;
            counters.bytes_written += bytes.len() as u64;
        });
    }
}

impl Database {
    /// Makes a new, empty file with the schema in it, and calls `fill` to write the first rows, all in one
    /// transaction. When anything fails nothing is left behind.
    pub(crate) fn create(path: &Path, fill: impl FnOnce(&Self) -> Result<()>) -> Result<Self> {
        let path = absolute(path)?;
        // Reserves the name, so that a file that comes into being meanwhile is never overwritten.
        match std::fs::OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(_) => {}
            Err(_) if path.is_dir() => return Err(Error::Directory { path }),
            Err(err) if err.kind() == std::io::ErrorKind::NotFound => {
                let detail = "its folder does not exist: make it first".to_owned();
                return Err(Error::Io { path, detail });
            }
            Err(err) => return Err(Error::from_io(&path, &err)),
        }
        Self::fill_new_file(&path, fill).inspect_err(|_| {
            // The first error is the one to report.
            std::fs::remove_file(&path).ok();
            for suffix in format::COMPANION_SUFFIXES {
                std::fs::remove_file(companion(&path, suffix)).ok();
            }
        })
    }

    fn fill_new_file(path: &Path, fill: impl FnOnce(&Self) -> Result<()>) -> Result<Self> {
        let mut db = Self::connect(path)?;
        db.run(format::NEW_FILE_SETTINGS)?;
        db.configure()?;
        db.in_transaction(|| {
            db.run(format::SCHEMA)?;
            db.run(&format!(
                "PRAGMA application_id = {}; PRAGMA user_version = {};",
                format::APPLICATION_ID,
                format::FORMAT_VERSION
            ))?;
            fill(&db)
        })?;
        db.checkpoint()?;
        Ok(db)
    }

    /// Opens a file for writing, after looking at its magic and version, which it gives too. A file that is refused is not
    /// changed. Who may write is for [`crate::head`] to say, before [`Self::configure`].
    pub(crate) fn open_to_write(path: &Path) -> Result<(Self, i32)> {
        let path = existing_file(path)?;
        let db = Self::connect(&path)?;
        let version = db.refuse_foreign_files()?;
        // SQLite opens a file that it may not write for reading, without a word.
        if db.conn.is_readonly("main").map_err(|err| db.fault(err))? {
            let detail = "the file is read-only".to_owned();
            return Err(Error::ReadOnly { path: db.path, detail });
        }
        Ok((db, version))
    }

    /// Opens a file for reading, beside a writer or not. Nothing of it is changed, not even a log that was left behind.
    pub(crate) fn open_to_read(path: &Path) -> Result<Self> {
        let path = existing_file(path)?;
        let open = |db: Self| {
            let version = db.refuse_foreign_files()?;
            if version < format::FORMAT_VERSION {
                return Err(Error::OlderVersion { path: db.path, version, current: format::FORMAT_VERSION });
            }
            db.harden()?;
            db.run(format::CONNECTION_SETTINGS)?;
            db.run("PRAGMA query_only = ON")?;
            Ok(db)
        };
        // Where there was a log, it stays for the next writer to take up; where there is none, closing removes the empty
        // one that reading makes.
        let has_log = has_log(&path);
        match Self::connect(&path).and_then(open) {
            Ok(db) => {
                if has_log {
                    db.keep_log()?;
                }
                Ok(db)
            }
            // In a folder where no log can be made, and where there is none, the file cannot change either.
            Err(Error::ReadOnly { .. }) if !has_log => Self::connect_unchanging(&path).and_then(open),
            Err(err) => Err(err),
        }
    }

    fn connect(path: &Path) -> Result<Self> {
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let conn = Connection::open_with_flags(path, flags).map_err(|err| Error::from_sqlite(path, err))?;
        Self::new(conn, path)
    }

    fn connect_unchanging(path: &Path) -> Result<Self> {
        let flags =
            OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
        let uri = format!("file:{}?immutable=1", percent_encoded(path));
        let conn = Connection::open_with_flags(uri, flags).map_err(|err| Error::from_sqlite(path, err))?;
        Self::new(conn, path)
    }

    fn new(conn: Connection, path: &Path) -> Result<Self> {
        let (counters, cache) = (Counting::default(), RefCell::default());
        let (is_past, pace) = (Cell::new(false), Arc::default());
        let db = Self { conn, path: path.to_owned(), counters, cache, is_writer: false, is_past, pace };
        db.conn.busy_timeout(format::BUSY_TIMEOUT).map_err(|err| db.fault(err))?;
        db.conn.set_prepared_statement_cache_capacity(64);
        Ok(db)
    }

    /// Whether decoded pages may be kept: no one else changes them.
    pub(crate) const fn remembers_pages(&self) -> bool {
        self.is_writer
    }

    /// A statement, prepared once and counted each time.
    pub(crate) fn statement(&self, sql: &str) -> rusqlite::Result<CachedStatement<'_>> {
        self.counters.add(|counters| counters.num_queries += 1);
        self.conn.prepare_cached(sql)
    }

    fn refuse_foreign_files(&self) -> Result<i32> {
        let not_a_terrain = |detail: String| Error::NotATerrain { path: self.path.clone(), detail };
        // Otherwise closing would move a log that belongs to someone else into their file. Where there is none, closing
        // must remove the empty one that looking makes.
        self.set_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, has_log(&self.path))?;
        let application_id = self.setting("application_id").map_err(|err| match err {
            rusqlite::Error::SqliteFailure(failure, _)
                if failure.code == rusqlite::ErrorCode::NotADatabase =>
            {
                not_a_terrain("it is no SQLite database, or its first bytes are damaged".to_owned())
            }
            err => self.fault(err),
        })?;
        if application_id != format::APPLICATION_ID {
            return Err(not_a_terrain(format!(
                "it is empty or belongs to another program (application id {application_id:#010x}, \
                 a terrain has {:#010x})",
                format::APPLICATION_ID
            )));
        }
        let version = self.setting("user_version").map_err(|err| self.fault(err))?;
        if version > format::FORMAT_VERSION {
            return Err(Error::NewerVersion {
                path: self.path.clone(),
                version,
                supported: format::FORMAT_VERSION,
            });
        }
        if version < 1 {
            return Err(Error::damaged(&self.path, format!("format version {version} never existed")));
        }
        self.set_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, false)?;
        Ok(version)
    }

    /// What a file from anywhere may not do to us.
    fn harden(&self) -> Result<()> {
        self.set_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true)?;
        self.set_config(DbConfig::SQLITE_DBCONFIG_ENABLE_TRIGGER, false)?;
        self.set_config(DbConfig::SQLITE_DBCONFIG_ENABLE_VIEW, false)
    }

    /// Makes the connection one that writes durably. There is no other one that writes: [`crate::head`] sees to it.
    pub(crate) fn configure(&mut self) -> Result<()> {
        self.is_writer = true;
        self.harden()?;
        self.run(format::CONNECTION_SETTINGS)?;
        let mode: String = self
            .conn
            .query_row("PRAGMA journal_mode = WAL", [], |row| row.get(0))
            .map_err(|err| self.fault(err))?;
        if mode != "wal" {
            let detail = format!("its file system does not allow a write-ahead log (journal mode {mode})");
            return Err(Error::Io { path: self.path.clone(), detail });
        }
        Ok(())
    }

    /// Where the file is, absolute: SQLite gives relative names such as `:memory:` or `file:` a meaning of their own.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// What an error of SQLite means here.
    pub(crate) fn fault(&self, err: rusqlite::Error) -> Error {
        Error::from_sqlite(&self.path, err)
    }

    /// Starts a transaction that may write, waiting for another writer up to [`format::BUSY_TIMEOUT`].
    pub(crate) fn begin(&self) -> Result<()> {
        self.run("BEGIN IMMEDIATE")
    }

    /// Makes the transaction durable: when this returns, its pages are on disk.
    pub(crate) fn commit(&self) -> Result<()> {
        self.run("COMMIT")
    }

    /// Ends a transaction without a trace. SQLite has ended it already after some errors; an error of its own leaves
    /// nothing to do, since what is not committed is never read.
    pub(crate) fn rollback(&self) {
        if !self.conn.is_autocommit() {
            self.run("ROLLBACK").ok();
        }
        // What it holds may come from what was taken back.
        self.cache.borrow_mut().clear();
    }

    /// Runs `work` in a transaction of its own: all of it becomes durable, or nothing.
    pub(crate) fn in_transaction<T>(&self, work: impl FnOnce() -> Result<T>) -> Result<T> {
        self.begin()?;
        let result = work().and_then(|value| self.commit().map(|()| value));
        if result.is_err() {
            self.rollback();
        }
        result
    }

    /// Reads the state that the file has now, and no other, until this is called again or the connection is closed.
    pub(crate) fn hold(&self) -> Result<()> {
        if !self.conn.is_autocommit() {
            self.run("ROLLBACK")?;
        }
        // What was another state went with the transaction.
        self.is_past.set(false);
        self.cache.borrow_mut().clear();
        // It begins with the first thing that is read.
        self.run("BEGIN DEFERRED")
    }

    /// Runs `work`, which may change what this connection reads, and nothing of the file: only in a state that is [held](Self::hold),
    /// which is then another one until it is held anew.
    pub(crate) fn in_past<T>(&self, work: impl FnOnce() -> Result<T>) -> Result<T> {
        self.run("PRAGMA query_only = OFF")?;
        self.is_past.set(true);
        let result = self.run(format::PAST_TABLES).and_then(|()| work());
        self.run("PRAGMA query_only = ON")?;
        result
    }

    /// Whether what is read is another state than the file's.
    pub(crate) const fn is_past(&self) -> bool {
        self.is_past.get()
    }

    /// Runs `work` over one unchanging state of the file.
    pub(crate) fn in_snapshot<T>(&self, work: impl FnOnce() -> Result<T>) -> Result<T> {
        let _snapshot = Snapshot::new(self)?;
        work()
    }

    /// Rewrites the file without what is free in it.
    pub(crate) fn vacuum(&self) -> Result<()> {
        self.run("VACUUM")
    }

    /// Leaves the log where it is when the file is closed: for a disk that cannot be trusted to take what is in it.
    pub(crate) fn keep_log(&self) -> Result<()> {
        self.set_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, true)
    }

    /// Moves the log into the file itself.
    pub(crate) fn checkpoint(&self) -> Result<()> {
        self.conn.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(())).map_err(|err| self.fault(err))
    }

    /// Checkpoints and closes; SQLite removes the log when no other connection is left.
    pub(crate) fn close(self) -> Result<()> {
        // No one is waited for: what a reader still needs of the log stays beside the file.
        self.conn.busy_timeout(std::time::Duration::ZERO).map_err(|err| self.fault(err))?;
        let checkpointed = self.checkpoint();
        let Self { conn, path, .. } = self;
        let closed = conn.close().map_err(|(_, err)| Error::from_sqlite(&path, err));
        checkpointed.and(closed)
    }

    /// Bytes of the file and of its log.
    pub(crate) fn file_size_in_bytes(&self) -> Result<u64> {
        let size = |path: &Path| match std::fs::metadata(path) {
            Ok(metadata) => Ok(metadata.len()),
            Err(err) if err.kind() == std::io::ErrorKind::NotFound => Ok(0),
            Err(err) => Err(Error::from_io(path, &err)),
        };
        Ok(size(&self.path)? + size(&companion(&self.path, "-wal"))?)
    }

    pub(crate) fn run(&self, sql: &str) -> Result<()> {
        self.counters.add(|counters| counters.num_queries += 1);
        self.conn.execute_batch(sql).map_err(|err| self.fault(err))
    }

    fn set_config(&self, config: DbConfig, value: bool) -> Result<()> {
        self.conn.set_db_config(config, value).map(|_| ()).map_err(|err| self.fault(err))
    }

    fn setting(&self, name: &str) -> rusqlite::Result<i32> {
        self.conn.query_row(&format!("PRAGMA {name}"), [], |row| row.get(0))
    }
}

/// One unchanging state of the file, for as long as it is held.
struct Snapshot<'store> {
    /// `None` where one is held already, or a transaction is running.
    db: Option<&'store Database>,
}

impl<'store> Snapshot<'store> {
    fn new(db: &'store Database) -> Result<Self> {
        if !db.conn.is_autocommit() {
            return Ok(Self { db: None });
        }
        db.run("BEGIN DEFERRED")?;
        Ok(Self { db: Some(db) })
    }
}

impl Drop for Snapshot<'_> {
    fn drop(&mut self) {
        if let Some(db) = self.db {
            // There is nothing to take back: it only ends.
            db.run("ROLLBACK").ok();
        }
    }
}

fn absolute(path: &Path) -> Result<PathBuf> {
    if path.as_os_str().is_empty() {
        return Err(Error::EmptyPath);
    }
    std::path::absolute(path).map_err(|err| Error::from_io(path, &err))
}

/// The absolute path of a file that is there.
fn existing_file(path: &Path) -> Result<PathBuf> {
    let path = absolute(path)?;
    let metadata = std::fs::metadata(&path).map_err(|err| Error::from_io(&path, &err))?;
    if metadata.is_dir() { Err(Error::Directory { path }) } else { Ok(path) }
}

/// Whether a terrain has a log with something in it: it is open, or was not closed.
pub(crate) fn has_log(path: &Path) -> bool {
    std::fs::metadata(companion(path, "-wal")).is_ok_and(|log| log.len() > 0)
}

/// A path as SQLite's `file:` names want it: all but the plainest bytes as `%XX`.
fn percent_encoded(path: &Path) -> String {
    let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"/._-".contains(byte);
    let encode = |byte: &u8| {
        if is_plain(byte) { char::from(*byte).to_string() } else { format!("%{byte:02X}") }
    };
    path.as_os_str().as_encoded_bytes().iter().map(encode).collect()
}

/// The path of a file that belongs to a terrain.
pub(crate) fn companion(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}
