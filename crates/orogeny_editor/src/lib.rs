//! The editor: a window in which a designer paints a terrain and sees it at once.
//!
//! It stands on the engine alone: a [`Session`](orogeny_engine::session::Session) works on the terrain on its own thread, a
//! [`LiveView`](orogeny_engine::LiveView) draws what has arrived, and both tell of each other only by events. No frame waits for
//! work.
//!
//! [`Editor`] is all of it but the window: it is given input and drawn by egui, in the program's window ([`run`]) as in tests.
//! Whatever can be done is a [`Command`]: menus, keys, the command palette and tests all give those.

mod actions;
mod camera;
mod command;
mod comparing;
mod document;
mod editor;
mod error;
mod hand;
mod keymap;
mod log;
mod look;
mod measure;
mod outline;
mod overview;
mod own_brushes;
mod pane;
mod panels;
mod piece;
mod preferences;
mod previews;
mod quality;
mod thumbnails;
mod tool;
mod viewport;
mod window;

pub use camera::CameraControl;
pub use command::Command;
pub use editor::{Editor, EditorOptions};
pub use error::{Error, Result};
pub use hand::Hand;
pub use keymap::{Habit, Keymap};
pub use log::{Log, LogLine};
pub use measure::Measurement;
pub use piece::Piece;
pub use preferences::Preferences;
pub use window::run;
