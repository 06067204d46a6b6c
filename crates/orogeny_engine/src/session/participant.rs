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
    by: By,
}

/// Who asks for something.
#[derive(Debug, Clone)]
pub(super) struct By {
    /// Tells participants of one name apart.
    number: u64,
    /// Recorded with what is done; `None`: as the terrain's settings say.
    author: Option<Arc<str>>,
}

impl By {
    pub(super) fn author(&self) -> Option<&str> {
        self.author.as_deref()
    }

    pub(super) const fn is(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl Participant {
    pub(super) const fn new(tasks: Sender<Task>, cancelling: Arc<Cancelling>) -> Self {
        Self { tasks, cancelling, by: By { number: 0, author: None } }
    }

    pub(super) fn by(&self, author: &str) -> Self {
        let by = By { number: self.cancelling.next_number(), author: Some(author.into()) };
        Self { by, ..self.clone() }
    }

    /// Begins a stroke; of the operation, which has to be a stroke, the points are those that are given [afterwards](Self::push_points).
    /// While another one is drawn, it waits, and its points are kept.
    pub fn begin_stroke(&self, operation: BrushOperation) -> Ticket {
        let operation = Box::new(operation);
        self.give(|ticket, by| Task::Stroke { ticket, by, operation })
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
        self.give(|ticket, by| Task::Apply { ticket, by, operations })
    }

    /// Reads heights of another program's file onto a layer.
    pub fn import(&self, request: ImportRequest) -> Ticket {
        let request = Box::new(request);
        self.give(|ticket, by| Task::Import { ticket, by, request })
    }

    /// Goes back or forth in the history.
    pub fn travel(&self, travel: Travel) -> Ticket {
        self.give(|ticket, by| Task::Travel { ticket, by, travel })
    }

    /// Gives up one thing that was asked for, if it is not done yet. What is running is taken back, bit for bit.
    pub fn cancel(&self, ticket: Ticket) {
        self.cancelling.cancel(ticket);
    }

    pub(super) fn give(&self, task: impl FnOnce(Ticket, By) -> Task) -> Ticket {
        let ticket = self.cancelling.next_ticket();
        self.send(task(ticket, self.by.clone()));
        ticket
    }

    pub(super) fn send(&self, task: Task) {
        // The thread ends before the session only by a panic, which closing tells.
        self.tasks.send(task).ok();
    }
}
