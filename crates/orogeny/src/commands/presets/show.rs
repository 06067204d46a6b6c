//! `presets show`: one of them, as its file holds it.

use std::fmt;

use orogeny_engine::Preset;
use serde::Serialize;

use crate::session::Session;

/// JSON either way: this is what a preset is.
#[derive(Debug, Serialize)]
#[serde(transparent)]
struct Report(Preset);

/// Shows a preset.
///
/// # Errors
/// When there is none of that name.
pub(super) fn run(name: &str, session: &Session) -> anyhow::Result<()> {
    session.output().report(&Report(session.presets().get(name)?.preset.clone()))
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.to_json_text().map_err(|_| fmt::Error)?)
    }
}
