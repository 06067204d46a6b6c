//! The brush that a layer is made by, as it is given on the command line.

use std::io::Read as _;
use std::path::Path;

use anyhow::{anyhow, ensure};
use orogeny_engine::{Presets, Procedure};
use serde_json::{Map, Value};

/// The longest file of a brush, in bytes: a preset's is no longer.
const MAX_BRUSH_BYTES: u64 = 1 << 20;

/// A brush: the object itself, a file that holds it, or the name of a preset.
#[derive(Debug, Clone)]
pub(super) enum BrushArgument {
    Object(Map<String, Value>),
    FileOrPreset(String),
}

/// Reads a brush.
///
/// # Errors
/// What is wrong with JSON that is no object.
pub(super) fn brush(text: &str) -> Result<BrushArgument, String> {
    if !text.trim_start().starts_with(['{', '[']) {
        return Ok(BrushArgument::FileOrPreset(text.to_owned()));
    }
    serde_json::from_str(text)
        .map(BrushArgument::Object)
        .map_err(|err| format!("it is no JSON object: {err}"))
}

impl BrushArgument {
    /// Makes what a layer is made by of it. Files that it names are looked for beside the file that it was read from.
    ///
    /// # Errors
    /// When a file cannot be read, there is no preset of the name, or the brush cannot be understood, naming the field.
    pub(super) fn procedure(&self, seed: u32, presets: &Presets) -> anyhow::Result<Procedure> {
        let brush = match self {
            Self::Object(object) => presets.brush(object)?,
            Self::FileOrPreset(name) if is_file(name) => {
                let path = Path::new(name);
                presets.brush_in(&read(path)?, path.parent().unwrap_or(Path::new("")))?
            }
            Self::FileOrPreset(name) => {
                presets.brush(&Map::from_iter([("preset".to_owned(), Value::from(name.as_str()))]))?
            }
        };
        Ok(Procedure { brush: Box::new(brush), seed })
    }
}

/// Whether a name is a file's, there or not; those of presets have no folder and no ending.
fn is_file(name: &str) -> bool {
    name.ends_with(".json") || name.contains(['/', '\\']) || Path::new(name).is_file()
}

fn read(path: &Path) -> anyhow::Result<Map<String, Value>> {
    let failed =
        |err: &dyn std::fmt::Display| anyhow!("the brush `{}` could not be read: {err}", path.display());
    let mut text = String::new();
    let file = std::fs::File::open(path).map_err(|err| failed(&err))?;
    let length = file.take(MAX_BRUSH_BYTES + 1).read_to_string(&mut text).map_err(|err| failed(&err))?;
    ensure!(
        length as u64 <= MAX_BRUSH_BYTES,
        "the brush `{}` is longer than {MAX_BRUSH_BYTES} bytes",
        path.display()
    );
    serde_json::from_str(&text).map_err(|err| failed(&format!("it is no JSON object: {err}")))
}
