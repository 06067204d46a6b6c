//! Ctrl-C (and a request to terminate): the first asks the running work to stop and change nothing, the second ends the
//! program at once, which the terrain file survives.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

static IS_REQUESTED: AtomicBool = AtomicBool::new(false);
static WATCH: Once = Once::new();

/// Watches from here on. Until then a Ctrl-C ends the program as usual.
pub fn watch() {
    WATCH.call_once(|| {
        let watched = ctrlc::set_handler(|| {
            if IS_REQUESTED.swap(true, Ordering::SeqCst) {
                std::process::exit(i32::from(crate::FAILED));
            }
        });
        if let Err(err) = watched {
            tracing::warn!("Ctrl-C cannot be watched, it will end the program at once: {err}");
        }
    });
}

/// Waits until the user wants the work to stop.
pub fn wait() {
    watch();
    while !is_requested() {
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
}

/// Whether the user wants the work to stop.
pub fn is_requested() -> bool {
    IS_REQUESTED.load(Ordering::SeqCst)
}
