//! A terrain on a thread of its own, for whoever may not wait: it takes tasks, and tells events.
//!
//! Tasks are done one after another, in the order in which they were given. A stroke is drawn while its points still come, and
//! what it has come to is looked at meanwhile: that is one task, which ends when the hand is lifted. Whoever looks asks for pages
//! ([`PageRequest`]) and gets them as events, of the terrain as it is by then; what changed is told before it ([`Event::Changed`]).
//!
//! Several may work on it, each a [`Participant`]: their strokes are drawn one after another, in the order in which they began.
//!
//! ```text
//! window ── Task ──▶ thread: Terrain ── Event ──▶ window ── wake ──▶ next frame
//! ```

mod cancelling;
mod event;
mod live_hand;
mod looker;
mod on_device;
mod panicked;
mod participant;
mod serve;
mod status;
mod survey;
mod waiting;

use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, JoinHandle};

use orogeny_field::{PointerSample, SampleRect};
use orogeny_geomip::PagePlace;
use orogeny_store::EntryId;

use crate::{BrushOperation, Error, ExportRequest, ImportRequest, Operation, Result, Settings, Terrain};
use cancelling::Cancelling;
use participant::By;

pub use event::{Earlier, Event, PageData, Ticket};
pub use participant::Participant;
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
    /// Takes back what the same author did last, from under what others did since: [`Terrain::take_back`].
    UndoOwn,
    /// Does again what the same author took back last, on top of what is there now: [`Terrain::do_again`].
    RedoOwn,
}

/// A page that is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PageRequest {
    /// Which.
    pub place: PagePlace,
    /// What of it, in samples of its level; all of it for `None`, and of an empty rectangle only what is known of the page.
    pub rect: Option<SampleRect>,
}

impl PageRequest {
    /// Whether it is for heights of a part of a page.
    fn is_part(&self) -> bool {
        self.rect.is_some_and(|rect| !rect.is_empty())
    }
}

/// What the thread is asked to do, and by whom.
#[derive(Debug)]
enum Task {
    /// Draw a stroke, whose points follow.
    Stroke {
        ticket: Ticket,
        by: By,
        operation: Box<BrushOperation>,
    },
    Points {
        stroke: Ticket,
        points: Vec<PointerSample>,
    },
    Lift {
        stroke: Ticket,
    },
    Apply {
        ticket: Ticket,
        by: By,
        operations: Vec<Operation>,
    },
    Travel {
        ticket: Ticket,
        by: By,
        travel: Travel,
    },
    Export {
        ticket: Ticket,
        request: Box<ExportRequest>,
    },
    Import {
        ticket: Ticket,
        by: By,
        request: Box<ImportRequest>,
    },
    Survey {
        ticket: Ticket,
        max_side: u32,
    },
    Look(Vec<PageRequest>),
    ShowMasks(Vec<String>),
    OpenPast {
        ticket: Ticket,
        entry: EntryId,
    },
    ClosePast,
    /// End, once everything before it is done.
    Close,
}

impl Task {
    /// Who asked for it, of what changes the terrain.
    const fn by(&self) -> Option<&By> {
        match self {
            Self::Stroke { by, .. }
            | Self::Apply { by, .. }
            | Self::Travel { by, .. }
            | Self::Import { by, .. } => Some(by),
            Self::Points { .. }
            | Self::Lift { .. }
            | Self::Export { .. }
            | Self::Survey { .. }
            | Self::Look(_)
            | Self::ShowMasks(_)
            | Self::OpenPast { .. }
            | Self::ClosePast
            | Self::Close => None,
        }
    }

    /// What whoever asked for it waits for the end of.
    const fn ticket(&self) -> Option<Ticket> {
        match self {
            Self::Stroke { ticket, .. }
            | Self::Apply { ticket, .. }
            | Self::Travel { ticket, .. }
            | Self::Export { ticket, .. }
            | Self::Import { ticket, .. }
            | Self::Survey { ticket, .. }
            | Self::OpenPast { ticket, .. } => Some(*ticket),
            Self::Points { .. }
            | Self::Lift { .. }
            | Self::Look(_)
            | Self::ShowMasks(_)
            | Self::ClosePast
            | Self::Close => None,
        }
    }
}

/// A terrain that is worked on by a thread of its own. Dropping it ends what is running and closes the terrain.
pub struct Session {
    /// Whoever opened it.
    own: Participant,
    events: Mutex<Receiver<Event>>,
    /// `None` once it is closed.
    thread: Mutex<Option<JoinHandle<Result<()>>>>,
    cancelling: Arc<Cancelling>,
}

impl std::fmt::Debug for Session {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Session").field("cancelling", &self.cancelling).finish_non_exhaustive()
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
        let cancelling = Arc::<Cancelling>::default();
        let out = event::Out::new(sender, wake);
        let noted = Arc::clone(&cancelling);
        let thread = Builder::new()
            .name("orogeny.session".to_owned())
            .spawn(move || serve::serve(terrain, received, out, noted))
            .map_err(|err| Error::Thread { detail: err.to_string() })?;
        let own = Participant::new(tasks, Arc::clone(&cancelling));
        Ok(Self { own, events: Mutex::new(events), thread: Mutex::new(Some(thread)), cancelling })
    }

    /// What happened since this was last asked, oldest first.
    pub fn events(&self) -> Vec<Event> {
        // A receiver is as good after a panic as before.
        self.events.lock().unwrap_or_else(PoisonError::into_inner).try_iter().collect()
    }

    /// Someone who works on the terrain under a name of their own, which the history keeps.
    #[must_use]
    pub fn participant(&self, author: &str) -> Participant {
        self.own.by(author)
    }

    /// As [`Participant::begin_stroke`].
    pub fn begin_stroke(&self, operation: BrushOperation) -> Ticket {
        self.own.begin_stroke(operation)
    }

    /// As [`Participant::push_points`].
    pub fn push_points(&self, stroke: Ticket, points: Vec<PointerSample>) {
        self.own.push_points(stroke, points);
    }

    /// As [`Participant::lift`].
    pub fn lift(&self, stroke: Ticket) {
        self.own.lift(stroke);
    }

    /// As [`Participant::apply`].
    pub fn apply(&self, operations: Vec<Operation>) -> Ticket {
        self.own.apply(operations)
    }

    /// As [`Participant::travel`].
    pub fn travel(&self, travel: Travel) -> Ticket {
        self.own.travel(travel)
    }

    /// As [`Participant::import`].
    pub fn import(&self, request: ImportRequest) -> Ticket {
        self.own.import(request)
    }

    /// Writes a file for another program.
    pub fn export(&self, request: ExportRequest) -> Ticket {
        self.own.give(|ticket, _| Task::Export { ticket, request: Box::new(request) })
    }

    /// Asks for all of the terrain in few heights, at most so many each way; they come in an [`Event::Surveyed`].
    pub fn survey(&self, max_side: u32) -> Ticket {
        self.own.give(|ticket, _| Task::Survey { ticket, max_side })
    }

    /// Gives up everything that was asked for so far and is not done. What is running is taken back, bit for bit.
    pub fn cancel_all(&self) {
        self.cancelling.cancel_all();
    }

    /// Asks for pages, the most urgent first. All that were asked for together come in one [`Event::Pages`].
    pub fn look(&self, requests: Vec<PageRequest>) {
        self.own.send(Task::Look(requests));
    }

    /// Has the masks of these layers come with pages from now on, four at most; `selection` is the terrain's.
    pub fn show_masks(&self, names: Vec<String>) {
        self.own.send(Task::ShowMasks(names));
    }

    /// Has pages come with how they were after an entry of the history, too, on any branch; surveys tell by how much the terrain is higher. It stays
    /// where it is and may be changed; its log is not moved into the file until the past is [closed](Self::close_past). Another past that
    /// is open is closed.
    pub fn open_past(&self, entry: EntryId) -> Ticket {
        self.own.give(|ticket, _| Task::OpenPast { ticket, entry })
    }

    /// Has pages come as they are, and no more.
    pub fn close_past(&self) {
        self.own.send(Task::ClosePast);
    }

    /// Waits until all tasks are done, and closes the terrain. What is asked for afterwards is not done.
    ///
    /// # Errors
    /// As [`Terrain::close`].
    pub fn close(&self) -> Result<()> {
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(thread) = thread else { return Ok(()) };
        self.own.send(Task::Close);
        thread.join().unwrap_or_else(|_| Err(Error::Thread { detail: "it panicked".to_owned() }))
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.cancel_all();
        // Whoever wants to hear whether it was closed well, closes it.
        self.close().ok();
    }
}
