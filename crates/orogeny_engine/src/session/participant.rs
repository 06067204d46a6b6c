//! One of those who work on the terrain of a session: a window, or a client of a service.

use std::sync::Arc;
use std::sync::mpsc::Sender;

use orogeny_field::PointerSample;

use super::cancelling::Cancelling;
use super::{Task, Ticket, Travel};
use crate::{BrushOperation, ImportRequest, Operation};

/// Someone who works on the terrain of a [`Session`](super::Session). What a participant asks for after the session has ended is not
/// done, and no event comes of it.
#[derive(Debug, Clone)]
pub struct Participant {
    tasks: Sender<Task>,
    cancelling: Arc<Cancelling>,
    /// Recorded with what is done; `None`: as the terrain's settings say.
    author: Option<Arc<str>>,
}

impl Participant {
    pub(super) const fn new(
        tasks: Sender<Task>,
        cancelling: Arc<Cancelling>,
        author: Option<Arc<str>>,
    ) -> Self {
        Self { tasks, cancelling, author }
    }

    pub(super) fn by(&self, author: &str) -> Self {
        Self { author: Some(author.into()), ..self.clone() }
    }

    /// Begins a stroke; of the operation, which has to be a stroke, the points are those that are given [afterwards](Self::push_points).
    /// While another one is drawn, it waits, and its points are kept.
    pub fn begin_stroke(&self, operation: BrushOperation) -> Ticket {
        let operation = Box::new(operation);
        self.give(|ticket, author| Task::Stroke { ticket, author, operation })
    }

    /// More points of a stroke.
    pub fn push_points(&self, stroke: Ticket, points: Vec<PointerSample>) {
        self.send(Task::Points { stroke, points });
    }

    /// Ends a stroke.
    pub fn lift(&self, stroke: Ticket) {
        self.send(Task::Lift { stroke });
    }

    /// Runs operations in one transaction.
    pub fn apply(&self, operations: Vec<Operation>) -> Ticket {
        self.give(|ticket, author| Task::Apply { ticket, author, operations })
    }

    /// Reads heights of another program's file onto a layer.
    pub fn import(&self, request: ImportRequest) -> Ticket {
        let request = Box::new(request);
        self.give(|ticket, author| Task::Import { ticket, author, request })
    }

    /// Goes back or forth in the history.
    pub fn travel(&self, travel: Travel) -> Ticket {
        self.give(|ticket, author| Task::Travel { ticket, author, travel })
    }

    /// Gives up one thing that was asked for, if it is not done yet. What is running is taken back, bit for bit.
    pub fn cancel(&self, ticket: Ticket) {
        self.cancelling.cancel(ticket);
    }

    pub(super) fn give(&self, task: impl FnOnce(Ticket, Option<Arc<str>>) -> Task) -> Ticket {
        let ticket = self.cancelling.next_ticket();
        self.send(task(ticket, self.author.clone()));
        ticket
    }

    pub(super) fn send(&self, task: Task) {
        // The thread ends before the session only by a panic, which closing tells.
        self.tasks.send(task).ok();
    }
}
