//! What is left of a session whose thread panicked: it does nothing more, and answers all who ask, so that no one waits for ever.

use std::any::Any;
use std::sync::mpsc::Receiver;

use super::event::{Event, Out};
use super::waiting::Waiting;
use super::{Task, Ticket};
use crate::Error;

/// A session that is over, though its owner has not closed it yet.
pub(super) struct Panicked {
    message: String,
    out: Out,
}

impl Panicked {
    pub(super) fn new(panic: &(dyn Any + Send), out: Out) -> Self {
        let said = panic.downcast_ref::<&str>().copied();
        let said =
            said.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
        Self {
            message: format!(
                "the program has a fault and stopped working on this terrain ({said}); all that was done before is on disk: \
                 open the terrain again"
            ),
            out,
        }
    }

    /// The error that closing comes to.
    pub(super) fn error(&self) -> Error {
        Error::Thread { detail: self.message.clone() }
    }

    /// Answers what was under way, what waited, and all that is still asked, until the session is closed.
    pub(super) fn answer(&self, running: Option<Ticket>, mut waiting: Waiting, tasks: &Receiver<Task>) {
        // Who looked while it panicked is answered too; who did not, asked for none of these.
        self.out.tell(Event::Pages(Vec::new()));
        if let Some(ticket) = running {
            self.refuse(ticket);
        }
        while let Some(task) = waiting.pop().or_else(|| tasks.recv().ok()) {
            match task {
                Task::Close => break,
                Task::Look(_) => self.out.tell(Event::Pages(Vec::new())),
                task => {
                    if let Some(ticket) = task.ticket() {
                        self.refuse(ticket);
                    }
                }
            }
        }
    }

    fn refuse(&self, ticket: Ticket) {
        let message = self.message.clone();
        self.out.tell(Event::Failed { ticket, message, is_cancelled: false, is_fault: true });
    }
}

#[cfg(test)]
mod tests;
