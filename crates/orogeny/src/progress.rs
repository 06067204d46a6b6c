//! A progress bar on a terminal, nothing in a pipe; and the way a Ctrl-C reaches the work.

use std::ops::ControlFlow;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use orogeny_engine::{Observer, Progress};

use crate::cancel;

/// Watches one piece of work after another; the bar goes when it is dropped.
#[derive(Debug)]
pub struct ProgressWatch {
    bar: ProgressBar,
    shown: Option<(&'static str, bool)>,
}

impl ProgressWatch {
    /// A bar on standard error, where that is a terminal.
    pub fn new() -> Self {
        cancel::watch();
        let bar = ProgressBar::no_length();
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar, shown: None }
    }

    /// Another kind of work begins: another bar.
    fn show(&mut self, what: &'static str, has_total: bool) {
        if self.shown == Some((what, has_total)) {
            return;
        }
        let template = match has_total {
            true => "{msg:>10} {wide_bar} {percent:>3} % {eta:>4}",
            false => "{msg:>10} {spinner} {human_pos} {elapsed:>4}",
        };
        match ProgressStyle::with_template(template) {
            Ok(style) => self.bar.set_style(style),
            Err(err) => tracing::warn!("the progress bar has a bad template: {err}"),
        }
        self.bar.set_message(what);
        self.bar.reset();
        self.shown = Some((what, has_total));
    }
}

impl Observer for ProgressWatch {
    fn progress(&mut self, progress: Progress) -> ControlFlow<()> {
        let has_total = progress.total > 0;
        self.show(progress.what, has_total);
        if has_total {
            self.bar.set_length(progress.total);
        }
        self.bar.set_position(progress.done);
        if cancel::is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl Drop for ProgressWatch {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
