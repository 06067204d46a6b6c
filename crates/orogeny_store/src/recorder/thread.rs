//! The thread that has the terrain open for writing: one task after another, in the order in which they came.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};
use std::thread::{Builder, JoinHandle};

use orogeny_field::{Page, PageKey};

use super::state::{Shared, State};
use crate::{Committed, Error, Result, Store, Transaction};

/// What the thread is asked to do.
pub(super) enum Task {
    /// Start a transaction.
    Begin,
    /// Put pages into it, of the entry of this number.
    Write { number: u64, pages: Vec<(PageKey, Arc<Page>)> },
    /// Read a page, as it is or as it was before the entry.
    Load { key: PageKey, before: bool, reply: SyncSender<Result<Option<Arc<Page>>>> },
    /// Run something on the transaction.
    WithTransaction(Box<dyn FnOnce(&mut Transaction<'_>) + Send>),
    /// End an entry.
    Record { operation_json: String, author: String },
    /// Make the transaction durable, the entries up to this number.
    Commit { last_number: u64 },
    /// Take it back, the entries up to this number.
    Abort { last_number: u64 },
    /// Run something on the store, between transactions.
    WithStore(Box<dyn FnOnce(&mut Store) + Send>),
}

/// Tells those who wait that no one will answer any more.
struct Gone(Arc<Shared>);

impl Drop for Gone {
    fn drop(&mut self) {
        self.0.change(|state| state.is_gone = true);
    }
}

/// Starts the thread; it ends, and closes the store, when no one can send it tasks any more.
pub(super) fn start(
    store: Store,
    tasks: Receiver<Task>,
    shared: Arc<Shared>,
) -> Result<JoinHandle<Result<()>>> {
    let path = store.path().to_owned();
    Builder::new()
        .name("orogeny.store".to_owned())
        .spawn(move || serve(store, &tasks, &Gone(shared)))
        .map_err(|err| Error::Io { path, detail: err.to_string() })
}

fn serve(mut store: Store, tasks: &Receiver<Task>, gone: &Gone) -> Result<()> {
    while let Ok(task) = tasks.recv() {
        match task {
            Task::Begin => {
                let ended = serve_transaction(&mut store, tasks, &gone.0);
                let cached_bytes = store.cached_bytes();
                // Whoever waits for the end is not to see what was remembered before it.
                gone.0.change(|state| {
                    state.cached_bytes = cached_bytes;
                    ended.into_iter().for_each(|ended| ended.tell(state));
                });
            }
            Task::Load { key, reply, .. } => {
                reply.send(store.load_page(&key)).ok();
            }
            Task::WithStore(work) => work(&mut store),
            // Of a transaction that is not there: nothing is left of it to be done.
            Task::Write { .. } | Task::WithTransaction(_) | Task::Record { .. } => {}
            Task::Commit { last_number } | Task::Abort { last_number } => {
                gone.0.change(|state| state.forget_up_to(last_number))
            }
        }
        let cached_bytes = store.cached_bytes();
        gone.0.change(|state| state.cached_bytes = cached_bytes);
    }
    store.close()
}

/// How a transaction ended.
enum Ended {
    /// `None`: it had failed before, and what went wrong is known already.
    Commit {
        last_number: u64,
        result: Option<Result<Committed>>,
    },
    Abort {
        last_number: u64,
    },
}

impl Ended {
    fn tell(self, state: &mut State) {
        match self {
            Self::Abort { last_number } => state.forget_up_to(last_number),
            Self::Commit { last_number, result } => {
                state.num_commits_under_way -= 1;
                state.forget_up_to(last_number);
                match result {
                    Some(Ok(committed)) => {
                        state.dropped.entries.extend(committed.dropped.entries);
                        state.dropped.size_in_bytes += committed.dropped.size_in_bytes;
                    }
                    Some(Err(err)) => state.fail(err),
                    None => {}
                }
            }
        }
    }
}

/// One transaction, from its start to its end; `None` where no one is left to end it. After a failure its tasks are only
/// counted off.
fn serve_transaction(store: &mut Store, tasks: &Receiver<Task>, shared: &Shared) -> Option<Ended> {
    let mut transaction = match store.begin() {
        Ok(transaction) => Some(transaction),
        Err(err) => {
            shared.change(|state| state.fail(err));
            None
        }
    };
    while let Ok(task) = tasks.recv() {
        let result = match (task, &mut transaction) {
            (Task::Write { number, pages }, transaction) => {
                let written =
                    transaction.as_mut().map_or(Ok(()), |transaction| transaction.write_pages(&pages));
                shared.change(|state| state.pages_written(number, &pages));
                written
            }
            (Task::Load { key, before, reply }, Some(transaction)) => {
                let load = if before { Transaction::load_page_before } else { Transaction::load_page };
                reply.send(load(transaction, &key)).ok();
                Ok(())
            }
            (Task::WithTransaction(work), Some(transaction)) => {
                work(transaction);
                Ok(())
            }
            (Task::Record { operation_json, author }, Some(transaction)) => {
                transaction.record(&operation_json, &author).map(|_| ())
            }
            (Task::Commit { last_number }, transaction) => {
                let result = transaction.take().map(Transaction::commit_recorded);
                return Some(Ended::Commit { last_number, result });
            }
            (Task::Abort { last_number }, transaction) => {
                drop(transaction.take());
                return Some(Ended::Abort { last_number });
            }
            // The transaction has failed: whoever waits for an answer is told by the end of its channel.
            (Task::Load { .. } | Task::WithTransaction(_) | Task::Record { .. } | Task::Begin, _) => Ok(()),
            (Task::WithStore(_), _) => Ok(()),
        };
        if let Err(err) = result {
            transaction = None;
            shared.change(|state| state.fail(err));
        }
    }
    None
}
