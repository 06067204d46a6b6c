//! The files of a shader folder in memory, by their paths below it.
//!
//! Everything after this module works on the tree alone: an include can reach nothing else, so no path leads out
//! of the folder, and a text that never was a file (a brush from a document) compiles the same way.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::diagnostic::Diagnostic;
use super::text;
use crate::error::{Error, Result};

/// The folders whose files are entry points.
pub(crate) const ENTRY_FOLDERS: &[&str] = &["brush", "custom", "editor", "field", "terrain"];

/// More files than any real shader folder has.
const MAX_FILES: usize = 4096;
/// More text than any real shader folder has.
const MAX_BYTES: usize = 16 << 20;

/// What a file is for, told by the folder that it is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Folder {
    /// `lib/`: functions and types, no bindings.
    Lib,
    /// `driver/`: bindings and loops that kernels share. `scene/`: what all that draws a terrain shares.
    Driver,
    /// One of [`ENTRY_FOLDERS`]: one entry point a file.
    Entry,
}

impl Folder {
    /// The folder of a path below the root; `None` if it is none of ours.
    pub(crate) fn of(path: &str) -> Option<Self> {
        match path.split_once('/')?.0 {
            "lib" => Some(Self::Lib),
            "driver" | "scene" => Some(Self::Driver),
            folder => ENTRY_FOLDERS.contains(&folder).then_some(Self::Entry),
        }
    }
}

/// A shader folder: WGSL texts by path, such as `lib/falloff.wgsl`.
#[derive(Clone, Debug)]
pub struct SourceTree {
    name: String,
    files: BTreeMap<String, String>,
    /// What errors call a file that is no file of the folder, by its path here.
    shown: BTreeMap<String, String>,
    diagnostics: Vec<Diagnostic>,
    num_bytes: usize,
}

impl SourceTree {
    /// An empty tree; `name` stands before the paths in errors (`shaders`).
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            files: BTreeMap::new(),
            shown: BTreeMap::new(),
            diagnostics: Vec::new(),
            num_bytes: 0,
        }
    }

    /// Reads every `.wgsl` file below the folder `root`. Links and hidden files are left out.
    ///
    /// # Errors
    ///
    /// [`Error::Read`] if something cannot be read, [`Error::TooLarge`] above 4,096 files or 16 MiB. A file that
    /// is not UTF-8 or is in no known folder is reported by the compilation, with all other errors.
    pub fn load(root: &Path) -> Result<Self> {
        let name = root.file_name().map_or_else(|| root.display().to_string(), |n| n.display().to_string());
        let mut tree = Self::new(name);
        tree.load_folder(root, "")?;
        Ok(tree)
    }

    /// Adds or replaces one file; `path` is relative to the tree, with `/` between its parts.
    ///
    /// # Errors
    ///
    /// [`Error::TooLarge`] above 4,096 files or 16 MiB; the file is then not added.
    pub fn insert(&mut self, path: &str, text: &str) -> Result<()> {
        let num_files = self.files.len() + usize::from(!self.files.contains_key(path));
        let num_bytes = self.num_bytes + text.len() - self.files.get(path).map_or(0, String::len);
        for (count, limit, unit) in [(num_files, MAX_FILES, "files"), (num_bytes, MAX_BYTES, "bytes")] {
            if count > limit {
                return Err(Error::TooLarge { root: self.name.clone(), limit, unit });
            }
        }

        // One form of text whatever the editor or the version control made of it.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text).replace("\r\n", "\n");
        self.num_bytes = self.num_bytes + text.len() - self.files.get(path).map_or(0, String::len);
        self.files.insert(path.to_owned(), text);
        if let Some(message) = path_error(path) {
            self.diagnostics.push(self.diagnostic(path, 1, 1, message));
        }
        Ok(())
    }

    /// Adds or replaces a file as [`Self::insert`] does, which errors call `shown` as it is.
    pub(crate) fn insert_shown(&mut self, path: &str, shown: &str, text: &str) -> Result<()> {
        self.insert(path, text)?;
        self.shown.insert(path.to_owned(), shown.to_owned());
        Ok(())
    }

    /// What errors call a file: its path with the folder's name, unless it is none of the folder's.
    pub(crate) fn shown(&self, path: &str) -> String {
        self.shown.get(path).cloned().unwrap_or_else(|| format!("{}/{path}", self.name))
    }

    /// The folder's name, as errors show it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text of a file.
    pub(crate) fn get(&self, path: &str) -> Option<&str> {
        self.files.get(path).map(String::as_str)
    }

    /// Every file and its text, sorted by path.
    pub(crate) fn files(&self) -> impl Iterator<Item = (&str, &str)> {
        self.files.iter().map(|(path, text)| (path.as_str(), text.as_str()))
    }

    /// The files of one kind of folder, sorted.
    pub(crate) fn paths_in(&self, folder: Folder) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str).filter(move |path| Folder::of(path) == Some(folder))
    }

    /// What was wrong with the files themselves.
    pub(crate) fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// An error at a line and a column (both from 1) of a file.
    pub(crate) fn diagnostic(
        &self,
        path: &str,
        line: u32,
        column: u32,
        message: impl Into<String>,
    ) -> Diagnostic {
        let source_line = self.get(path).and_then(|text| text.lines().nth(line.saturating_sub(1) as usize));
        Diagnostic {
            file: self.shown(path),
            line,
            column,
            lint: None,
            message: message.into(),
            notes: Vec::new(),
            source_line: source_line.unwrap_or_default().to_owned(),
        }
    }

    /// An error at a byte offset of a file.
    pub(crate) fn diagnostic_at(&self, path: &str, offset: usize, message: impl Into<String>) -> Diagnostic {
        let (line, column) = text::position(self.get(path).unwrap_or_default(), offset);
        self.diagnostic(path, line, column, message)
    }

    fn load_folder(&mut self, folder: &Path, prefix: &str) -> Result<()> {
        let read_error = |path: PathBuf| |source| Error::Read { path, source };
        for entry in fs::read_dir(folder).map_err(read_error(folder.to_owned()))? {
            let entry = entry.map_err(read_error(folder.to_owned()))?;
            let file_type = entry.file_type().map_err(read_error(entry.path()))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = format!("{prefix}{name}");
            if name.starts_with('.') {
                continue;
            } else if file_type.is_dir() {
                self.load_folder(&entry.path(), &format!("{path}/"))?;
            } else if file_type.is_file() && name.ends_with(".wgsl") {
                self.load_file(&entry.path(), &path)?;
            }
        }
        Ok(())
    }

    fn load_file(&mut self, file: &Path, path: &str) -> Result<()> {
        let read_error = |source| Error::Read { path: file.to_owned(), source };
        let num_bytes = fs::metadata(file).map_err(read_error)?.len();
        if num_bytes > MAX_BYTES as u64 {
            return Err(Error::TooLarge { root: self.name.clone(), limit: MAX_BYTES, unit: "bytes" });
        }
        let bytes = fs::read(file).map_err(read_error)?;
        let text = String::from_utf8_lossy(&bytes);
        self.insert(path, &text)?;
        if let Err(err) = std::str::from_utf8(&bytes) {
            let (line, column) = text::position(&text, err.valid_up_to());
            self.diagnostics.push(self.diagnostic(path, line, column, "not UTF-8; save the file as UTF-8"));
        }
        Ok(())
    }
}

/// Why a file may not have this path, if so.
fn path_error(path: &str) -> Option<String> {
    if Folder::of(path).is_none() {
        let folders = ENTRY_FOLDERS.join(", ");
        return Some(format!("a shader in no known folder; move it to one of lib, driver, scene, {folders}"));
    }
    let is_snake_case = |part: &str| {
        part.starts_with(|c: char| c.is_ascii_lowercase())
            && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
    };
    let stem = path.strip_suffix(".wgsl").unwrap_or_default();
    let is_name = !stem.is_empty() && stem.split('/').all(is_snake_case);
    (!is_name).then(|| {
        format!("`{path}` is not a snake_case name ending in .wgsl; its stem names Rust modules too")
    })
}
