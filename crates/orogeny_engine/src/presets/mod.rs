//! Presets: brushes under names, those that come with the program and those of the user.
//!
//! A preset is a JSON file: `{"preset": "Alpine ridge", "description": "…", "tags": ["mountain"], "brush": {…}}`. The brush
//! object is kept as it was written. Presets are told apart by the letters and digits of their names, so capitals and
//! punctuation do not matter, and a preset of the user's stands in for one of the program's with the same name.

mod exports;
mod factory;
mod folder;
mod gallery;
mod name;
mod own;
mod preset;
mod sample;
mod thumbnail;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use orogeny_field::Brush;
use serde_json::{Map, Value};

pub use exports::{ExportPreset, ExportPresets, ExportProgram, ExportRange, ExportSizes, PlannedExport};
pub use folder::{user_folder, user_presets_folder};
pub use gallery::Gallery;
pub use preset::Preset;
pub use sample::{Sample, SampleGround, SampleKind};

use crate::{Error, Result, resources};

/// Where a preset comes from.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case", tag = "from")]
pub enum PresetOrigin {
    /// It comes with the program.
    Factory,
    /// It is the user's.
    User {
        /// Its file.
        file: PathBuf,
        /// Whether it stands in for one that comes with the program.
        replaces_factory: bool,
    },
}

/// A preset and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownPreset {
    /// What it is.
    pub preset: Preset,
    /// Where it comes from.
    pub origin: PresetOrigin,
}

/// All presets there are.
#[derive(Debug, Default)]
pub struct Presets {
    /// By what tells them apart.
    known: BTreeMap<String, KnownPreset>,
    /// Files of the user's that cannot be used, or the folder itself, and why.
    unusable: BTreeMap<PathBuf, Error>,
    /// Where the user's are kept.
    folder: Option<PathBuf>,
}

static FACTORY: LazyLock<Presets> =
    LazyLock::new(|| Presets { known: factory::presets(), ..Presets::default() });

impl Presets {
    /// Those that come with the program.
    #[must_use]
    pub fn factory() -> &'static Self {
        &FACTORY
    }

    /// Those that come with the program and those in a folder, which need not be there. A file in it that cannot be used is
    /// in the way of nothing but its own name, and a folder that cannot be read of nothing but names: see
    /// [`Self::unusable`].
    #[must_use]
    pub fn open(folder: Option<PathBuf>) -> Self {
        let mut presets = Self { known: Self::factory().known.clone(), unusable: BTreeMap::new(), folder };
        let Some(folder) = &presets.folder else { return presets };
        match folder::files(folder) {
            Err(err) => _ = presets.unusable.insert(folder.clone(), err),
            Ok(files) => {
                for file in files {
                    match folder::read(&file) {
                        Ok(preset) => presets.take_in(preset, file),
                        Err(err) => _ = presets.unusable.insert(file, err),
                    }
                }
            }
        }
        presets
    }

    /// In the order of their names.
    pub fn iter(&self) -> impl Iterator<Item = &KnownPreset> {
        self.known.values()
    }

    /// Why files of the user's, or the whole folder, cannot be used.
    pub fn unusable(&self) -> impl Iterator<Item = &Error> {
        self.unusable.values()
    }

    /// Where the user's are kept.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The preset of a name; capitals and punctuation do not matter.
    ///
    /// # Errors
    /// [`Error::UnknownPreset`] with names that are near; [`Error::Preset`] for a name that no preset can have, or when the
    /// user's file of that name cannot be used: what it should have stood in for is not taken in its place.
    pub fn get(&self, name: &str) -> Result<&KnownPreset> {
        name::check(name).map_err(|detail| preset::unusable("the preset".to_owned(), detail))?;
        let key = name::slug(name);
        // What cannot be read could stand in for a preset of the program.
        let in_the_way = [self.folder.clone(), self.file_of(&key)];
        if let Some(err) = in_the_way.iter().flatten().find_map(|path| self.unusable.get(path)) {
            return Err(preset::unusable(format!("the preset `{name}`"), err.to_string()));
        }
        self.known.get(&key).ok_or_else(|| self.unknown(name))
    }

    /// Where the user's preset of a key is, or would be.
    fn file_of(&self, key: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(folder::file_name(key)))
    }

    fn unknown(&self, name: &str) -> Error {
        let near = name::near(name, self.known.values().map(|known| known.preset.name.as_str()));
        let advice = match near.is_empty() {
            false => {
                let quoted: Vec<_> = near.iter().map(|name| format!("`{name}`")).collect();
                format!("near it are {}", quoted.join(", "))
            }
            true => format!("none of the {} that `presets` lists is near it", self.known.len()),
        };
        let advice = match (&self.folder, self.unusable.len()) {
            (Some(folder), 0) => format!("{advice} (those of the user are in `{}`)", folder.display()),
            (Some(folder), number) => {
                format!(
                    "{advice} ({number} of the files in `{}` cannot be used: `presets` names them)",
                    folder.display()
                )
            }
            (None, _) => advice,
        };
        Error::UnknownPreset { name: name.to_owned(), advice }
    }

    /// Reads a brush object, which may name a preset: `{"preset": "Alpine ridge", "radius": 120}`.
    ///
    /// # Errors
    /// As [`Self::brush_object`]; [`Error::Field`] naming the field.
    pub fn brush(&self, object: &Map<String, Value>) -> Result<Brush> {
        Ok(Brush::from_json(&self.brush_object(object)?)?)
    }

    /// As [`Self::brush`]; relative names of files in it are relative to a folder: that of the file it was read from.
    ///
    /// # Errors
    /// As [`Self::brush`].
    pub fn brush_in(&self, object: &Map<String, Value>, folder: &Path) -> Result<Brush> {
        let mut brush = self.brush(object)?;
        resources::resolve_files(resources::sources(&mut brush).collect(), folder);
        Ok(brush)
    }

    /// A brush object that names no preset: fields beside `preset` take the place of the preset's. They are not looked at.
    ///
    /// # Errors
    /// As [`Self::get`]; [`Error::Operation`] for a `type` that is not the preset's.
    pub fn brush_object(&self, object: &Map<String, Value>) -> Result<Map<String, Value>> {
        let refused = |detail| Error::Operation { place: "the brush".to_owned(), detail };
        let name = match object.get("preset") {
            None => return Ok(object.clone()),
            Some(Value::String(name)) => name,
            Some(other) => {
                return Err(refused(format!("`preset` is {other}, it must be the name of a preset")));
            }
        };
        let preset = &self.get(name)?.preset;
        let (wanted, is) = (object.get("type"), preset.brush.get("type"));
        if let (Some(wanted), Some(is)) = (wanted, is)
            && wanted != is
        {
            let name = &preset.name;
            return Err(refused(format!(
                "its `type` is {wanted}, the preset `{name}` is {is}: leave it out"
            )));
        }
        let mut brush = preset.brush.clone();
        let beside = object.iter().filter(|(field, _)| *field != "preset");
        brush.extend(beside.map(|(field, value)| (field.clone(), value.clone())));
        Ok(brush)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(in crate::presets) fn object(text: &str) -> Map<String, Value> {
        serde_json::from_str(text).unwrap()
    }

    pub(in crate::presets) fn preset(name: &str, brush: &str) -> Preset {
        Preset::new(name, object(brush)).unwrap()
    }

    pub(in crate::presets) fn library() -> (tempfile::TempDir, Presets) {
        let folder = tempfile::tempdir().unwrap();
        let presets = Presets::open(Some(folder.path().join("made/when/needed")));
        (folder, presets)
    }

    #[test]
    fn a_file_that_cannot_be_used_is_in_the_way_of_its_own_name_only() {
        let (folder, _) = library();
        let name = Presets::factory().iter().next().unwrap().preset.name.clone();
        let file = folder.path().join(folder::file_name(&name::slug(&name)));
        std::fs::write(&file, "{").unwrap();
        std::fs::write(folder.path().join("other.json"), r#"{"preset": "X", "brush": {"type": "raise"}}"#)
            .unwrap();
        std::fs::write(folder.path().join("notes.txt"), "these are not looked at").unwrap();
        let mut presets = Presets::open(Some(folder.path().to_owned()));
        let problems: Vec<_> = presets.unusable().map(ToString::to_string).collect();
        assert_eq!(problems.len(), 2, "{problems:?}");
        assert!(problems.iter().any(|problem| problem.contains("x.json")), "{problems:?}");
        assert!(presets.get(&name).unwrap_err().to_string().contains(&*file.to_string_lossy()));
        assert!(presets.iter().count() == Presets::factory().iter().count());
        presets.remove(&name).unwrap();
        assert_eq!(presets.get(&name).unwrap().origin, PresetOrigin::Factory);
    }

    #[test]
    fn a_folder_that_cannot_be_read_is_in_the_way_of_names_only() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("no-folder");
        std::fs::write(&file, "").unwrap();
        let presets = Presets::open(Some(file));
        assert!(presets.unusable().next().unwrap().to_string().contains("no-folder"));
        assert!(presets.brush(&object(r#"{"type": "raise"}"#)).is_ok());
        assert!(presets.get("Trench").unwrap_err().to_string().contains("no-folder"));
    }

    #[test]
    fn fields_beside_a_preset_take_the_place_of_its_own() {
        let (_folder, mut presets) = library();
        let ridge = preset("Ridge", r#"{"type": "raise", "radius": 33, "strength": 7, "profile": "tip"}"#);
        presets.save(&ridge, false).unwrap();
        let brush = |text: &str| presets.brush(&object(text));
        let expected =
            Brush::from_json(&object(r#"{"type": "raise", "radius": 120, "strength": 7, "profile": "tip"}"#));
        let found = brush(r#"{"preset": "ridge", "radius": 120, "type": "raise"}"#).unwrap();
        assert_eq!(found, expected.unwrap());
        assert_eq!(
            brush(r#"{"type": "raise"}"#).unwrap(),
            Brush::from_json(&object(r#"{"type": "raise"}"#)).unwrap()
        );
        for (text, words) in [
            (r#"{"preset": "Ridge", "type": "lower"}"#, &["lower", "Ridge", "raise"][..]),
            (r#"{"preset": "Ridge", "radios": 5}"#, &["radios"]),
            (r#"{"preset": "Ridge", "radius": 0}"#, &["radius"]),
            (r#"{"preset": 5}"#, &["preset", "5"]),
            (r#"{"preset": "Rigde"}"#, &["Rigde", "`Ridge`"]),
            (r#"{"preset": "zzzz"}"#, &["zzzz", "none"]),
            (r#"{"preset": "a/b"}"#, &["a/b"]),
        ] {
            let err = brush(text).unwrap_err().to_string();
            for word in words {
                assert!(err.contains(word), "{text}: {err}");
            }
        }
    }
}
