//! Who goes first: pages on their way to the file are coded on all cores, and give way to whoever looks at the terrain meanwhile.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long coding gives way at most: whoever looks at the terrain all the time does not keep it from the disk.
const MAX_HELD: Duration = Duration::from_millis(50);

/// How long coding waits for whoever has painted to look at it.
const MAX_UNSEEN: Duration = Duration::from_millis(10);

/// Whether pages are coded now.
#[derive(Debug, Default)]
pub(crate) struct Pace {
    held_until: Mutex<Option<Instant>>,
    changed: Condvar,
}

/// Keeps pages on their way to the file from being coded while it lives, for up to 50 ms.
#[derive(Debug)]
pub struct GivingWay<'recorder>(&'recorder Pace);

impl Pace {
    /// Has coding give way from here on.
    pub(crate) fn give_way(&self) -> GivingWay<'_> {
        *self.lock() = Some(Instant::now() + MAX_HELD);
        GivingWay(self)
    }

    /// Has coding wait a moment for someone to look at what was painted.
    pub(crate) fn wait_for_look(&self) {
        *self.lock() = Some(Instant::now() + MAX_UNSEEN);
    }

    /// Coding goes on at once: someone waits for it.
    pub(crate) fn go_on(&self) {
        *self.lock() = None;
        self.changed.notify_all();
    }

    /// To be called before each page that is coded: returns when it may be.
    pub(crate) fn wait(&self) {
        let mut held_until = self.lock();
        while let Some(end) = *held_until {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                *held_until = None;
                self.changed.notify_all();
                return;
            }
            let waited = self.changed.wait_timeout(held_until, left);
            held_until = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn lock(&self) -> MutexGuard<'_, Option<Instant>> {
        self.held_until.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for GivingWay<'_> {
    fn drop(&mut self) {
        self.0.go_on();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_gives_way_goes_on_when_no_one_looks_any_more_or_someone_waits_or_it_took_too_long() {
        let pace = Pace::default();
        pace.wait();
        let giving_way = pace.give_way();
        std::thread::scope(|scope| {
            let coding = scope.spawn(|| pace.wait());
            drop(giving_way);
            coding.join().unwrap();
        });
        let _giving_way = pace.give_way();
        pace.go_on();
        pace.wait();
        let _giving_way = pace.give_way();
        // No one lets it go on.
        pace.wait();
        pace.wait_for_look();
        pace.wait();
    }
}
