//! Brushes that the user wrote: WGSL files, read again when they have changed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use orogeny_engine::{CustomBrushFile, CustomParameter};

use crate::Hand;
use crate::command::words;
use crate::editor::Editor;

/// How often files are looked at, while they are shown.
pub const LOOK_EVERY: Duration = Duration::from_secs(1);

/// One of them.
#[derive(Debug)]
pub struct OwnBrush {
    /// `None` until it has compiled once.
    file: Option<CustomBrushFile>,
    /// What is wrong with it as it is now, with the lines.
    wrong: Option<String>,
}

impl OwnBrush {
    /// What is wrong with it as it is now.
    #[must_use]
    pub fn wrong(&self) -> Option<&str> {
        self.wrong.as_deref()
    }

    /// What it does, by its first line.
    #[must_use]
    pub fn summary(&self) -> &str {
        self.file.as_ref().map_or("", CustomBrushFile::summary)
    }

    /// What it declares; `None` where it never compiled.
    #[must_use]
    pub fn parameters(&self) -> Option<&[CustomParameter]> {
        self.file.as_ref().map(CustomBrushFile::parameters)
    }

    /// Reads it where it has changed; what is wrong with it now and was not before.
    fn look(&mut self, path: &Path) -> Option<String> {
        let looked = match &mut self.file {
            Some(file) => file.refresh().map(|has_changed| {
                if has_changed {
                    self.wrong = None;
                }
            }),
            None => CustomBrushFile::open(path).map(|file| (self.file, self.wrong) = (Some(file), None)),
        };
        let wrong = looked.err()?.to_string();
        (self.wrong.replace(wrong.clone()).as_deref() != Some(&wrong)).then_some(wrong)
    }
}

/// All of them.
#[derive(Debug, Default)]
pub struct OwnBrushes {
    folder: Option<PathBuf>,
    known: BTreeMap<PathBuf, OwnBrush>,
    looked: Option<Instant>,
}

impl OwnBrushes {
    /// Those of a folder, to which others come.
    #[must_use]
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self { folder, ..Self::default() }
    }

    /// Where they are looked for.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Them, with what people call them, by their files.
    pub fn iter(&self) -> impl Iterator<Item = (&Path, String, &OwnBrush)> {
        self.known.iter().map(|(path, brush)| (path.as_path(), name(path), brush))
    }

    /// The one of a file.
    #[must_use]
    pub fn get(&self, path: &Path) -> Option<&OwnBrush> {
        self.known.get(path)
    }

    /// Looks at all files from now on, not when it is time.
    pub const fn look_at_once(&mut self) {
        self.looked = None;
    }

    /// Looks for new files and changed ones where it is time: those of the folder, those that lie elsewhere, and the one in the hand.
    /// What is wrong with them and was not told yet.
    pub fn look(&mut self, others: &[PathBuf], in_hand: Option<&Path>) -> Vec<String> {
        let is_new = in_hand.is_some_and(|path| !self.known.contains_key(path));
        if !is_new && self.looked.is_some_and(|looked| looked.elapsed() < LOOK_EVERY) {
            return Vec::new();
        }
        self.looked = Some(Instant::now());
        let entries = self.folder.as_deref().and_then(|folder| std::fs::read_dir(folder).ok());
        let of_folder = entries.into_iter().flatten().flatten().map(|entry| entry.path());
        let of_folder = of_folder.filter(|path| path.extension().is_some_and(|ending| ending == "wgsl"));
        let all: Vec<PathBuf> =
            of_folder.chain(others.iter().cloned()).chain(in_hand.map(Path::to_owned)).collect();
        self.known.retain(|path, _| all.contains(path));
        let mut told = Vec::new();
        for path in all {
            let brush =
                self.known.entry(path.clone()).or_insert_with(|| OwnBrush { file: None, wrong: None });
            told.extend(brush.look(&path));
        }
        told
    }

    /// What is to be painted with in place of a file, while that does not compile.
    fn stand_in(&mut self, path: &Path) -> Option<String> {
        let file = self.known.get_mut(path)?.file.as_mut()?.good_file().ok()?;
        (file != path).then(|| file.to_string_lossy().into_owned())
    }
}

/// What people call the brush of a file.
fn name(path: &Path) -> String {
    words(&path.file_stem().unwrap_or_default().to_string_lossy())
}

impl Editor {
    /// Looks at the brushes that the user wrote, where it is time.
    pub(crate) fn look_at_own_brushes(&mut self) {
        let in_hand = self.tool.file().map(PathBuf::from);
        let told = self.own_brushes.look(&self.preferences.own_brushes, in_hand.as_deref());
        self.tool.stand_in = in_hand.and_then(|path| self.own_brushes.stand_in(&path));
        for wrong in told {
            self.tell(wrong, true);
        }
    }

    /// Adds a brush that lies anywhere, and takes it into the hand.
    pub(crate) fn add_own_brush(&mut self, path: &Path) {
        // The file has to be found from wherever the program is started next.
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        if let Err(err) = CustomBrushFile::open(&path) {
            return self.tell(err.to_string(), true);
        }
        let is_in_folder = self.own_brushes.folder() == path.parent();
        if !is_in_folder && !self.preferences.own_brushes.contains(&path) {
            self.preferences.own_brushes.push(path.clone());
            self.remember();
        }
        self.own_brushes.look_at_once();
        self.take_own_brush(&path);
    }

    /// Takes up a brush that the user wrote, to draw with it.
    pub(crate) fn take_own_brush(&mut self, path: &Path) {
        self.tool.take_file(&path.to_string_lossy());
        self.look_at_own_brushes();
        if !self.viewport.is_busy() {
            self.viewport.hand = Hand::Brush;
        }
    }
}
