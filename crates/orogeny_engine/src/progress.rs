//! How far work has come, and whether to go on.

use std::ops::ControlFlow;

/// How far a piece of work has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// What is being done, for people.
    pub what: &'static str,
    /// Units done.
    pub done: u64,
    /// Units in all; 0 where that is not known.
    pub total: u64,
}

/// Someone who watches work and may stop it. Work that is stopped changes nothing.
pub trait Observer {
    /// Called every now and then; `Break` cancels.
    fn progress(&mut self, progress: Progress) -> ControlFlow<()>;
}

/// Watches nothing and never cancels.
#[derive(Debug, Clone, Copy, Default)]
pub struct Quiet;

impl Observer for Quiet {
    fn progress(&mut self, _progress: Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Tells the observer, and makes an error of its wish to stop.
pub(crate) fn report(
    observer: &mut dyn Observer,
    what: &'static str,
    done: u64,
    total: u64,
) -> crate::Result<()> {
    match observer.progress(Progress { what, done, total }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(crate::Error::Cancelled),
    }
}
