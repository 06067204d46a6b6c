//! `presets list`: all of them.

use std::fmt;

use orogeny_engine::presets::{KnownPreset, PresetOrigin};
use serde::Serialize;

use crate::output::{count, text_of, write_notices};
use crate::session::Session;

#[derive(Debug, Serialize)]
struct Report {
    folder: Option<String>,
    presets: Vec<Line>,
    notices: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Line {
    preset: String,
    brush: &'static str,
    tags: Vec<String>,
    description: String,
    #[serde(flatten)]
    origin: PresetOrigin,
}

/// Lists the presets.
///
/// # Errors
/// When standard output cannot be written.
pub(super) fn run(session: &Session) -> anyhow::Result<()> {
    let presets = session.presets();
    session.output().report(&Report {
        folder: presets.folder().map(text_of),
        presets: presets.iter().map(line_of).collect::<anyhow::Result<_>>()?,
        notices: presets.unusable().map(ToString::to_string).collect(),
    })
}

fn line_of(known: &KnownPreset) -> anyhow::Result<Line> {
    let KnownPreset { preset, origin } = known;
    Ok(Line {
        preset: preset.name.clone(),
        brush: preset.brush_type()?.name(),
        tags: preset.tags.clone(),
        description: preset.description.clone(),
        origin: origin.clone(),
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |text: fn(&Line) -> &str| {
            self.presets.iter().map(|line| text(line).chars().count()).max().unwrap_or_default()
        };
        let (name_width, brush_width) = (width(|line| &line.preset), width(|line| line.brush));
        for Line { preset, brush, tags, description, origin } in &self.presets {
            let origin = match origin {
                PresetOrigin::Factory => "",
                PresetOrigin::User { replaces_factory: false, .. } => "yours",
                PresetOrigin::User { replaces_factory: true, .. } => "yours, in the place of the program's",
            };
            let parts = [description.as_str(), &tags.join(", "), origin].map(str::to_owned);
            let rest: Vec<_> = parts.into_iter().filter(|part| !part.is_empty()).collect();
            writeln!(f, "{preset:<name_width$}  {brush:<brush_width$}  {}", rest.join("; "))?;
        }
        write_notices(f, &self.notices)?;
        let yours = self.presets.iter().filter(|line| line.origin != PresetOrigin::Factory).count() as u64;
        let folder = match &self.folder {
            Some(folder) => format!(", {yours} of them in {folder}"),
            None => String::new(),
        };
        writeln!(f, "{}{folder}", count(self.presets.len() as u64, "preset"))
    }
}
