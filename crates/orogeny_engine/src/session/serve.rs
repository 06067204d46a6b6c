//! The thread of a session: one task after another.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use orogeny_field::BrushType;
use orogeny_store::{EntryId, Store};

use super::cancelling::Cancelling;
use super::event::{Event, Out};
use super::live_hand::{LiveHand, MAX_WAIT, or_none};
use super::looker::Looker;
use super::panicked::Panicked;
use super::participant::By;
use super::status::KnownHistory;
use super::waiting::{Drawn, Waiting};
use super::{Status, Survey, Task, Ticket, Travel};
use crate::composite::Change;
use crate::{Applied, BrushOperation, Error, Observer, Operation, Progress, Redone, Result, Terrain};

/// How often progress is told.
const TELL_EVERY: Duration = Duration::from_millis(50);

/// Watches a task.
struct Watcher<'a> {
    ticket: Ticket,
    out: &'a Out,
    cancelling: &'a Cancelling,
    last_told: Option<Instant>,
}

impl Observer for Watcher<'_> {
    fn progress(&mut self, progress: Progress) -> ControlFlow<()> {
        if self.cancelling.is_cancelled(self.ticket) {
            return ControlFlow::Break(());
        }
        if self.last_told.is_none_or(|told| told.elapsed() >= TELL_EVERY) {
            self.last_told = Some(Instant::now());
            self.out.tell(Event::Progress { ticket: self.ticket, progress });
        }
        ControlFlow::Continue(())
    }
}

struct Server {
    terrain: Terrain,
    tasks: Receiver<Task>,
    /// What came while a stroke was drawn.
    waiting: Waiting,
    looker: Looker,
    out: Out,
    cancelling: Arc<Cancelling>,
    /// What is being done.
    running: Option<Ticket>,
    history: KnownHistory,
    /// The terrain's own author.
    own_author: String,
    /// What authors took back of their own, the last at the end, as long as they do nothing else.
    taken_back: HashMap<String, Vec<EntryId>>,
}

/// What a task came to.
#[derive(Default)]
struct Outcome {
    applied: Vec<Applied>,
    entries: Vec<EntryId>,
    cut_after: Option<usize>,
}

impl Outcome {
    fn of(applied: Vec<Applied>) -> Self {
        let entries = applied.iter().map(|applied| applied.entry).collect();
        Self { applied, entries, cut_after: None }
    }
}

pub(super) fn serve(
    terrain: Terrain,
    tasks: Receiver<Task>,
    out: Out,
    cancelling: Arc<Cancelling>,
) -> Result<()> {
    let looker = Looker::new(terrain.settings());
    let own_author = terrain.settings().author.clone();
    let (waiting, taken_back) = (Waiting::default(), HashMap::new());
    let history = KnownHistory::default();
    let running = None;
    let mut server =
        Server { terrain, tasks, waiting, looker, out, cancelling, running, history, own_author, taken_back };
    // Nothing of the server but what it was asked is used after a panic.
    match catch_unwind(AssertUnwindSafe(|| server.serve())) {
        Ok(()) => {
            // First, so that no log stays beside the file.
            server.looker.close_past();
            server.terrain.close()
        }
        Err(panic) => {
            let Server { terrain, tasks, waiting, looker, out, running, .. } = server;
            // Gives up what was under way, as a kill would, and lets go of the file before anyone is told to open it again.
            catch_unwind(AssertUnwindSafe(|| drop((looker, terrain)))).ok();
            let panicked = Panicked::new(&*panic, out);
            panicked.answer(running, waiting, &tasks);
            Err(panicked.error())
        }
    }
}

impl Server {
    fn serve(&mut self) {
        self.tell_status();
        while let Some(task) = self.next_task() {
            self.running = task.ticket();
            self.run(task);
            self.running = None;
        }
    }

    fn next_task(&mut self) -> Option<Task> {
        let task = self.waiting.pop().or_else(|| self.tasks.recv().ok())?;
        (!matches!(task, Task::Close)).then_some(task)
    }

    fn run(&mut self, task: Task) {
        let author = task.by().and_then(By::author).unwrap_or(&self.own_author).to_owned();
        let is_new = task.by().is_some() && !matches!(task, Task::Travel { .. });
        self.terrain.set_author(author.clone());
        let (ticket, result) = match task {
            Task::Look(requests) => match self.looker.pages(&self.terrain, &requests) {
                Ok(mut pages) => {
                    // What does not come from the device comes from memory.
                    if let Err(err) = self.looker.add_parts(&mut self.terrain, &requests, &mut pages) {
                        tracing::warn!("pages are handed over from memory: {err}");
                    }
                    return self.out.tell(Event::Pages(pages));
                }
                // Whoever waits for the pages hears that they do not come.
                Err(err) => {
                    self.out.tell(Event::Pages(Vec::new()));
                    (Ticket(u64::MAX), Err(err))
                }
            },
            Task::Survey { ticket, max_side } => {
                let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
                match Survey::of(&self.terrain, self.looker.past(), max_side, watcher) {
                    Ok(survey) => return self.out.tell(Event::Surveyed { ticket, survey: Box::new(survey) }),
                    Err(err) => (ticket, Err(err)),
                }
            }
            Task::ShowMasks(names) => {
                self.looker.show_masks(names);
                return self.out.tell(Event::Changed { rects: None, is_settled: true });
            }
            Task::OpenPast { ticket, entry } => (ticket, self.open_past(entry)),
            Task::ClosePast => {
                self.looker.close_past();
                return self.everything_changed();
            }
            // Of a stroke that has failed, or ended.
            Task::Points { .. } | Task::Lift { .. } | Task::Close => return,
            Task::Stroke { ticket, operation, by } => {
                let drawn = self.waiting.take_stroke(ticket);
                (ticket, self.draw(ticket, &by, *operation, drawn))
            }
            Task::Apply { ticket, operations, .. } => (ticket, self.apply(ticket, &operations)),
            Task::Travel { ticket, travel, .. } => (ticket, self.travel(ticket, travel)),
            Task::Export { ticket, request } => {
                let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
                (ticket, self.terrain.export(&request, watcher).map(|_| Outcome::default()))
            }
            Task::Import { ticket, request, .. } => {
                let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
                let imported = self.terrain.import(&request, watcher);
                if let Ok(summary) = &imported {
                    self.changed(self.terrain.changed_by(summary).map(|change| vec![change]));
                }
                let outcome = |summary: crate::ImportSummary| Outcome {
                    entries: vec![summary.entry],
                    ..Outcome::default()
                };
                (ticket, imported.map(outcome))
            }
        };
        self.cancelling.forget(ticket);
        // What was taken back is left behind by what is done anew.
        if is_new && result.as_ref().is_ok_and(|outcome| !outcome.entries.is_empty()) {
            self.taken_back.remove(&author);
        }
        // Whoever hears that it is done knows what it has led to.
        self.tell_status();
        match result {
            Ok(Outcome { applied, entries, cut_after }) => {
                self.out.tell(Event::Done { ticket, applied, entries, cut_after });
            }
            Err(err) => {
                let (is_cancelled, is_fault) = (matches!(err, Error::Cancelled), err.is_fault());
                self.out.tell(Event::Failed { ticket, message: err.to_string(), is_cancelled, is_fault });
            }
        }
    }

    fn apply(&mut self, ticket: Ticket, operations: &[Operation]) -> Result<Outcome> {
        if self.cancelling.is_cancelled(ticket) {
            return Err(Error::Cancelled);
        }
        let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
        let applied = self.terrain.apply(operations, watcher)?;
        self.changed(applied.iter().map(|applied| applied.change).collect());
        Ok(Outcome::of(applied))
    }

    fn travel(&mut self, ticket: Ticket, travel: Travel) -> Result<Outcome> {
        if self.cancelling.is_cancelled(ticket) {
            return Err(Error::Cancelled);
        }
        let travelled = match travel {
            Travel::UndoOwn => return self.undo_own(ticket),
            Travel::RedoOwn => return self.redo_own(ticket),
            Travel::Undo(count) => self.terrain.undo(count),
            Travel::Redo(count) => self.terrain.redo(count),
            Travel::Jump(entry) => self.terrain.jump(entry),
        }?;
        self.changed(self.terrain.changed_by_travel(&travelled)?);
        Ok(Outcome::default())
    }

    fn open_past(&mut self, entry: EntryId) -> Result<Outcome> {
        // Before another one is open: each holds back the log.
        self.looker.close_past();
        let path = self.terrain.settled()?.path().to_owned();
        let past = Terrain::open_to_read_at(&path, entry, self.terrain.settings().clone());
        let opened = past.and_then(|past| self.looker.open_past(past));
        self.everything_changed();
        opened.map(|()| Outcome::default())
    }

    fn undo_own(&mut self, ticket: Ticket) -> Result<Outcome> {
        let author = self.terrain.settings().author.clone();
        let Some(last) = self.history.last_of(&author) else { return Ok(Outcome::default()) };
        let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
        let redone = self.terrain.take_back(last, watcher)?;
        self.taken_back.entry(author).or_default().push(last);
        Ok(self.redone(redone))
    }

    fn redo_own(&mut self, ticket: Ticket) -> Result<Outcome> {
        let author = self.terrain.settings().author.clone();
        let taken = self.taken_back.entry(author.clone()).or_default();
        // Someone may have gone to where it shows again.
        while taken.pop_if(|entry| self.history.shows(*entry)).is_some() {}
        // One from before the session is what anyone's redo comes to.
        let entry = taken.last().copied().or_else(|| self.history.next_of(&author));
        let Some(entry) = entry else { return Ok(Outcome::default()) };
        let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
        let redone = self.terrain.do_again(entry, watcher)?;
        if let Some(taken) = self.taken_back.get_mut(&author) {
            taken.pop();
        }
        Ok(self.redone(redone))
    }

    fn redone(&mut self, redone: Redone) -> Outcome {
        self.changed(redone.changes);
        Outcome { entries: redone.entries, ..Outcome::default() }
    }

    /// Draws a stroke as its points come.
    fn draw(
        &mut self,
        ticket: Ticket,
        by: &By,
        mut operation: BrushOperation,
        drawn: Drawn,
    ) -> Result<Outcome> {
        if self.cancelling.is_cancelled(ticket) {
            return Err(Error::Cancelled);
        }
        if operation.brush().brush_type == BrushType::Clone {
            // What it copies from has to be known first, which all of its points tell.
            let Some(drawn) = self.all_points(ticket, by, drawn) else { return Err(Error::Cancelled) };
            let cut_after = drawn.is_cut.then_some(drawn.points.len());
            operation.set_points(drawn.points);
            let outcome = self.apply(ticket, &[Operation::Brush(operation)])?;
            return Ok(Outcome { cut_after, ..outcome });
        }
        let (grid, layout) = (self.terrain.grid(), self.terrain.store()?.layout());
        let mut hand = LiveHand {
            ticket,
            by,
            since: Instant::now(),
            grid,
            layout,
            tasks: &self.tasks,
            waiting: &mut self.waiting,
            looker: &mut self.looker,
            out: &self.out,
            cancelling: &self.cancelling,
            given: Vec::new(),
            is_lost: false,
            is_lifted: drawn.is_lifted,
            is_cut: false,
            early: drawn.points,
            was_told: false,
        };
        let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
        let drawn = self.terrain.draw(&operation, &mut hand, watcher).and_then(|applied| {
            self.terrain.flush()?;
            Ok(applied)
        });
        let LiveHand { was_told, is_cut, given, .. } = hand;
        match drawn {
            Ok(applied) => {
                if let Some(change) = applied.change {
                    self.fields_changed(&[change]);
                }
                Ok(Outcome { cut_after: is_cut.then_some(given.len()), ..Outcome::of(vec![applied]) })
            }
            Err(err) => {
                if was_told {
                    self.everything_changed();
                }
                Err(err)
            }
        }
    }

    /// The points of a stroke up to its end; `None` where it is given up. Who looks meanwhile sees the terrain without it.
    fn all_points(&mut self, ticket: Ticket, by: &By, mut drawn: Drawn) -> Option<Drawn> {
        let since = Instant::now();
        while !drawn.is_lifted {
            if self.cancelling.is_cancelled(ticket) {
                return None;
            }
            if since.elapsed() >= MAX_WAIT && self.waiting.is_waited_for(by, MAX_WAIT) {
                drawn.is_cut = true;
                break;
            }
            match self.tasks.recv_timeout(TELL_EVERY) {
                Ok(Task::Points { stroke, points }) if stroke == ticket => drawn.points.extend(points),
                Ok(Task::Lift { stroke }) if stroke == ticket => drawn.is_lifted = true,
                Err(RecvTimeoutError::Disconnected) => drawn.is_lifted = true,
                Ok(task @ Task::Close) => {
                    drawn.is_lifted = true;
                    self.waiting.push(task);
                }
                Ok(Task::Look(requests)) => {
                    let pages = self.looker.pages(&self.terrain, &requests);
                    self.out.tell(Event::Pages(or_none(pages)));
                }
                Ok(task) => self.waiting.push(task),
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
        Some(drawn)
    }

    /// Something changed, of fields; more than that for `None`.
    fn changed(&mut self, changes: Option<Vec<Change>>) {
        match changes {
            Some(changes) => self.fields_changed(&changes),
            None => self.everything_changed(),
        }
    }

    fn fields_changed(&mut self, changes: &[Change]) {
        // What was painted on a mask changes no height, and yet what is shown.
        if self.looker.shows_masks() {
            return self.everything_changed();
        }
        let Ok(layout) = self.terrain.store().map(Store::layout) else { return self.everything_changed() };
        let rects = self.looker.forget(&self.terrain.grid(), layout, changes);
        self.out.tell(Event::Changed { rects: Some(rects), is_settled: true });
    }

    fn everything_changed(&mut self) {
        self.looker.forget_all();
        self.out.tell(Event::Changed { rects: None, is_settled: true });
    }

    fn tell_status(&mut self) {
        let status = self.looker.root(&self.terrain);
        let status = status.and_then(|root| Status::of(&self.terrain, root, &mut self.history));
        match status {
            Ok(status) => self.out.tell(Event::Status(Box::new(status))),
            Err(err) => {
                let ticket = Ticket(u64::MAX);
                let (message, is_fault) = (err.to_string(), err.is_fault());
                self.out.tell(Event::Failed { ticket, message, is_cancelled: false, is_fault });
            }
        }
    }
}

const fn watcher<'a>(out: &'a Out, cancelling: &'a Cancelling, ticket: Ticket) -> Watcher<'a> {
    Watcher { ticket, out, cancelling, last_told: None }
}
