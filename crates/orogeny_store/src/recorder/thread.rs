//! The thread that has the terrain open for writing: one task after another, in the order in which they came.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};
use std::thread::{Builder, JoinHandle};

use orogeny_field::{Page, PageKey};
use rayon::ThreadPoolBuilder;

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
    let failed = |detail: String| Error::Io { path: path.clone(), detail };
    // With cores of its own: whoever works out what is seen would else wait behind pages that are coded.
    let cores = ThreadPoolBuilder::new()
        .thread_name(|index| format!("orogeny.store.{index}"))
        .build()
        .map_err(|err| failed(err.to_string()))?;
    Builder::new()
        .name("orogeny.store".to_owned())
        .spawn(move || cores.install(move || serve(store, &tasks, &Gone(shared))))
        .map_err(|err| failed(err.to_string()))
}

fn serve(mut store: Store, tasks: &Receiver<Task>, gone: &Gone) -> Result<()> {
    while let Ok(task) = tasks.recv() {
        let ended = match task {
            Task::Begin => serve_transaction(&mut store, tasks, &gone.0),
            Task::Load { key, reply, .. } => {
                reply.send(store.load_page(&key)).ok();
                None
            }
            Task::WithStore(work) => {
                work(&mut store);
                None
            }
            // Of a transaction that is not there: nothing is left of it to be done.
            Task::Write { .. } | Task::WithTransaction(_) | Task::Record { .. } => None,
            Task::Commit { last_number } => Some(Ended::Commit { last_number, result: None }),
            Task::Abort { last_number } => Some(Ended::Abort { last_number, is_failure_ours: false }),
        };
        // Together with the end, so that whoever has waited for that is told the right size.
        let cached_bytes = store.cached_bytes();
        gone.0.change(|state| {
            state.cached_bytes = cached_bytes;
            if let Some(ended) = ended {
                ended.tell(state);
            }
        });
    }
    store.close()
}

/// How a transaction ended.
enum Ended {
    /// `None`: it had failed before, and what went wrong is known already.
    Commit { last_number: u64, result: Option<Result<Committed>> },
    /// With whether the failure that is kept, should no one have asked for it yet, is of this transaction.
    Abort { last_number: u64, is_failure_ours: bool },
}

impl Ended {
    fn tell(self, state: &mut State) {
        match self {
            Self::Commit { last_number, result } => {
                state.num_commits_under_way -= 1;
                state.forget_up_to(last_number);
                match result {
                    Some(Ok(committed)) => state.dropped.extend(committed.dropped),
                    Some(Err(err)) => _ = state.fail(err),
                    None => {}
                }
            }
            Self::Abort { last_number, is_failure_ours } => {
                state.forget_up_to(last_number);
                // What was taken back anyway concerns no one; what failed before it does.
                if is_failure_ours {
                    state.failure = None;
                }
            }
        }
    }
}

/// One transaction, from its start to its end; `None` where no one is left to end it. After a failure its tasks are only
/// counted off.
fn serve_transaction(store: &mut Store, tasks: &Receiver<Task>, shared: &Shared) -> Option<Ended> {
    let mut is_failure_ours = false;
    let fail = |is_ours: &mut bool, err| shared.change(|state| *is_ours |= state.fail(err));
    let mut transaction = match store.begin() {
        Ok(transaction) => Some(transaction),
        Err(err) => {
            fail(&mut is_failure_ours, err);
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
                return Some(Ended::Abort { last_number, is_failure_ours });
            }
            // The transaction has failed: whoever waits for an answer is told by the end of its channel.
            (Task::Load { .. } | Task::WithTransaction(_) | Task::Record { .. } | Task::Begin, _) => Ok(()),
            (Task::WithStore(_), _) => Ok(()),
        };
        if let Err(err) = result {
            transaction = None;
            fail(&mut is_failure_ours, err);
        }
    }
    None
}
