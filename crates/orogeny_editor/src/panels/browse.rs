//! Choosing a file: folders, what of them is looked for, the way up, home and back to where files were chosen before; by mouse and keys.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use egui::{Context, Id, Key, Label, Modifiers, RichText, ScrollArea, TextEdit, Ui};
use orogeny_engine::{Direction, Format};
use serde_json::{Map, Value};

use super::{Dialog, NewTerrain};
use crate::editor::Editor;

/// The path is typed here: keys go on in the list below from it.
const FIELD: &str = "path of a file";
/// How high the list is, in points of the screen.
const LIST_HEIGHT: f32 = 220.0;

/// What a file is looked for as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sought {
    /// A terrain.
    Terrain,
    /// Heights to read.
    Heights,
    /// Heights to write.
    Written,
    /// A brush that the user wrote.
    Shader,
    /// A picture that a brush takes.
    Picture,
    /// Ground to copy from: a terrain or heights.
    Ground,
    /// A preset.
    Preset,
}

impl Sought {
    /// Whether a file's name is one of those.
    fn has(self, name: &str) -> bool {
        let ending = Path::new(name).extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let is_of = |direction| Format::from_path(Path::new(name), direction).is_ok();
        match self {
            Self::Terrain => ending == "orogeny",
            Self::Heights => is_of(Direction::Import),
            Self::Written => is_of(Direction::Export),
            Self::Shader => ending == "wgsl",
            Self::Picture => matches!(ending.as_str(), "png" | "exr"),
            Self::Ground => ending == "orogeny" || is_of(Direction::Import),
            Self::Preset => ending == "json",
        }
    }
}

/// Something in a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Entry {
    name: String,
    is_folder: bool,
}

/// A folder as it was listed.
#[derive(Debug, Clone)]
struct Listing {
    folder: PathBuf,
    /// When something in it was made or removed last.
    modified: Option<SystemTime>,
    shows_all: bool,
    /// Folders first; `None`: it cannot be read.
    entries: Option<Vec<Entry>>,
}

impl Listing {
    fn read(folder: &Path, sought: Sought, shows_all: bool) -> Self {
        let modified = modified(folder);
        let entries = std::fs::read_dir(folder).ok().map(|entries| {
            let entries = entries.flatten().map(|entry| Entry {
                name: entry.file_name().to_string_lossy().into_owned(),
                is_folder: entry.path().is_dir(),
            });
            let is_shown = |entry: &Entry| {
                shows_all || (!entry.name.starts_with('.') && (entry.is_folder || sought.has(&entry.name)))
            };
            let mut entries: Vec<_> = entries.filter(is_shown).collect();
            let order = |entry: &Entry| (!entry.is_folder, entry.name.to_lowercase());
            entries.sort_by_key(order);
            entries
        });
        Self { folder: folder.to_owned(), modified, shows_all, entries }
    }

    fn is_of(&self, folder: &Path, shows_all: bool) -> bool {
        self.folder == folder && self.shows_all == shows_all && self.modified == modified(folder)
    }
}

fn modified(folder: &Path) -> Option<SystemTime> {
    std::fs::metadata(folder).and_then(|metadata| metadata.modified()).ok()
}

/// What is looked through.
#[derive(Debug, Clone)]
pub(crate) struct Browser {
    sought: Sought,
    shows_all: bool,
    listing: Option<Listing>,
    /// The entry that keys have come to.
    marked: Option<usize>,
    /// Whether the field is to have the keys.
    wants_keys: bool,
}

impl Browser {
    pub(crate) const fn new(sought: Sought) -> Self {
        Self { sought, shows_all: false, listing: None, marked: None, wants_keys: true }
    }

    /// The field for the path. Tells whether that of a file was chosen by Enter.
    pub(crate) fn field(&mut self, ui: &mut Ui, path: &mut String) -> bool {
        let id = Id::unique(FIELD);
        if ui.memory(|memory| memory.has_focus(id)) {
            self.keys(ui, path);
        }
        let label = ui.label("Path");
        let field = ui.add(TextEdit::singleline(path).id(id).desired_width(f32::INFINITY));
        let field = field.labelled_by(label.id);
        if std::mem::take(&mut self.wants_keys) {
            field.request_focus();
        }
        if field.changed() {
            self.marked = None;
        }
        if !(field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))) {
            return false;
        }
        if let Some(entry) = self.marked_entry().filter(|entry| entry.is_folder).cloned() {
            self.go_to(&folder_of(path).join(entry.name), path);
        }
        self.wants_keys = true;
        !Path::new(path.trim()).is_dir()
    }

    fn marked_entry(&self) -> Option<&Entry> {
        self.listing.as_ref()?.entries.as_ref()?.get(self.marked?)
    }

    fn go_to(&mut self, folder: &Path, path: &mut String) {
        *path = folder.display().to_string();
        (self.marked, self.wants_keys) = (None, true);
    }

    fn go_up(&mut self, path: &mut String) {
        if let Some(parent) = folder_of(path).parent() {
            self.go_to(parent, path);
        }
    }

    /// Up and down in the list, and with Alt to the folder above.
    fn keys(&mut self, ui: &Ui, path: &mut String) {
        let (goes_up, by) = ui.input_mut(|input| {
            let goes_up = input.consume_key(Modifiers::ALT, Key::ArrowUp);
            let mut pressed = |key| isize::from(input.consume_key(Modifiers::NONE, key));
            (goes_up, pressed(Key::ArrowDown) - pressed(Key::ArrowUp))
        });
        if goes_up {
            return self.go_up(path);
        }
        let entries = self.listing.as_ref().and_then(|listing| listing.entries.as_ref());
        let num = entries.map_or(0, Vec::len);
        if by == 0 || num == 0 {
            return;
        }
        self.marked = Some(match self.marked {
            Some(marked) => marked.saturating_add_signed(by).min(num - 1),
            None if by > 0 => 0,
            None => num - 1,
        });
        let folder = folder_of(path);
        if let Some(entry) = self.marked_entry().filter(|entry| !entry.is_folder) {
            *path = folder.join(&entry.name).display().to_string();
        }
    }

    /// What is in the folder of the path. Tells whether a file was chosen by a double click.
    pub(crate) fn list(&mut self, ui: &mut Ui, path: &mut String, recent: &[PathBuf]) -> bool {
        let folder = folder_of(path);
        self.bar(ui, path, &folder, recent);
        if !self.listing.as_ref().is_some_and(|listing| listing.is_of(&folder, self.shows_all)) {
            self.listing = Some(Listing::read(&folder, self.sought, self.shows_all));
            self.marked = None;
        }
        let entries = self.listing.as_ref().and_then(|listing| listing.entries.as_deref());
        let (mut clicked, mut is_done) = (None, false);
        ScrollArea::vertical().max_height(LIST_HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
            match entries {
                None => _ = ui.label(RichText::new("There is no such folder, or it cannot be read").weak()),
                Some([]) => _ = ui.label(RichText::new("Nothing that is looked for is here").weak()),
                Some(_) => {}
            }
            for (index, entry) in entries.unwrap_or_default().iter().enumerate() {
                let end = if entry.is_folder { "/" } else { "" };
                let is_marked = self.marked == Some(index);
                let is_chosen = is_marked || Path::new(path.trim()) == folder.join(&entry.name);
                let shown = ui.selectable_label(is_chosen, format!("{}{end}", entry.name));
                if is_marked {
                    shown.scroll_to_me(None);
                }
                if shown.clicked() {
                    clicked = Some((index, entry.clone()));
                }
                is_done |= shown.double_clicked() && !entry.is_folder;
            }
        });
        if let Some((index, entry)) = clicked {
            self.go_to(&folder.join(&entry.name), path);
            self.marked = (!entry.is_folder).then_some(index);
        }
        ui.checkbox(&mut self.shows_all, "All files")
            .on_hover_text("Also what is of another kind, and what is hidden");
        is_done
    }

    /// Where one can go from here.
    fn bar(&mut self, ui: &mut Ui, path: &mut String, folder: &Path, recent: &[PathBuf]) {
        let mut to = None;
        ui.horizontal(|ui| {
            let up = ui.add_enabled(folder.parent().is_some(), egui::Button::new("Up a folder"));
            if up.on_hover_text("Alt+Up; arrows and Enter go through the list").clicked() {
                self.go_up(path);
            }
            let home = std::env::home_dir().filter(|home| home.is_dir());
            if ui.add_enabled(home.is_some(), egui::Button::new("Home")).clicked() {
                to = home;
            }
            ui.add_enabled_ui(!recent.is_empty(), |ui| {
                ui.menu_button("Recent folders", |ui| {
                    for folder in recent {
                        if ui.button(folder.display().to_string()).clicked() {
                            to = Some(folder.clone());
                            ui.close();
                        }
                    }
                });
            });
        });
        ui.add(Label::new(RichText::new(folder.display().to_string()).weak()).truncate());
        if let Some(to) = to {
            self.go_to(&to, path);
        }
    }
}

/// The folder of a path that is typed.
fn folder_of(path: &str) -> PathBuf {
    let path = Path::new(path.trim());
    if path.is_dir() { path.to_owned() } else { path.parent().unwrap_or(Path::new("")).to_owned() }
}

/// What a file is chosen for that has a field elsewhere.
#[derive(Debug, Clone)]
pub(crate) enum Target {
    /// The terrain that is going to be made: back to the dialog for that.
    NewTerrain(NewTerrain),
    /// A parameter of the brush, by the names that lead to it.
    Parameter(Vec<&'static str>),
}

/// A file is chosen for a field.
#[derive(Debug, Clone)]
pub(crate) struct Browse {
    browser: Browser,
    path: String,
    pub(super) target: Target,
}

impl Dialog {
    /// Where a terrain is going to be made.
    pub(super) fn browse_for_new(new: NewTerrain) -> Self {
        let path = new.path.clone();
        Self::Browse(Browse { browser: Browser::new(Sought::Terrain), path, target: Target::NewTerrain(new) })
    }

    /// A file that a parameter of the brush names.
    pub(super) fn browse_for_parameter(editor: &Editor, names: Vec<&'static str>, given: &str) -> Self {
        let sought = match names.as_slice() {
            [_] => Sought::Shader,
            names if names.contains(&"source") => Sought::Ground,
            _ => Sought::Picture,
        };
        let path = match given {
            "" => super::files::folder(editor).display().to_string(),
            given => given.to_owned(),
        };
        Self::Browse(Browse { browser: Browser::new(sought), path, target: Target::Parameter(names) })
    }

    /// What a dialog gives way to when it is given up.
    pub(crate) fn given_up(self) -> Option<Self> {
        match self {
            Self::Browse(Browse { target: Target::NewTerrain(new), .. }) => Some(Self::New(new)),
            _ => None,
        }
    }
}

pub(super) fn show(editor: &mut Editor, ctx: &Context, mut browse: Browse) -> Option<Dialog> {
    let recent = editor.preferences.folders();
    let mut is_done = false;
    let shown = super::window(ctx, "Choose a file", |ui| {
        is_done = browse.browser.field(ui, &mut browse.path);
        is_done |= browse.browser.list(ui, &mut browse.path, &recent);
        is_done |= ui.button("Choose").clicked() && !Path::new(browse.path.trim()).is_dir();
    });
    if !is_done {
        let dialog = Dialog::Browse(browse);
        return if shown.is_some() { Some(dialog) } else { dialog.given_up() };
    }
    let path = browse.path.trim().to_owned();
    editor.preferences.note_folder(Path::new(&path));
    match browse.target {
        Target::NewTerrain(mut new) => {
            new.path = path;
            Some(Dialog::New(new))
        }
        Target::Parameter(names) => {
            let mut object = editor.tool.object();
            put(&mut object, &names, path.into());
            if let Some(first) = names.first() {
                editor.tool.set(first, object.get(*first).cloned());
            }
            None
        }
    }
}

/// Puts a value into an object, or into one within it; those that lead there are made.
fn put(object: &mut Map<String, Value>, names: &[&str], value: Value) {
    match names {
        [] => {}
        [name] => _ = object.insert((*name).to_owned(), value),
        [name, rest @ ..] => {
            let inner = object.entry(*name).or_insert_with(|| Map::new().into());
            if let Some(inner) = inner.as_object_mut() {
                put(inner, rest, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_listing_has_folders_first_and_what_is_looked_for() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.orogeny", "A.PNG", "c.r16", "notes.txt", ".hidden.png", "d.wgsl", "e.json", "f.exr"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        for name in ["zoo", "Alps", ".git"] {
            std::fs::create_dir(folder.path().join(name)).unwrap();
        }
        let names = |sought, shows_all| -> Vec<String> {
            let listing = Listing::read(folder.path(), sought, shows_all);
            listing.entries.unwrap().into_iter().map(|entry| entry.name).collect()
        };
        assert_eq!(names(Sought::Terrain, false), ["Alps", "zoo", "b.orogeny"]);
        assert_eq!(names(Sought::Heights, false), ["Alps", "zoo", "A.PNG", "c.r16"]);
        assert_eq!(names(Sought::Shader, false), ["Alps", "zoo", "d.wgsl"]);
        assert_eq!(names(Sought::Picture, false), ["Alps", "zoo", "A.PNG", "f.exr"]);
        assert_eq!(names(Sought::Ground, false), ["Alps", "zoo", "A.PNG", "b.orogeny", "c.r16"]);
        assert_eq!(names(Sought::Preset, false), ["Alps", "zoo", "e.json"]);
        assert_eq!(names(Sought::Terrain, true).len(), 11);
        assert!(Listing::read(&folder.path().join("none"), Sought::Terrain, false).entries.is_none());
    }

    #[test]
    fn a_parameter_is_put_where_its_names_lead() {
        let mut object = json!({"radius": 5, "source": {"at": [1, 2]}}).as_object().cloned().unwrap();
        put(&mut object, &["source", "file"], "a.tif".into());
        put(&mut object, &["alpha", "file"], "b.png".into());
        put(&mut object, &["file"], "c.wgsl".into());
        let expected = json!({"radius": 5, "source": {"at": [1, 2], "file": "a.tif"}, "alpha": {"file": "b.png"},
            "file": "c.wgsl"});
        assert_eq!(Value::from(object), expected);
    }
}
