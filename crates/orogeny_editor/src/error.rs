//! Why the editor could not start or go on.

use std::path::PathBuf;

/// The result of what the editor does.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What went wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The engine could not do it.
    #[error(transparent)]
    Engine(#[from] orogeny_engine::Error),
    /// There is no window to be had. Start it where there is a screen.
    #[error(
        "no window can be opened: {detail}; start it on a desktop, or work by the other commands, which need none"
    )]
    Window {
        /// What the system said.
        detail: String,
    },
    /// The preferences could not be read or written; the editor goes on with what it has.
    #[error("the preferences in `{}` cannot be used: {detail}", path.display())]
    Preferences {
        /// Their file.
        path: PathBuf,
        /// Why.
        detail: String,
    },
}
