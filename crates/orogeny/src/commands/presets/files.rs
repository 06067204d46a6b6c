//! `presets export`, `import`, `save` and `remove`: presets as files.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::Args;
use orogeny_engine::presets::{KnownPreset, PresetOrigin};
use orogeny_engine::{Preset, Presets};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::output::text_of;
use crate::session::Session;

/// What `presets save` takes.
#[derive(Debug, Args)]
pub(super) struct Save {
    /// The name: 1 to 64 characters
    name: String,
    /// The brush object, as recipes hold it: '{"type": "raise", "radius": 40}'; it may name another preset
    #[arg(long, value_name = "JSON", value_parser = brush_object)]
    brush: BrushObject,
    /// What it is for
    #[arg(long, value_name = "TEXT", default_value = "")]
    description: String,
    /// A word to find it by; may be given several times
    #[arg(long = "tag", value_name = "WORD")]
    tags: Vec<String>,
    /// Replace one of yours that has the same name
    #[arg(long)]
    replace: bool,
}

/// The brush object, not yet looked at.
#[derive(Debug, Clone)]
struct BrushObject(Map<String, Value>);

fn brush_object(text: &str) -> Result<BrushObject, String> {
    serde_json::from_str(text).map(BrushObject).map_err(|err| format!("it is no JSON object: {err}"))
}

/// What became of a preset.
#[derive(Debug, Serialize)]
struct Report {
    preset: String,
    file: String,
    done: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<&'static str>,
}

/// Writes a preset with its picture to a file.
///
/// # Errors
/// When there is none of that name, or the file cannot be written.
pub(super) fn export(name: &str, file: &Path, session: &Session) -> anyhow::Result<()> {
    let preset = session.presets().get(name)?.preset.with_thumbnail()?;
    preset.write(file)?;
    let (preset, file) = (preset.name, text_of(file));
    session.output().report(&Report { preset, file, done: "exported", note: None })
}

/// Takes a preset from a file into the user's.
///
/// # Errors
/// When it cannot be used, or there is one of that name.
pub(super) fn import(file: &Path, replace: bool, session: &Session) -> anyhow::Result<()> {
    keep(&Preset::read(file)?, replace, "imported", session, session.presets())
}

/// Saves a brush under a name.
///
/// # Errors
/// When the brush or the name cannot be used, or there is one of that name.
pub(super) fn save(arguments: &Save, session: &Session) -> anyhow::Result<()> {
    let Save { name, brush: BrushObject(brush), description, tags, replace } = arguments;
    let presets = session.presets();
    let brush = presets.brush_object(brush)?;
    let preset = Preset { description: description.clone(), tags: tags.clone(), ..Preset::new(name, brush)? };
    keep(&preset, *replace, "saved", session, presets)
}

fn keep(
    preset: &Preset,
    replace: bool,
    done: &'static str,
    session: &Session,
    mut presets: Presets,
) -> anyhow::Result<()> {
    let file = text_of(&presets.save(preset, replace)?);
    let note = match &presets.get(&preset.name)?.origin {
        PresetOrigin::User { replaces_factory: true, .. } => {
            Some("it stands in for the one of that name that comes with the program")
        }
        _ => None,
    };
    session.output().report(&Report { preset: preset.name.clone(), file, done, note })
}

/// Removes one of the user's.
///
/// # Errors
/// When there is none of that name, or it comes with the program.
pub(super) fn remove(name: &str, session: &Session) -> anyhow::Result<()> {
    let mut presets = session.presets();
    let file: PathBuf = presets.remove(name)?;
    let note = match presets.get(name) {
        Ok(KnownPreset { .. }) => Some("the one of that name that comes with the program is there again"),
        Err(_) => None,
    };
    session.output().report(&Report { preset: name.to_owned(), file: text_of(&file), done: "removed", note })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { preset, file, done, note } = self;
        if let Some(note) = note {
            writeln!(f, "note: {note}")?;
        }
        writeln!(f, "{done} `{preset}`: {file}")
    }
}
