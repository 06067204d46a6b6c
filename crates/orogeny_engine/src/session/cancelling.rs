//! What was asked for, and what of it is given up.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use super::Ticket;

/// Numbers what is asked for, and knows what is given up.
#[derive(Debug, Default)]
pub(super) struct Cancelling {
    last_ticket: AtomicU64,
    /// The last number of a participant.
    last_number: AtomicU64,
    /// All tickets up to this one.
    all_up_to: AtomicU64,
    /// Further ones, until they are done.
    some: Mutex<BTreeSet<Ticket>>,
}

impl Cancelling {
    pub(super) fn next_ticket(&self) -> Ticket {
        Ticket(self.last_ticket.fetch_add(1, Ordering::SeqCst) + 1)
    }

    pub(super) fn next_number(&self) -> u64 {
        self.last_number.fetch_add(1, Ordering::SeqCst) + 1
    }

    pub(super) fn cancel(&self, ticket: Ticket) {
        self.with_some(|some| some.insert(ticket));
    }

    pub(super) fn cancel_all(&self) {
        self.all_up_to.store(self.last_ticket.load(Ordering::SeqCst), Ordering::SeqCst);
    }

    pub(super) fn is_cancelled(&self, ticket: Ticket) -> bool {
        ticket.0 <= self.all_up_to.load(Ordering::SeqCst) || self.with_some(|some| some.contains(&ticket))
    }

    /// It is done, or never will be: no one asks for it any more.
    pub(super) fn forget(&self, ticket: Ticket) {
        self.with_some(|some| some.remove(&ticket));
    }

    fn with_some<T>(&self, work: impl FnOnce(&mut BTreeSet<Ticket>) -> T) -> T {
        // A set is as good after a panic as before.
        work(&mut self.some.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
