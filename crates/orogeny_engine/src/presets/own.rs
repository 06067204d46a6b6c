//! The user's own presets: saved, replaced, removed.

use std::path::PathBuf;

use super::{KnownPreset, Preset, PresetOrigin, Presets, name};
use crate::{Error, Result, whole_file};

impl Presets {
    /// Writes a preset into the user's folder, which is made if need be; returns its file. Nothing that is there is replaced
    /// unless that is asked for; a preset that comes with the program is only hidden.
    ///
    /// # Errors
    /// [`Error::Preset`], [`Error::PresetExists`], [`Error::NoPresetFolder`], [`Error::Write`].
    pub fn save(&mut self, preset: &Preset, replace: bool) -> Result<PathBuf> {
        let text = preset.to_json_text()?;
        let key = name::slug(&preset.name);
        let file = self.file_of(&key).ok_or(Error::NoPresetFolder)?;
        if let Some(folder) = &self.folder {
            let failed = |source| Error::Write { path: folder.clone(), source };
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        if replace {
            whole_file::write(&file, text.as_bytes())?;
        } else {
            whole_file::write_new(&file, text.as_bytes()).map_err(|err| match err {
                Error::Write { path, source } if source.kind() == std::io::ErrorKind::AlreadyExists => {
                    Error::PresetExists { name: preset.name.clone(), path }
                }
                err => err,
            })?;
        }
        self.unusable.remove(&file);
        self.take_in(preset.clone(), file.clone());
        Ok(file)
    }

    /// Removes a preset of the user's, also one whose file cannot be used; returns the file that was removed.
    ///
    /// # Errors
    /// As [`Self::get`]; [`Error::FactoryPreset`]; [`Error::Write`].
    pub fn remove(&mut self, name: &str) -> Result<PathBuf> {
        let key = name::slug(name);
        let broken = self.file_of(&key).filter(|file| self.unusable.contains_key(file));
        let file = match broken {
            Some(file) => file,
            None => match &self.get(name)?.origin {
                PresetOrigin::User { file, .. } => file.clone(),
                PresetOrigin::Factory => return Err(Error::FactoryPreset { name: name.to_owned() }),
            },
        };
        std::fs::remove_file(&file).map_err(|source| Error::Write { path: file.clone(), source })?;
        self.unusable.remove(&file);
        match Self::factory().known.get(&key) {
            Some(factory) => _ = self.known.insert(key, factory.clone()),
            None => _ = self.known.remove(&key),
        }
        Ok(file)
    }

    /// Puts one of the user's in the place of what has its name.
    pub(super) fn take_in(&mut self, preset: Preset, file: PathBuf) {
        let key = name::slug(&preset.name);
        let replaces_factory = Self::factory().known.contains_key(&key);
        self.known.insert(key, KnownPreset { preset, origin: PresetOrigin::User { file, replaces_factory } });
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::tests::{library, preset};
    use super::*;

    #[test]
    fn what_is_saved_is_there_the_next_time_under_any_spelling() {
        let (_folder, mut presets) = library();
        let ridge = preset("Lone ridge", r#"{"type": "raise", "radius": 33}"#);
        let file = presets.save(&ridge, false).unwrap();
        assert!(file.ends_with("lone-ridge.json"), "{}", file.display());
        let again = Presets::open(presets.folder().map(Path::to_owned));
        for name in ["Lone ridge", "LONE RIDGE", "lone-ridge"] {
            assert_eq!(again.get(name).unwrap().preset, ridge);
            assert_eq!(presets.get(name).unwrap().preset, ridge);
        }
        assert_eq!(again.iter().count(), Presets::factory().iter().count() + 1);
    }

    #[test]
    fn nothing_is_replaced_unless_that_is_asked_for() {
        let (_folder, mut presets) = library();
        presets.save(&preset("A", r#"{"type": "raise"}"#), false).unwrap();
        let other = preset("a!", r#"{"type": "lower"}"#);
        assert!(matches!(presets.save(&other, false), Err(Error::PresetExists { .. })));
        assert_eq!(presets.get("A").unwrap().preset.brush["type"], "raise");
        presets.save(&other, true).unwrap();
        assert_eq!(presets.get("A").unwrap().preset, other);
    }

    #[test]
    fn a_users_preset_stands_in_for_the_programs_until_it_is_removed() {
        let (_folder, mut presets) = library();
        let name = Presets::factory().iter().next().unwrap().preset.name.clone();
        assert!(matches!(presets.remove(&name), Err(Error::FactoryPreset { .. })));
        presets.save(&preset(&name, r#"{"type": "lower", "radius": 1.5}"#), false).unwrap();
        let known = presets.get(&name).unwrap();
        assert_eq!(known.preset.brush["radius"], 1.5);
        assert!(matches!(known.origin, PresetOrigin::User { replaces_factory: true, .. }));
        presets.remove(&name).unwrap();
        assert_eq!(presets.get(&name).unwrap().origin, PresetOrigin::Factory);
    }

    #[test]
    fn without_a_folder_nothing_can_be_saved() {
        let mut presets = Presets::open(None);
        let saved = presets.save(&preset("A", r#"{"type": "raise"}"#), false);
        assert!(matches!(saved, Err(Error::NoPresetFolder)));
    }
}
