//! What the editor remembers from one start to the next, in a file of its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::{CameraControl, Error, Habit, Keymap, Result};

/// Files that are offered again at most.
const MAX_RECENT: usize = 12;
/// Folders that are offered again at most.
const MAX_FOLDERS: usize = 8;
/// Places to look from that are kept for each terrain.
pub const NUM_PLACES: u8 = 4;

/// Places to look from, by their numbers from 1 on.
pub type Places = [Option<CameraControl>; NUM_PLACES as usize];

/// What is remembered. What a file does not say is as at the first start; what it says beyond is kept.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Terrains that were open, the last one first.
    pub recent: Vec<PathBuf>,
    /// Folders that files were chosen from, the last one first.
    pub folders: Vec<PathBuf>,
    /// Where the eye was in each of them, by its path.
    pub cameras: BTreeMap<PathBuf, CameraControl>,
    /// Places to look from that were kept, by the terrain's path.
    pub places: BTreeMap<PathBuf, Places>,
    /// Whose keys are used.
    pub habit: Habit,
    /// Keys that differ, by the ids of commands: `"undo": "Alt+U"`; empty for no key.
    pub keys: BTreeMap<String, String>,
    /// Whether it is light.
    pub is_light: bool,
    /// How large everything is; 0: as the system says.
    pub interface_scale: f32,
    /// The parameters that each brush was last used with.
    pub brushes: BTreeMap<String, Map<String, Value>>,
    /// The brush that was last used.
    pub brush: String,
    /// Brushes that the user wrote and that lie elsewhere than in the folder for them.
    pub own_brushes: Vec<PathBuf>,
    /// How the ground was last shown.
    pub mode: String,
    /// Whether the first steps were seen.
    pub has_seen_tutorial: bool,
    /// Whatever else is in the file.
    #[serde(flatten)]
    pub others: Map<String, Value>,
}

impl Preferences {
    /// Those in a file; as at the first start where there is none.
    ///
    /// # Errors
    /// [`Error::Preferences`] for a file that cannot be understood, which is left as it is.
    pub fn read(path: &Path) -> Result<Self> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(err) if err.kind() == std::io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(err) => return Err(wrong(path, &err)),
        };
        serde_json::from_str(&text).map_err(|err| wrong(path, &err))
    }

    /// Writes them: all of them or, on an error, none.
    ///
    /// # Errors
    /// [`Error::Preferences`].
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self).map_err(|err| wrong(path, &err))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        std::fs::create_dir_all(folder).map_err(|err| wrong(path, &err))?;
        let new = path.with_extension("json.new");
        std::fs::write(&new, text).and_then(|()| std::fs::rename(&new, path)).map_err(|err| wrong(path, &err))
    }

    /// Notes a terrain that was opened.
    pub fn note_opened(&mut self, path: &Path) {
        self.recent.retain(|known| known != path);
        self.recent.insert(0, path.to_owned());
        self.recent.truncate(MAX_RECENT);
        self.cameras.retain(|known, _| self.recent.contains(known));
    }

    /// Notes the folder of a file that was chosen.
    pub fn note_folder(&mut self, file: &Path) {
        let Ok(file) = std::path::absolute(file) else { return };
        let Some(folder) = file.parent() else { return };
        self.folders.retain(|known| known != folder);
        self.folders.insert(0, folder.to_owned());
        self.folders.truncate(MAX_FOLDERS);
    }

    /// Folders that files were chosen from, then those of terrains that were open, each once; of those that are still there.
    #[must_use]
    pub fn folders(&self) -> Vec<PathBuf> {
        let of_terrains = self.recent.iter().filter_map(|path| path.parent()).map(Path::to_owned);
        let mut folders: Vec<PathBuf> = Vec::new();
        for folder in self.folders.iter().cloned().chain(of_terrains) {
            if !folders.contains(&folder) && folder.is_dir() {
                folders.push(folder);
            }
        }
        folders.truncate(MAX_FOLDERS);
        folders
    }

    /// Its keys.
    #[must_use]
    pub fn keymap(&self) -> Keymap {
        Keymap::new(self.habit, &self.keys)
    }
}

fn wrong(path: &Path, err: &dyn std::fmt::Display) -> Error {
    Error::Preferences { path: path.to_owned(), detail: err.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_come_back_as_they_were_written_with_what_is_not_known() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep").join("editor.json");
        assert_eq!(Preferences::read(&path).unwrap(), Preferences::default());
        let mut preferences = Preferences { habit: Habit::Blender, is_light: true, ..Preferences::default() };
        preferences.others.insert("of_a_later_version".to_owned(), 7.into());
        for k in 0..20 {
            preferences.note_opened(&PathBuf::from(format!("terrain-{}.orogeny", k % 15)));
        }
        assert_eq!(preferences.recent.len(), MAX_RECENT);
        assert_eq!(preferences.recent[0], PathBuf::from("terrain-4.orogeny"));
        preferences.write(&path).unwrap();
        assert_eq!(Preferences::read(&path).unwrap(), preferences);
    }

    #[test]
    fn a_file_that_cannot_be_understood_is_left_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("editor.json");
        std::fs::write(&path, "{\"habit\": \"Emacs\"").unwrap();
        let err = Preferences::read(&path).unwrap_err().to_string();
        assert!(err.contains("editor.json"), "{err}");
        assert!(std::fs::read_to_string(&path).unwrap().contains("Emacs"));
    }
}
