//! `undo`: takes back the last operations.

use orogeny_engine::Terrain;

pub use super::travel::Arguments;
use crate::session::Session;

/// Undoes.
///
/// # Errors
/// When the history cannot be trusted or the file not be written; the terrain is then as it was.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    super::travel::run(arguments, session, "undone", Terrain::undo)
}
