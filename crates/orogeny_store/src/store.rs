//! The open terrain file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use orogeny_field::{FieldId, HeightBounds, Page, PageKey, PageLayout, TerrainGrid};

use crate::database::Database;
use crate::error::unix_ms;
use crate::head::{Head, LastCommit};
use crate::rows::{Document, EntryRow};
use crate::stack::Stack;
use crate::{Counters, EntryId, Error, Field, Layer, NewLayer, Result, Transaction};
use crate::{content, format, upgrade};

/// A terrain to be made.
#[derive(Debug, Clone, PartialEq)]
pub struct NewTerrain {
    /// Its size and sample spacing.
    pub grid: TerrainGrid,
    /// How it is cut into pages.
    pub layout: PageLayout,
    /// Its first layers, from the bottom. They belong to the terrain and cannot be undone.
    pub layers: Vec<NewLayer>,
}

/// A terrain file, open for writing or for reading.
///
/// One store at a time has it open for writing, in this process or any other; any number may read beside it and see what
/// was last committed. What a reader remembers of the terrain (its [`layers`](Self::layers)) is as of the last
/// [`refresh`](Self::refresh) or opening, unless it [holds](Self::hold) a state, which its pages are of too.
pub struct Store {
    pub(crate) db: Database,
    /// `None` for a reader. After the database, since it goes when that has closed and left no log.
    head: Option<Head>,
    pub(crate) document: Document,
    pub(crate) stack: Stack,
    /// What the disk said when it failed in mid-commit.
    disk_failure: Option<String>,
    /// The version of the file before it was opened, where that was an older one.
    upgraded_from: Option<i32>,
    /// Of a reader: the entry as of which it shows the terrain; `None`: the one that the history stands at.
    past: Option<EntryId>,
    pub(crate) clock: fn() -> SystemTime,
}

impl std::fmt::Debug for Store {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Store").field("path", &self.path()).finish_non_exhaustive()
    }
}

impl Store {
    /// Makes a terrain file, durably, and opens it for writing.
    ///
    /// # Errors
    /// [`Error::Exists`] where there is a file already; [`Error::LayerName`] or [`Error::Value`] for a layer that
    /// cannot be; else what the system refused. Nothing is left behind.
    pub fn create(path: &Path, new: &NewTerrain) -> Result<Self> {
        let layers = new.layers.iter().map(NewLayer::checked).collect::<Result<Vec<_>>>()?;
        let mut document = Document { sequence: 1, ..Document::new(new.grid, new.layout) };
        let mut stack = Stack::default();
        let db = Database::create(path, |db| {
            db.insert_entry(&EntryRow {
                id: EntryId::CREATION,
                parent: None,
                operation: "null".to_owned(),
                author: String::new(),
                time_unix_ms: unix_ms(SystemTime::now()),
                num_pages: 0,
                delta_bytes: 0,
            })?;
            for layer in layers {
                stack.add(db, &mut document, EntryId::CREATION, layer)?;
            }
            db.write_document(&document)
        })?;
        let path = db.path().to_owned();
        let started = Head::lock(&path).and_then(|(head, _)| {
            let mut store = Self::writer(db, head, document, stack);
            // A record that an older terrain of that name left behind says nothing about this one.
            store.accept_what_was_lost()?;
            Ok(store)
        });
        // The first error is the one to report.
        started.inspect_err(|_| _ = std::fs::remove_file(&path))
    }

    /// Opens a terrain file for writing, in time independent of its size. A log that a killed process left is taken up:
    /// everything acknowledged is there. A file of an older version is brought up to date.
    ///
    /// # Errors
    /// [`Error::Busy`], which says who has it open for writing; [`Error::LostCommits`] when something acknowledged is not
    /// there; [`Error::EmptyPath`], [`Error::Missing`], [`Error::Directory`], [`Error::NotATerrain`],
    /// [`Error::NewerVersion`], [`Error::Damaged`], [`Error::ReadOnly`]. The file is not changed.
    pub fn open(path: &Path) -> Result<Self> {
        let (mut store, acknowledged) = Self::open_whatever_was_lost(path)?;
        if let Err(err) = store.document.check_commit(store.path(), acknowledged.as_ref()) {
            // What is left of the log stays as it is, and so does the record.
            store.db.keep_log()?;
            return Err(err);
        }
        store.nothing_is_lost();
        Ok(store)
    }

    /// As [`Self::open`], with what the last writer acknowledged instead of a comparison with it.
    pub(crate) fn open_whatever_was_lost(path: &Path) -> Result<(Self, Option<LastCommit>)> {
        let (mut db, version) = Database::open_to_write(path)?;
        let (head, acknowledged) = Head::lock(db.path())?;
        db.configure()?;
        if version < format::FORMAT_VERSION {
            upgrade::to_current(&db, version)?;
        }
        let (document, stack) = db.in_snapshot(|| Ok((db.document()?, Stack::load(&db)?)))?;
        let mut store = Self::writer(db, head, document, stack);
        store.upgraded_from = (version < format::FORMAT_VERSION).then_some(version);
        Ok((store, acknowledged))
    }

    /// Opens a terrain file for reading, beside a writer or not. Nothing of it is changed.
    ///
    /// # Errors
    /// As [`Self::open`], but for [`Error::Busy`] and [`Error::ReadOnly`]; [`Error::OlderVersion`], which only opening it
    /// for writing mends.
    pub fn open_to_read(path: &Path) -> Result<Self> {
        // In this order: a writer first commits and then notes it.
        let acknowledged = Head::read(path)?;
        let store = Self::open_to_read_whatever_was_lost(path)?;
        store.document.check_commit(store.path(), acknowledged.as_ref())?;
        Ok(store)
    }

    /// Opens a terrain file for reading as it was after an entry, on any branch, whatever the history stands at: as one that went there
    /// shows it. Nothing of the file is changed. It [holds](Self::hold) that state; what differs from the file lies in temporary files of
    /// the system.
    ///
    /// # Errors
    /// [`Error::UnknownEntry`]; else as [`Self::open_to_read`] and [`Self::undo`].
    pub fn open_to_read_at(path: &Path, entry: EntryId) -> Result<Self> {
        let mut store = Self { past: Some(entry), ..Self::open_to_read(path)? };
        store.hold()?;
        Ok(store)
    }

    pub(crate) fn open_to_read_whatever_was_lost(path: &Path) -> Result<Self> {
        let db = Database::open_to_read(path)?;
        let (document, stack) = db.in_snapshot(|| Ok((db.document()?, Stack::load(&db)?)))?;
        Ok(Self::reader(db, document, stack))
    }

    pub(crate) fn reader(db: Database, document: Document, stack: Stack) -> Self {
        Self::of(db, None, document, stack)
    }

    fn writer(db: Database, head: Head, document: Document, stack: Stack) -> Self {
        Self::of(db, Some(head), document, stack)
    }

    fn of(db: Database, head: Option<Head>, document: Document, stack: Stack) -> Self {
        let (disk_failure, upgraded_from, past) = (None, None, None);
        Self { db, head, document, stack, disk_failure, upgraded_from, past, clock: SystemTime::now }
    }

    /// Moves everything into the one file and closes it: nothing remains beside it, unless someone else has the terrain
    /// open. Dropping a store does the same, without a word when it cannot.
    ///
    /// # Errors
    /// When the log could not be moved, for want of space for instance. Nothing is lost: the log stays beside the file.
    pub fn close(self) -> Result<()> {
        // The head goes after the database, at the end of this function.
        let Self { db, head, disk_failure, .. } = self;
        if head.is_some() && disk_failure.is_none() {
            db.close()
        } else {
            drop(db);
            Ok(())
        }
    }

    /// Where the file is, absolute.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.db.path()
    }

    /// Size and sample spacing.
    #[must_use]
    pub const fn grid(&self) -> TerrainGrid {
        self.document.grid
    }

    /// How its fields are cut into pages.
    #[must_use]
    pub const fn layout(&self) -> PageLayout {
        self.document.layout
    }

    /// The version that the file had before this opening brought it up to date; `None` where there was nothing to do.
    #[must_use]
    pub const fn upgraded_from(&self) -> Option<i32> {
        self.upgraded_from
    }

    /// How many commits the terrain has seen, those of a writer beside this reader included.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn num_commits(&self) -> Result<u64> {
        Ok(self.db.document()?.sequence)
    }

    /// The layers, from the bottom.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.stack.layers
    }

    /// All fields: heights and masks of layers, those of undone layers too, and selections.
    #[must_use]
    pub const fn fields(&self) -> &BTreeMap<FieldId, Field> {
        &self.stack.fields
    }

    /// Reads a page of any level; `None` where the field holds its constant.
    ///
    /// # Errors
    /// [`Error::DamagedPage`] when the page fails its checksum or does not decode; the others are not concerned.
    pub fn load_page(&self, key: &PageKey) -> Result<Option<Arc<Page>>> {
        Ok(content::content(&self.db, self.layout(), key)?.map(|content| content.page))
    }

    /// Reads several pages, decoded on all cores. A damaged one comes as its error.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn load_pages(&self, keys: &[PageKey]) -> Result<Vec<Result<Option<Arc<Page>>>>> {
        let pages = content::contents(&self.db, self.layout(), keys)?;
        Ok(pages.into_iter().map(|content| Ok(content?.map(|content| content.page))).collect())
    }

    /// Lowest and highest height, at full resolution and within the terrain, of what a page of any level covers; `None`
    /// where that is all the field's constant. Reads no page, so it does not notice damage, which only the check does.
    ///
    /// # Errors
    /// When the directory cannot be read.
    pub fn page_bounds(&self, key: &PageKey) -> Result<Option<HeightBounds>> {
        Ok(self.db.page_info(key)?.map(|info| info.bounds))
    }

    /// [`Self::page_bounds`], and how far the surface of a page's level is at most from that of full resolution anywhere on the page, metres: what
    /// is lost by drawing it in the place of those below it; 0 at level 0. A surface is the two triangles of each cell, from its
    /// first sample to its last.
    ///
    /// # Errors
    /// When the directory cannot be read.
    pub fn page_surface(&self, key: &PageKey) -> Result<Option<(HeightBounds, f32)>> {
        Ok(self.db.page_info(key)?.map(|info| (info.bounds, info.error_m)))
    }

    /// The pages that a field has, at all levels, in the order of level, row, column.
    ///
    /// # Errors
    /// When the directory cannot be read.
    pub fn page_keys(&self, field: FieldId) -> Result<Vec<PageKey>> {
        self.db.page_keys(field)
    }

    /// The pages that a field has among those of a level that hold any sample of a rectangle, in samples of that level.
    ///
    /// # Errors
    /// When the directory cannot be read.
    pub fn page_keys_in(
        &self,
        field: FieldId,
        level: u8,
        rect: &orogeny_field::SampleRect,
    ) -> Result<Vec<PageKey>> {
        let size = self.layout().size();
        let along = |start: i32, end: i32| {
            let (start, end) = (start.max(0).unsigned_abs(), end.max(0).unsigned_abs());
            start / size..end.div_ceil(size)
        };
        self.db.page_keys_in(field, level, along(rect.z0, rect.z1), along(rect.x0, rect.x1))
    }

    /// The latest entry that changed any of a field's pages that hold a sample of a rectangle, at full resolution; `None` where
    /// there is none.
    ///
    /// # Errors
    /// When the directory cannot be read.
    pub fn newest_revision(
        &self,
        field: FieldId,
        rect: &orogeny_field::SampleRect,
    ) -> Result<Option<EntryId>> {
        let mut newest = None;
        for key in self.page_keys_in(field, 0, rect)? {
            newest = newest.max(self.db.page_info(&key)?.map(|info| info.revision));
        }
        Ok(newest)
    }

    /// How many pages of a field were painted.
    ///
    /// # Errors
    /// When the directory cannot be read.
    pub fn num_pages(&self, field: FieldId) -> Result<u64> {
        self.db.num_pages(field)
    }

    /// Starts an operation.
    ///
    /// # Errors
    /// [`Error::OpenedToRead`]; [`Error::DiskFailed`] when the disk failed before.
    pub fn begin(&mut self) -> Result<Transaction<'_>> {
        Transaction::start(self)
    }

    /// Shows the terrain as it is now, layers and pages of one state, whatever a writer beside this reader commits, until it is called
    /// again or the store is closed. The writer's log cannot be moved into the file meanwhile. A store that is open for writing has
    /// no one beside it, and stays as it is.
    ///
    /// # Errors
    /// When the file cannot be read. The store can then only be closed, or hold what can be read again.
    pub fn hold(&mut self) -> Result<()> {
        if self.head.is_some() {
            return Ok(());
        }
        self.db.hold()?;
        self.refresh()?;
        match self.past {
            Some(entry) => self.go_back_without_writing(entry),
            None => Ok(()),
        }
    }

    /// Looks again at what a writer may have changed.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn refresh(&mut self) -> Result<()> {
        let db = &self.db;
        (self.document, self.stack) = db.in_snapshot(|| Ok((db.document()?, Stack::load(db)?)))?;
        Ok(())
    }

    /// Takes the time of entries from here on from `clock`, instead of from the system's. Nothing is ordered by it.
    pub fn set_clock(&mut self, clock: fn() -> SystemTime) {
        self.clock = clock;
    }

    /// Bytes of the file, its log included.
    ///
    /// # Errors
    /// When the system does not say.
    pub fn file_size_in_bytes(&self) -> Result<u64> {
        self.db.file_size_in_bytes()
    }

    /// What was asked of the database since this store was opened.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.db.counters.get()
    }

    /// Keeps no more than so many bytes of decoded pages in memory; [`MAX_CACHE_BYTES`](crate::MAX_CACHE_BYTES) is the most
    /// that is ever kept.
    pub fn limit_cache(&self, max_bytes: u64) {
        self.db.cache.borrow_mut().limit(max_bytes);
    }

    /// Bytes of decoded pages kept in memory.
    #[must_use]
    pub fn cached_bytes(&self) -> u64 {
        self.db.cache.borrow().size_in_bytes()
    }

    pub(crate) fn refuse_unless_writable(&self) -> Result<()> {
        let path = || self.path().to_owned();
        if self.head.is_none() {
            return Err(Error::OpenedToRead { path: path() });
        }
        match &self.disk_failure {
            Some(detail) => Err(Error::DiskFailed { path: path(), detail: detail.clone() }),
            None => Ok(()),
        }
    }

    /// Starts a transaction of the database that may write.
    pub(crate) fn begin_database(&self) -> Result<()> {
        self.refuse_unless_writable()?;
        self.db.begin()?;
        // The lock keeps other writers out, unless someone removes its file: then the first to see the other one stops.
        let is_ours = self.db.document().map(|document| document.sequence == self.document.sequence);
        if !matches!(is_ours, Ok(true)) {
            self.db.rollback();
        }
        match is_ours? {
            true => Ok(()),
            false => Err(Error::Busy { path: self.path().to_owned(), holder: None }),
        }
    }

    /// Runs `work` as one commit, which is on disk when this returns: all of it, or nothing. `work` may change the document
    /// and the layers that the commit leaves.
    pub(crate) fn in_commit<T>(
        &mut self,
        work: impl FnOnce(&Self, &mut Document, &mut Stack) -> Result<T>,
    ) -> Result<T> {
        self.begin_database()?;
        let (mut document, mut stack) = (self.document.clone(), self.stack.clone());
        match work(self, &mut document, &mut stack) {
            Ok(value) => self.commit(document, stack).map(|()| value),
            Err(err) => {
                self.db.rollback();
                Err(err)
            }
        }
    }

    /// Remembers that the disk failed: what it holds is not known until it is read again.
    pub(crate) fn note_disk_failure(&mut self, err: &Error) -> Result<()> {
        match err {
            Error::Io { detail, .. } => self.fail_disk(detail.clone()),
            _ => Ok(()),
        }
    }

    fn fail_disk(&mut self, detail: String) -> Result<()> {
        self.disk_failure = Some(detail);
        self.db.keep_log()
    }

    /// Ends the running transaction as one commit that leaves `document`, which is on disk when this returns.
    pub(crate) fn commit(&mut self, mut document: Document, stack: Stack) -> Result<()> {
        document.sequence = self.document.sequence + 1;
        let committed = self.db.write_document(&document).and_then(|()| self.db.commit());
        if let Err(err) = committed {
            self.db.rollback();
            // What of it reached the disk is not known, and a second attempt that the system calls good proves nothing:
            // it may have dropped what it could not write.
            self.note_disk_failure(&err)?;
            return Err(err);
        }
        self.document = document;
        self.stack = stack;
        self.acknowledge()
    }

    /// Everything that was acknowledged is there.
    pub(crate) fn nothing_is_lost(&mut self) {
        self.head.iter_mut().for_each(Head::nothing_is_lost);
    }

    /// Takes what is there for what was acknowledged.
    pub(crate) fn accept_what_was_lost(&mut self) -> Result<()> {
        if let Some(head) = &mut self.head {
            head.forget().map_err(|err| Error::from_io(self.db.path(), &err))?;
            head.nothing_is_lost();
        }
        self.acknowledge()
    }

    /// Notes the commit outside the database, before anyone is told of it.
    pub(crate) fn acknowledge(&mut self) -> Result<()> {
        let commit = self.document.last_commit();
        let Some(head) = &mut self.head else { return Ok(()) };
        let Err(err) = head.record(&commit) else { return Ok(()) };
        self.fail_disk(err.to_string())?;
        Err(Error::DiskFailed { path: self.db.path().to_owned(), detail: err.to_string() })
    }
}

impl Document {
    /// Whether the terrain holds everything that was acknowledged.
    pub(crate) fn check_commit(&self, path: &Path, acknowledged: Option<&LastCommit>) -> Result<()> {
        let Some(acknowledged) = acknowledged else { return Ok(()) };
        let is_other = self.sequence == acknowledged.sequence && self.last_commit().hash != acknowledged.hash;
        if self.sequence < acknowledged.sequence || is_other {
            return Err(Error::LostCommits {
                path: PathBuf::from(path),
                found: self.sequence,
                acknowledged: acknowledged.sequence,
            });
        }
        Ok(())
    }
}
