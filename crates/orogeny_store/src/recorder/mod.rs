//! Commits behind the painting: operations are handed over when they are finished, and made durable by a thread of their own,
//! in order, while the next one is painted.
//!
//! One finished operation may wait; the next one waits for it at its own end. So the painting is never more than one
//! operation ahead of the disk, and [`Recorder::flush`] tells when there is nothing left to lose. Pages on their way to the
//! file are read from memory meanwhile, so what was painted is seen at once. Should a commit fail, the operation that was
//! being painted on top of it fails with it, and the terrain is as it was before both.

mod recent;
mod state;
mod thread;

use std::sync::Arc;
use std::sync::mpsc::{Sender, channel, sync_channel};
use std::thread::JoinHandle;

use orogeny_field::{Page, PageKey, PageLayout};

use crate::pace::Pace;
use crate::{Change, Dropped, EntryId, Error, GivingWay, Layer, NewLayer, Result, Store, Transaction};
use recent::Recent;
use state::{Kept, Shared};
use thread::Task;

/// A terrain open for writing, whose operations are made durable behind the painting.
pub struct Recorder {
    /// What is on disk, read beside the writer. Goes first, so that the writer is the last to close the file.
    reader: Option<Store>,
    /// `None` once it is closed.
    tasks: Option<Sender<Task>>,
    thread: Option<JoinHandle<Result<()>>>,
    shared: Arc<Shared>,
    pace: Arc<Pace>,
    /// Bytes of pages on their way that painting may be ahead.
    max_pending_bytes: u64,
    /// Pages as they are now, with what was painted.
    recent: Recent,
    /// The last entry that was handed over.
    last_entry: EntryId,
}

impl std::fmt::Debug for Recorder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recorder").field("store", &self.reader).finish_non_exhaustive()
    }
}

/// An operation, or several that are done together or not at all, on its way to the file. Dropping it takes it back.
#[derive(Debug)]
pub struct Recording<'recorder> {
    recorder: &'recorder mut Recorder,
    /// Counts entries over the life of the recorder: the one being painted.
    number: u64,
    layers: Vec<Layer>,
    last_entry: EntryId,
    /// The terrain had no selection before.
    made_selection: bool,
    is_finished: bool,
    /// Something went wrong that was told: it can only be dropped.
    is_failed: bool,
}

impl Recorder {
    /// Takes a store that is open for writing. Painting may be `max_pending_bytes` of pages ahead of the file; at least one
    /// write is always accepted. `max_recent_bytes` of the pages used last stay in memory.
    ///
    /// # Errors
    /// When the file cannot be opened a second time, for reading; [`Error::OpenedToRead`].
    pub fn start(store: Store, max_pending_bytes: u64, max_recent_bytes: u64) -> Result<Self> {
        store.refuse_unless_writable()?;
        let reader = Store::open_to_read(store.path())?;
        let last_entry = EntryId(reader.document.last_entry);
        let shared = Arc::<Shared>::default();
        let pace = Arc::clone(&store.db.pace);
        let (tasks, received) = channel();
        let thread = thread::start(store, received, Arc::clone(&shared))?;
        Ok(Self {
            reader: Some(reader),
            tasks: Some(tasks),
            thread: Some(thread),
            shared,
            pace,
            max_pending_bytes,
            recent: Recent::new(max_recent_bytes),
            last_entry,
        })
    }

    /// The terrain as it is on disk. What is on its way is not in it.
    ///
    /// # Errors
    /// [`Error::WriterGone`] once the recorder was closed.
    pub fn on_disk(&self) -> Result<&Store> {
        self.reader.as_ref().ok_or(Error::WriterGone)
    }

    /// Reads a page, with what is on its way to the file; `None` where the field holds its constant.
    ///
    /// # Errors
    /// [`Error::DamagedPage`] when the page fails its checksum or does not decode.
    pub fn load_page(&self, key: &PageKey) -> Result<Option<Arc<Page>>> {
        self.load(key, None)
    }

    /// Reads pages, with what is on its way to the file, decoded on all cores; a page that cannot be trusted comes as its error.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn load_pages(&self, keys: &[PageKey]) -> Result<Vec<Result<Option<Arc<Page>>>>> {
        let is_on_disk =
            |key: &&PageKey| self.recent.get(key).is_none() && self.shared.lock().kept(key, None).is_none();
        let on_disk: Vec<PageKey> = keys.iter().filter(is_on_disk).copied().collect();
        let mut from_disk = on_disk.iter().zip(self.on_disk()?.load_pages(&on_disk)?).peekable();
        let mut pages = Vec::with_capacity(keys.len());
        for key in keys {
            // What was on its way then may have arrived, but not the other way round.
            let page = from_disk.next_if(|(of, _)| *of == key).map(|(_, page)| page);
            if let Some(Ok(page)) = &page {
                self.recent.put(*key, page.clone());
            }
            pages.push(page.unwrap_or_else(|| self.load_page(key)));
        }
        Ok(pages)
    }

    /// Has what is on its way to the file give way to the caller, who looks at the terrain: as long as the answer lives, but for 50 ms at
    /// most, and not while someone waits for it, no further page is coded.
    #[must_use]
    pub fn give_way(&self) -> GivingWay<'_> {
        self.pace.give_way()
    }

    /// Starts an operation.
    ///
    /// # Errors
    /// What went wrong with the last one, which was not made durable; [`Error::WriterGone`].
    pub fn begin(&mut self) -> Result<Recording<'_>> {
        self.take_failure()?;
        let number = self.shared.lock().add_entry();
        self.send(Task::Begin)?;
        let (layers, last_entry) = (self.on_disk()?.layers().to_vec(), self.last_entry);
        Ok(Recording {
            recorder: self,
            number,
            layers,
            last_entry,
            made_selection: false,
            is_finished: false,
            is_failed: false,
        })
    }

    /// Waits until everything finished is on disk.
    ///
    /// # Errors
    /// What went wrong with the last operation, which was not made durable; the terrain is as before it.
    pub fn flush(&mut self) -> Result<()> {
        self.wait_until_durable();
        self.take_failure()?;
        self.look_again()
    }

    /// Waits until everything finished is on disk, or has failed to come there, which [`Self::flush`] tells.
    pub fn wait_until_durable(&self) {
        if self.shared.lock().num_commits_under_way > 0 {
            self.pace.go_on();
        }
        self.shared.wait_until_durable();
    }

    /// What had to go from the history since this was last asked, to keep to its budget.
    pub fn take_dropped(&mut self) -> Dropped {
        std::mem::take(&mut self.shared.lock().dropped)
    }

    /// Undoes operations, as [`Store::undo`].
    ///
    /// # Errors
    /// As there, and as [`Self::flush`].
    pub fn undo(&mut self, count: u32) -> Result<Vec<Change>> {
        self.with_store(move |store| store.undo(count))
    }

    /// Redoes operations, as [`Store::redo`].
    ///
    /// # Errors
    /// As there, and as [`Self::flush`].
    pub fn redo(&mut self, count: u32) -> Result<Vec<Change>> {
        self.with_store(move |store| store.redo(count))
    }

    /// Goes to any entry, as [`Store::jump`].
    ///
    /// # Errors
    /// As there, and as [`Self::flush`].
    pub fn jump(&mut self, target: EntryId) -> Result<Vec<Change>> {
        self.with_store(move |store| store.jump(target))
    }

    /// Runs anything on the store, when everything finished is on disk, and waits for it.
    ///
    /// # Errors
    /// What `work` says, and as [`Self::flush`].
    pub fn with_store<T: Send + 'static>(
        &mut self,
        work: impl FnOnce(&mut Store) -> Result<T> + Send + 'static,
    ) -> Result<T> {
        self.flush()?;
        self.recent.clear();
        let (reply, replied) = sync_channel(1);
        self.ask(Task::WithStore(Box::new(move |store| {
            // Whoever asked may have stopped waiting.
            reply.send(work(store)).ok();
        })))?;
        let result = replied.recv().map_err(|_| Error::WriterGone)?;
        self.look_again()?;
        result
    }

    /// Bytes of pages kept in memory: those on their way, and those that the writer remembers.
    #[must_use]
    pub fn memory_in_bytes(&self) -> u64 {
        let state = self.shared.lock();
        state.pending_bytes + state.cached_bytes + self.recent.size_in_bytes()
    }

    /// Waits until everything finished is on disk, and closes the terrain as [`Store::close`].
    ///
    /// # Errors
    /// As [`Self::flush`] and [`Store::close`].
    pub fn close(mut self) -> Result<()> {
        let flushed = self.flush();
        flushed.and(self.end())
    }

    fn end(&mut self) -> Result<()> {
        self.reader = None;
        self.tasks = None;
        let Some(thread) = self.thread.take() else { return Ok(()) };
        thread.join().unwrap_or(Err(Error::WriterGone))
    }

    fn send(&self, task: Task) -> Result<()> {
        let tasks = self.tasks.as_ref().ok_or(Error::WriterGone)?;
        tasks.send(task).map_err(|_| Error::WriterGone)
    }

    /// Sends a task whose answer is waited for.
    fn ask(&self, task: Task) -> Result<()> {
        self.pace.go_on();
        self.send(task)
    }

    /// The page as of the entry `before`, without it; as of now for `None`.
    fn load(&self, key: &PageKey, before: Option<u64>) -> Result<Option<Arc<Page>>> {
        let (kept, is_now) = {
            let state = self.shared.lock();
            (state.kept(key, before), before.is_none_or(|before| !state.is_painted_since(key, before)))
        };
        if !is_now {
            return self.load_kept(key, before, kept);
        }
        if let Some(page) = self.recent.get(key) {
            return Ok(page);
        }
        let page = self.load_kept(key, before, kept)?;
        self.recent.put(*key, page.clone());
        Ok(page)
    }

    fn load_kept(&self, key: &PageKey, before: Option<u64>, kept: Option<Kept>) -> Result<Option<Arc<Page>>> {
        match kept {
            Some(Kept::InMemory(page)) => Ok(Some(page)),
            Some(Kept::InTransaction) => {
                let (reply, replied) = sync_channel(1);
                self.ask(Task::Load { key: *key, before: before.is_some(), reply })?;
                // Without an answer, what it was asked of is gone: the transaction, or the thread.
                replied.recv().unwrap_or(Err(Error::TransactionFailed))
            }
            None => self.on_disk()?.load_page(key),
        }
    }

    fn take_failure(&mut self) -> Result<()> {
        let (failure, is_gone) = {
            let mut state = self.shared.lock();
            (state.failure.take(), state.is_gone)
        };
        match failure {
            Some(err) => {
                // What was painted is taken back.
                self.recent.clear();
                self.look_again()?;
                Err(err)
            }
            None if is_gone => Err(Error::WriterGone),
            None => Ok(()),
        }
    }

    /// Looks again at what is on disk.
    fn look_again(&mut self) -> Result<()> {
        let reader = self.reader.as_mut().ok_or(Error::WriterGone)?;
        reader.refresh()?;
        self.last_entry = EntryId(reader.document.last_entry);
        Ok(())
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // What is finished is made durable; whoever wants to hear whether it was, closes.
        self.end().ok();
    }
}

impl Recording<'_> {
    /// How planes are cut into pages.
    ///
    /// # Errors
    /// [`Error::WriterGone`].
    pub fn layout(&self) -> Result<PageLayout> {
        Ok(self.recorder.on_disk()?.layout())
    }

    /// The layers, from the bottom, with those added here.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Takes back the entries after `entry`, as [`Transaction::go_back_to`], before anything else is done, and waits for it.
    ///
    /// # Errors
    /// As there; the recording can then only be dropped.
    pub fn go_back_to(&mut self, entry: EntryId) -> Result<Vec<PageKey>> {
        let pages = self.change_layers(move |transaction| transaction.go_back_to(entry))?;
        self.recorder.recent.clear();
        self.number = self.recorder.shared.lock().add_changed(self.number, &pages);
        Ok(pages)
    }

    /// Reads a page as this recording left it; `None` where the field holds its constant.
    ///
    /// # Errors
    /// As [`Recorder::load_page`], and as [`Self::write_pages`].
    pub fn load_page(&mut self, key: &PageKey) -> Result<Option<Arc<Page>>> {
        self.load(key, None)
    }

    /// Reads a page of a level above full resolution, as [`Transaction::load_coarse_page`], and waits for it.
    ///
    /// # Errors
    /// As there.
    pub fn load_coarse_page(&mut self, key: &PageKey) -> Result<Option<Arc<Page>>> {
        let key = *key;
        self.with_transaction(move |transaction| transaction.load_coarse_page(&key))
    }

    /// Reads a page as it was before the entry that is [recorded](Self::record) next.
    ///
    /// # Errors
    /// As [`Recorder::load_page`].
    pub fn load_page_before(&mut self, key: &PageKey) -> Result<Option<Arc<Page>>> {
        self.load(key, Some(self.number))
    }

    fn load(&mut self, key: &PageKey, before: Option<u64>) -> Result<Option<Arc<Page>>> {
        match self.recorder.load(key, before) {
            // Why it failed is what there is to say.
            Err(Error::TransactionFailed) => self.refuse_after_failure().and(Err(Error::TransactionFailed)),
            result => result,
        }
    }

    /// What went wrong, once; after that only that something did.
    fn refuse_after_failure(&mut self) -> Result<()> {
        if self.is_failed {
            return Err(Error::TransactionFailed);
        }
        let result = self.recorder.take_failure();
        self.is_failed = result.is_err();
        result
    }

    /// Says that what is written from here on ends what is painted: for up to 10 ms whoever looks at it goes first, unless someone waits
    /// for it to be on disk. So it is after [`finish`](Self::finish) in any case.
    pub fn wait_for_look(&self) {
        self.recorder.pace.wait_for_look();
    }

    /// Hands over changed pages; waits while painting is too far ahead. What is wrong with them may come to light only
    /// later.
    ///
    /// # Errors
    /// What went wrong with an earlier write or operation: this recording can then only be dropped.
    pub fn write_pages(&mut self, pages: Vec<(PageKey, Page)>) -> Result<()> {
        let pages: Vec<_> = pages.into_iter().map(|(key, page)| (key, Arc::new(page))).collect();
        if !self.recorder.shared.has_room(&pages, self.recorder.max_pending_bytes) {
            self.recorder.pace.go_on();
        }
        self.recorder.shared.wait_for_room(&pages, self.recorder.max_pending_bytes);
        self.refuse_after_failure()?;
        for (key, page) in &pages {
            self.recorder.recent.put(*key, Some(Arc::clone(page)));
        }
        self.recorder.shared.lock().add_pages(self.number, &pages);
        self.recorder.send(Task::Write { number: self.number, pages })
    }

    /// Puts a layer on top of the stack, as [`Transaction::add_layer`], and waits for it.
    ///
    /// # Errors
    /// As there.
    pub fn add_layer(&mut self, new: NewLayer) -> Result<Layer> {
        self.change_layers(move |transaction| transaction.add_layer(&new))
    }

    /// The layer with a mask, as [`Transaction::with_mask`], and waits for it.
    ///
    /// # Errors
    /// As there.
    pub fn with_mask(&mut self, layer: &Layer) -> Result<Layer> {
        let layer = layer.clone();
        self.change_layers(move |transaction| transaction.with_mask(&layer))
    }

    /// Changes a layer, as [`Transaction::set_layer`], and waits for it.
    ///
    /// # Errors
    /// As there.
    pub fn set_layer(&mut self, layer: Layer) -> Result<()> {
        self.change_layers(move |transaction| transaction.set_layer(&layer))
    }

    /// Takes a layer out of the stack, as [`Transaction::remove_layer`], and waits for it.
    ///
    /// # Errors
    /// As there.
    pub fn remove_layer(&mut self, id: u32) -> Result<Layer> {
        self.change_layers(move |transaction| transaction.remove_layer(id))
    }

    /// Runs what changes layers, waits for it, and knows the layers as they are then.
    fn change_layers<T: Send + 'static>(
        &mut self,
        work: impl FnOnce(&mut Transaction<'_>) -> Result<T> + Send + 'static,
    ) -> Result<T> {
        let (done, layers) = self.with_transaction(move |transaction| {
            let done = work(transaction)?;
            Ok((done, transaction.layers().to_vec()))
        })?;
        self.layers = layers;
        Ok(done)
    }

    /// The pages that a field has at full resolution, with those that were handed over.
    ///
    /// # Errors
    /// As [`Self::with_transaction`].
    pub fn page_keys(&mut self, field: orogeny_field::FieldId) -> Result<Vec<PageKey>> {
        self.with_transaction(move |transaction| transaction.page_keys(field))
    }

    /// The field of the terrain's selection, where there is one.
    ///
    /// # Errors
    /// As [`Self::with_transaction`].
    pub fn known_selection(&mut self) -> Result<Option<orogeny_field::FieldId>> {
        self.with_transaction(|transaction| Ok(transaction.known_selection()))
    }

    /// The field of the terrain's selection, as [`Transaction::selection`], and waits for it.
    ///
    /// # Errors
    /// As there.
    pub fn selection(&mut self) -> Result<orogeny_field::FieldId> {
        let selection = self.with_transaction(|transaction| transaction.selection())?;
        self.made_selection |= !self.recorder.on_disk()?.fields().contains_key(&selection);
        Ok(selection)
    }

    /// Runs anything on the transaction, when everything handed over is in it, and waits for it.
    ///
    /// # Errors
    /// What `work` says, and what went wrong with an earlier write.
    pub fn with_transaction<T: Send + 'static>(
        &mut self,
        work: impl FnOnce(&mut Transaction<'_>) -> Result<T> + Send + 'static,
    ) -> Result<T> {
        let (reply, replied) = sync_channel(1);
        self.recorder.ask(Task::WithTransaction(Box::new(move |transaction| {
            reply.send(work(transaction)).ok();
        })))?;
        match replied.recv() {
            Ok(result) => result,
            // The transaction had failed, so that nothing was run on it.
            Err(_) => self.refuse_after_failure().and(Err(Error::TransactionFailed)),
        }
    }

    /// Ends what was done since the last record as one entry of the history, as [`Transaction::record`].
    ///
    /// # Errors
    /// As [`Self::write_pages`].
    pub fn record(&mut self, operation_json: String, author: &str) -> Result<EntryId> {
        self.refuse_after_failure()?;
        let author = author.to_owned();
        self.recorder.send(Task::Record { operation_json, author })?;
        self.number = self.recorder.shared.lock().add_entry();
        self.last_entry = EntryId(self.last_entry.0.saturating_add(1));
        Ok(self.last_entry)
    }

    /// Hands over what was recorded: it is made durable while others go on. First waits for the operation before it.
    ///
    /// # Errors
    /// What went wrong with the operation before it, or with this one as far as is known: neither was made durable.
    pub fn finish(mut self) -> Result<()> {
        self.recorder.wait_until_durable();
        self.refuse_after_failure()?;
        self.recorder.shared.lock().num_commits_under_way += 1;
        self.recorder.send(Task::Commit { last_number: self.number })?;
        self.is_finished = true;
        self.recorder.last_entry = self.last_entry;
        self.recorder.pace.wait_for_look();
        if self.layers == self.recorder.on_disk()?.layers() && !self.made_selection {
            return Ok(());
        }
        // Changes of layers, and a selection's first stroke, are rare: everyone sees them at once.
        self.recorder.flush()
    }
}

impl Drop for Recording<'_> {
    fn drop(&mut self) {
        if !self.is_finished {
            self.recorder.recent.clear();
            // Where the thread is gone there is nothing to take back.
            self.recorder.ask(Task::Abort { last_number: self.number }).ok();
            self.recorder.shared.wait_until_taken_back(self.number);
        }
    }
}
