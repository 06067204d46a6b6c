//! The user's folder of presets: where it is, and what lies in it.

use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use etcetera::BaseStrategy as _;

use super::{Preset, name, preset};
use crate::{Error, Result};

/// The variable that says where the user's presets are.
const VARIABLE: &str = "OROGENY_PRESETS";

/// Where the user's presets are unless something else is asked for: what the environment's `OROGENY_PRESETS` says, else
/// `orogeny/presets` in the system's folder for data. `None` where the system names no such folder.
#[must_use]
pub fn user_presets_folder() -> Option<PathBuf> {
    match std::env::var_os(VARIABLE) {
        Some(folder) if !folder.is_empty() => Some(folder.into()),
        _ => Some(user_folder()?.join("presets")),
    }
}

/// Where the program keeps what is the user's and was given no other place: `orogeny` in the system's folder for data. `None` where the
/// system names no such folder.
#[must_use]
pub fn user_folder() -> Option<PathBuf> {
    Some(etcetera::choose_base_strategy().ok()?.data_dir().join("orogeny"))
}

/// The files of presets in a folder, in order; none where there is no folder.
pub(super) fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = |source| Error::Read { path: folder.to_owned(), source };
    let entries = match std::fs::read_dir(folder) {
        Err(err) if err.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(failed)?,
    };
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(failed)?.path();
        let is_hidden = path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        if !is_hidden && path.extension() == Some(OsStr::new("json")) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Reads a file of the folder, which must be called as its preset is: so no two hold the same one.
pub(super) fn read(file: &Path) -> Result<Preset> {
    let preset = Preset::read(file)?;
    let expected = file_name(&name::slug(&preset.name));
    match file.file_name() == Some(OsStr::new(&expected)) {
        true => Ok(preset),
        false => {
            let detail = format!("it holds `{}`, whose file is called `{expected}`: rename it", preset.name);
            Err(preset::unusable(format!("`{}`", file.display()), detail))
        }
    }
}

/// The file of a preset.
pub(super) fn file_name(key: &str) -> String {
    format!("{key}.json")
}
