//! The thread of a session: one task after another.

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use orogeny_field::{BrushType, PointerSample};
use orogeny_store::Store;

use super::event::{Event, Out};
use super::live_hand::LiveHand;
use super::looker::Looker;
use super::{Status, Survey, Task, Ticket, Travel};
use crate::composite::Change;
use crate::{Applied, BrushOperation, Error, Observer, Operation, Progress, Result, Terrain};

/// How often progress is told.
const TELL_EVERY: Duration = Duration::from_millis(50);

/// Knows what is given up.
pub(super) struct Cancelling(Arc<AtomicU64>);

impl Cancelling {
    pub(super) fn is_cancelled(&self, ticket: Ticket) -> bool {
        ticket.0 <= self.0.load(Ordering::SeqCst)
    }
}

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
    /// Tasks that came while a stroke was drawn.
    later: VecDeque<Task>,
    looker: Looker,
    out: Out,
    cancelling: Cancelling,
}

pub(super) fn serve(
    terrain: Terrain,
    tasks: Receiver<Task>,
    out: Out,
    cancelled: Arc<AtomicU64>,
) -> Result<()> {
    let looker = Looker::new(terrain.settings());
    let cancelling = Cancelling(cancelled);
    let mut server = Server { terrain, tasks, later: VecDeque::new(), looker, out, cancelling };
    server.tell_status();
    while let Some(task) = server.next_task() {
        server.run(task);
    }
    server.terrain.close()
}

impl Server {
    fn next_task(&mut self) -> Option<Task> {
        self.later.pop_front().or_else(|| self.tasks.recv().ok())
    }

    fn run(&mut self, task: Task) {
        let (ticket, result) = match task {
            Task::Look(requests) => match self.looker.pages(&self.terrain, &requests) {
                Ok(pages) => return self.out.tell(Event::Pages(pages)),
                // Whoever waits for the pages hears that they do not come.
                Err(err) => {
                    self.out.tell(Event::Pages(Vec::new()));
                    (Ticket(u64::MAX), Err(err))
                }
            },
            Task::Survey { ticket, max_side } => {
                let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
                match Survey::of(&self.terrain, max_side, watcher) {
                    Ok(survey) => return self.out.tell(Event::Surveyed { ticket, survey: Box::new(survey) }),
                    Err(err) => (ticket, Err(err)),
                }
            }
            Task::ShowMasks(names) => {
                self.looker.show_masks(names);
                return self.out.tell(Event::Changed { rects: None, is_settled: true });
            }
            // Of a stroke that has failed, or ended.
            Task::Points(_) | Task::Lift => return,
            Task::Stroke { ticket, operation } => (ticket, self.draw(ticket, *operation)),
            Task::Apply { ticket, operations } => (ticket, self.apply(ticket, &operations)),
            Task::Travel { ticket, travel } => (ticket, self.travel(travel)),
            Task::Export { ticket, request } => {
                let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
                (ticket, self.terrain.export(&request, watcher).map(|_| Vec::new()))
            }
            Task::Import { ticket, request } => {
                let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
                let imported = self.terrain.import(&request, watcher).map(|_| Vec::new());
                self.everything_changed();
                (ticket, imported)
            }
        };
        match result {
            Ok(applied) => self.out.tell(Event::Done { ticket, applied }),
            Err(err) => {
                let is_cancelled = matches!(err, Error::Cancelled);
                self.out.tell(Event::Failed { ticket, message: err.to_string(), is_cancelled });
            }
        }
        self.tell_status();
    }

    fn apply(&mut self, ticket: Ticket, operations: &[Operation]) -> Result<Vec<Applied>> {
        if self.cancelling.is_cancelled(ticket) {
            return Err(Error::Cancelled);
        }
        let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
        let applied = self.terrain.apply(operations, watcher)?;
        match applied.iter().map(|applied| applied.change).collect::<Option<Vec<_>>>() {
            Some(changes) => self.fields_changed(&changes),
            None => self.everything_changed(),
        }
        Ok(applied)
    }

    fn travel(&mut self, travel: Travel) -> Result<Vec<Applied>> {
        let changes = match travel {
            Travel::Undo(count) => self.terrain.undo(count),
            Travel::Redo(count) => self.terrain.redo(count),
            Travel::Jump(entry) => self.terrain.jump(entry),
        }?;
        if changes.iter().any(|change| change.layers_changed) {
            self.everything_changed();
        } else {
            let layout = self.terrain.store()?.layout();
            let pages: Vec<_> = changes.into_iter().flat_map(|change| change.pages).collect();
            self.fields_changed(&Change::of_pages(layout, &pages));
        }
        Ok(Vec::new())
    }

    /// Draws a stroke as its points come.
    fn draw(&mut self, ticket: Ticket, mut operation: BrushOperation) -> Result<Vec<Applied>> {
        if operation.brush().brush_type == BrushType::Clone {
            // What it copies from has to be known first, which all of its points tell.
            let Some(points) = self.all_points(ticket)? else { return Err(Error::Cancelled) };
            operation.set_points(points);
            return self.apply(ticket, &[Operation::Brush(operation)]);
        }
        let (grid, layout) = (self.terrain.grid(), self.terrain.store()?.layout());
        let mut hand = LiveHand {
            ticket,
            grid,
            layout,
            tasks: &self.tasks,
            later: &mut self.later,
            looker: &mut self.looker,
            out: &self.out,
            cancelling: &self.cancelling,
            given: Vec::new(),
            is_lost: false,
            is_lifted: false,
            was_told: false,
        };
        let watcher = &mut watcher(&self.out, &self.cancelling, ticket);
        let drawn = self.terrain.draw(&operation, &mut hand, watcher).and_then(|applied| {
            self.terrain.flush()?;
            Ok(applied)
        });
        let was_told = hand.was_told;
        match drawn {
            Ok(applied) => {
                if let Some(change) = applied.change {
                    self.fields_changed(&[change]);
                }
                Ok(vec![applied])
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
    fn all_points(&mut self, ticket: Ticket) -> Result<Option<Vec<PointerSample>>> {
        let mut all = Vec::new();
        let is_cancelled = loop {
            match self.tasks.recv_timeout(TELL_EVERY) {
                _ if self.cancelling.is_cancelled(ticket) => break true,
                Ok(Task::Points(points)) => all.extend(points),
                Ok(Task::Lift) | Err(RecvTimeoutError::Disconnected) => break false,
                Ok(Task::Look(requests)) => {
                    let pages = self.looker.pages(&self.terrain, &requests)?;
                    self.out.tell(Event::Pages(pages));
                }
                Ok(task) => self.later.push_back(task),
                Err(RecvTimeoutError::Timeout) => {}
            }
        };
        Ok((!is_cancelled).then_some(all))
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
        let status = self.looker.root(&self.terrain).and_then(|root| Status::of(&self.terrain, root));
        match status {
            Ok(status) => self.out.tell(Event::Status(Box::new(status))),
            Err(err) => {
                let ticket = Ticket(u64::MAX);
                self.out.tell(Event::Failed { ticket, message: err.to_string(), is_cancelled: false });
            }
        }
    }
}

const fn watcher<'a>(out: &'a Out, cancelling: &'a Cancelling, ticket: Ticket) -> Watcher<'a> {
    Watcher { ticket, out, cancelling, last_told: None }
}
