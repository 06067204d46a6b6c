//! What the painting and the thread that writes know of each other: the pages on their way.

use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use orogeny_field::{Page, PageKey};

use crate::{Dropped, Error};

/// Where a page is that is not on disk yet.
#[derive(Debug, Clone)]
pub(super) enum Kept {
    /// The thread has not come to it.
    InMemory(Arc<Page>),
    /// In the transaction that is not committed, which only the thread sees.
    InTransaction,
}

/// Pages of an entry that is not on disk yet.
#[derive(Debug)]
struct Entry {
    number: u64,
    pages: HashMap<PageKey, Kept>,
}

#[derive(Debug, Default)]
pub(super) struct State {
    /// The oldest first; the last one is being painted.
    entries: VecDeque<Entry>,
    last_number: u64,
    /// Bytes of pages that the thread has not come to.
    pub(super) pending_bytes: u64,
    /// Bytes of pages that the thread remembers.
    pub(super) cached_bytes: u64,
    pub(super) num_commits_under_way: u32,
    /// What first went wrong since it was last asked for.
    pub(super) failure: Option<Error>,
    pub(super) dropped: Dropped,
    /// The thread has ended.
    pub(super) is_gone: bool,
}

#[derive(Debug, Default)]
pub(super) struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

fn size_of(page: &Page) -> u64 {
    page.samples().len() as u64 * 4
}

/// What pages leave of so many bytes.
fn room_beside(pages: &[(PageKey, Arc<Page>)], max_pending_bytes: u64) -> u64 {
    max_pending_bytes.saturating_sub(pages.iter().map(|(_, page)| size_of(page)).sum())
}

impl State {
    /// Opens an entry and gives its number.
    pub(super) fn add_entry(&mut self) -> u64 {
        self.last_number += 1;
        self.entries.push_back(Entry { number: self.last_number, pages: HashMap::new() });
        self.last_number
    }

    pub(super) fn add_pages(&mut self, number: u64, pages: &[(PageKey, Arc<Page>)]) {
        if let Some(entry) = self.entries.iter_mut().find(|entry| entry.number == number) {
            let kept = pages.iter().map(|(key, page)| (*key, Kept::InMemory(Arc::clone(page))));
            entry.pages.extend(kept);
        }
        self.pending_bytes += pages.iter().map(|(_, page)| size_of(page)).sum::<u64>();
    }

    /// Pages changed within the transaction, by the thread alone, as an entry before the one that is being painted; gives the number of
    /// the latter.
    pub(super) fn add_changed(&mut self, number: u64, pages: &[PageKey]) -> u64 {
        if let Some(entry) = self.entries.iter_mut().find(|entry| entry.number == number) {
            entry.pages.extend(pages.iter().map(|key| (*key, Kept::InTransaction)));
        }
        self.add_entry()
    }

    /// Where a page is, as the last entry before `before` left it (as the last of all for `None`); `None`: on disk.
    pub(super) fn kept(&self, key: &PageKey, before: Option<u64>) -> Option<Kept> {
        let is_asked_for = |entry: &&Entry| before.is_none_or(|before| entry.number < before);
        self.entries.iter().rev().filter(is_asked_for).find_map(|entry| entry.pages.get(key).cloned())
    }

    /// Whether an entry from `since` on painted a page.
    pub(super) fn is_painted_since(&self, key: &PageKey, since: u64) -> bool {
        self.entries.iter().any(|entry| entry.number >= since && entry.pages.contains_key(key))
    }

    /// Pages have reached the transaction.
    pub(super) fn pages_written(&mut self, number: u64, pages: &[(PageKey, Arc<Page>)]) {
        self.pending_bytes -= pages.iter().map(|(_, page)| size_of(page)).sum::<u64>();
        let Some(entry) = self.entries.iter_mut().find(|entry| entry.number == number) else { return };
        for (key, page) in pages {
            // It may have been painted again since.
            if let Some(kept) = entry.pages.get_mut(key)
                && matches!(kept, Kept::InMemory(newest) if Arc::ptr_eq(newest, page))
            {
                *kept = Kept::InTransaction;
            }
        }
    }

    /// Entries up to this one are on disk, or taken back.
    pub(super) fn forget_up_to(&mut self, number: u64) {
        self.entries.retain(|entry| entry.number > number);
    }

    /// Keeps what went wrong until someone asks, and tells whether it is the first thing that did.
    pub(super) fn fail(&mut self, err: Error) -> bool {
        let is_first = self.failure.is_none();
        self.failure.get_or_insert(err);
        is_first
    }
}

impl Shared {
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        // A panic elsewhere leaves it as it was between two of its own functions.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state and wakes whoever waits for it.
    pub(super) fn change(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.lock());
        self.changed.notify_all();
    }

    /// Waits until all commits under way have ended, well or not.
    pub(super) fn wait_until_durable(&self) {
        self.wait_while(|state| state.num_commits_under_way > 0);
    }

    /// Waits until these pages fit into so many bytes beside those on their way; for nothing where they are more than that.
    pub(super) fn wait_for_room(&self, pages: &[(PageKey, Arc<Page>)], max_pending_bytes: u64) {
        let room = room_beside(pages, max_pending_bytes);
        self.wait_while(|state| state.pending_bytes > room && state.failure.is_none());
    }

    /// Whether these pages need not wait.
    pub(super) fn has_room(&self, pages: &[(PageKey, Arc<Page>)], max_pending_bytes: u64) -> bool {
        self.lock().pending_bytes <= room_beside(pages, max_pending_bytes)
    }

    /// Waits until the thread has dropped an entry.
    pub(super) fn wait_until_taken_back(&self, number: u64) {
        self.wait_while(|state| state.entries.iter().any(|entry| entry.number == number));
    }

    fn wait_while(&self, is_to_wait: impl Fn(&State) -> bool) {
        let state = self.lock();
        let waited = self.changed.wait_while(state, |state| !state.is_gone && is_to_wait(state));
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }
}
