//! A terrain on a thread of its own, for whoever may not wait: it takes tasks, and tells events.
//!
//! Tasks are done one after another, in the order in which they were given. A stroke is drawn while its points still come, and
//! what it has come to is looked at meanwhile: that is one task, which ends when the hand is lifted. Whoever looks asks for pages
//! ([`PageRequest`]) and gets them as events, of the terrain as it is by then; what changed is told before it ([`Event::Changed`]).
//!
//! ```text
//! window ── Task ──▶ thread: Terrain ── Event ──▶ window ── wake ──▶ next frame
//! ```

mod event;
mod live_hand;
mod looker;
mod serve;
mod status;
mod survey;

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, JoinHandle};

use orogeny_field::{PointerSample, SampleRect};
use orogeny_geomip::PagePlace;
use orogeny_store::EntryId;

use crate::{BrushOperation, Error, ExportRequest, ImportRequest, Operation, Result, Settings, Terrain};

pub use event::{Event, PageData, Ticket};
pub use status::{HistoryItem, Status};
pub use survey::Survey;

/// A way through the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Travel {
    /// So many entries back.
    Undo(u32),
    /// So many undone ones again.
    Redo(u32),
    /// To an entry.
    Jump(EntryId),
}

/// A page that is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PageRequest {
    /// Which.
    pub place: PagePlace,
    /// What of it, in samples of its level; all of it for `None`, and of an empty rectangle only what is known of the page.
    pub rect: Option<SampleRect>,
}

/// What the thread is asked to do.
enum Task {
    /// Draw a stroke, whose points follow.
    Stroke {
        ticket: Ticket,
        operation: Box<BrushOperation>,
    },
    Points(Vec<PointerSample>),
    Lift,
    Apply {
        ticket: Ticket,
        operations: Vec<Operation>,
    },
    Travel {
        ticket: Ticket,
        travel: Travel,
    },
    Export {
        ticket: Ticket,
        request: Box<ExportRequest>,
    },
    Import {
        ticket: Ticket,
        request: Box<ImportRequest>,
    },
    Survey {
        ticket: Ticket,
        max_side: u32,
    },
    Look(Vec<PageRequest>),
    ShowMasks(Vec<String>),
}

/// A terrain that is worked on by a thread of its own. Dropping it ends what is running and closes the terrain.
pub struct Session {
    /// `None` once it is closed.
    tasks: Option<Sender<Task>>,
    events: Mutex<Receiver<Event>>,
    thread: Option<JoinHandle<Result<()>>>,
    /// The last ticket that was given out.
    last_ticket: AtomicU64,
    /// All tasks up to this ticket are to be given up.
    cancelled: Arc<AtomicU64>,
}

impl std::fmt::Debug for Session {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Session").field("last_ticket", &self.last_ticket).finish_non_exhaustive()
    }
}

impl Session {
    /// Opens a terrain for writing. `wake` is called, from the thread, whenever there is an event.
    ///
    /// # Errors
    /// As [`Terrain::open`].
    pub fn open(path: &Path, settings: Settings, wake: impl Fn() + Send + 'static) -> Result<Self> {
        Self::of(Terrain::open(path, settings)?, wake)
    }

    /// Takes a terrain that is open for writing, or one that is open for reading, on which what changes it fails.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn of(terrain: Terrain, wake: impl Fn() + Send + 'static) -> Result<Self> {
        let (tasks, received) = channel();
        let (sender, events) = channel();
        let cancelled = Arc::new(AtomicU64::new(0));
        let out = event::Out::new(sender, wake);
        let noted = Arc::clone(&cancelled);
        let thread = Builder::new()
            .name("orogeny.session".to_owned())
            .spawn(move || serve::serve(terrain, received, out, noted))
            .map_err(|err| Error::Thread { detail: err.to_string() })?;
        Ok(Self {
            tasks: Some(tasks),
            events: Mutex::new(events),
            thread: Some(thread),
            last_ticket: AtomicU64::new(0),
            cancelled,
        })
    }

    /// What happened since this was last asked, oldest first.
    pub fn events(&self) -> Vec<Event> {
        // A receiver is as good after a panic as before.
        self.events.lock().unwrap_or_else(PoisonError::into_inner).try_iter().collect()
    }

    /// Begins a stroke; of the operation, which has to be a stroke, the points are those that are given [afterwards](Self::push_points).
    pub fn begin_stroke(&self, operation: BrushOperation) -> Ticket {
        self.give(|ticket| Task::Stroke { ticket, operation: Box::new(operation) })
    }

    /// More points of the stroke that was begun last.
    pub fn push_points(&self, points: Vec<PointerSample>) {
        self.send(Task::Points(points));
    }

    /// Ends the stroke that was begun last.
    pub fn lift(&self) {
        self.send(Task::Lift);
    }

    /// Runs operations in one transaction.
    pub fn apply(&self, operations: Vec<Operation>) -> Ticket {
        self.give(|ticket| Task::Apply { ticket, operations })
    }

    /// Goes back or forth in the history.
    pub fn travel(&self, travel: Travel) -> Ticket {
        self.give(|ticket| Task::Travel { ticket, travel })
    }

    /// Writes a file for another program.
    pub fn export(&self, request: ExportRequest) -> Ticket {
        self.give(|ticket| Task::Export { ticket, request: Box::new(request) })
    }

    /// Reads heights of another program's file onto a layer.
    pub fn import(&self, request: ImportRequest) -> Ticket {
        self.give(|ticket| Task::Import { ticket, request: Box::new(request) })
    }

    /// Asks for all of the terrain in few heights, at most so many each way; they come in an [`Event::Surveyed`].
    pub fn survey(&self, max_side: u32) -> Ticket {
        self.give(|ticket| Task::Survey { ticket, max_side })
    }

    /// Gives up everything that was asked for so far and is not done. What is running is taken back, bit for bit.
    pub fn cancel_all(&self) {
        self.cancelled.store(self.last_ticket.load(Ordering::SeqCst), Ordering::SeqCst);
    }

    /// Asks for pages, the most urgent first. All that were asked for together come in one [`Event::Pages`].
    pub fn look(&self, requests: Vec<PageRequest>) {
        self.send(Task::Look(requests));
    }

    /// Has the masks of these layers come with pages from now on, four at most; `selection` is the terrain's.
    pub fn show_masks(&self, names: Vec<String>) {
        self.send(Task::ShowMasks(names));
    }

    /// Waits until all tasks are done, and closes the terrain.
    ///
    /// # Errors
    /// As [`Terrain::close`].
    pub fn close(mut self) -> Result<()> {
        self.end()
    }

    fn end(&mut self) -> Result<()> {
        self.tasks = None;
        let Some(thread) = self.thread.take() else { return Ok(()) };
        thread.join().unwrap_or_else(|_| Err(Error::Thread { detail: "it panicked".to_owned() }))
    }

    fn give(&self, task: impl FnOnce(Ticket) -> Task) -> Ticket {
        let ticket = Ticket(self.last_ticket.fetch_add(1, Ordering::SeqCst) + 1);
        self.send(task(ticket));
        ticket
    }

    fn send(&self, task: Task) {
        // The thread ends before the session only by a panic, which closing tells.
        if let Some(tasks) = &self.tasks {
            tasks.send(task).ok();
        }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.cancel_all();
        // Whoever wants to hear whether it was closed well, closes it.
        self.end().ok();
    }
}
