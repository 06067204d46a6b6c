//! Choosing files: in dialogs that are for them, and for fields that name one.

use egui::{Event, Key, Modifiers, PointerButton};
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::{Command, Preferences};
use orogeny_engine::{BrushType, Presets};

use crate::support::{Window, make_terrain};

/// A window beside whose terrain there is a folder with another one.
fn with_folder() -> Window {
    let window = Window::open();
    std::fs::create_dir(window.path("alps")).unwrap();
    make_terrain(&window.path("alps/other.orogeny"));
    std::fs::write(window.path("alps/notes.txt"), "of the survey").unwrap();
    window
}

impl Window {
    fn has(&self, label: &str) -> bool {
        self.harness.query_all_by_label(label).count() > 0
    }

    /// What is open, below the window's folder.
    fn opened(&self) -> String {
        let file = self.harness.state().open_file().unwrap();
        file.strip_prefix(self.folder.path()).unwrap().display().to_string()
    }

    fn press(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.frames(3);
    }
}

#[test]
fn arrows_and_enter_go_into_a_folder_and_open_what_is_there() {
    let mut window = with_folder();
    window.run(Command::Open);
    assert!(window.has("alps/") && window.has("t.orogeny") && !window.has("editor.json"));
    window.press(Modifiers::NONE, Key::ArrowDown);
    window.press(Modifiers::NONE, Key::Enter);
    assert!(window.has("other.orogeny") && !window.has("notes.txt"));
    // Back with Alt, and in again.
    window.press(Modifiers::ALT, Key::ArrowUp);
    assert!(window.has("t.orogeny"));
    window.press(Modifiers::NONE, Key::ArrowDown);
    window.press(Modifiers::NONE, Key::Enter);
    window.press(Modifiers::NONE, Key::ArrowUp);
    window.press(Modifiers::NONE, Key::Enter);
    window.settle();
    assert_eq!(window.opened(), "alps/other.orogeny");
    let path = window.path("alps");
    let folder = window.close();
    let preferences = Preferences::read(&folder.path().join("editor.json")).unwrap();
    assert_eq!(preferences.folders.first(), Some(&path));
}

#[test]
fn the_mouse_goes_up_back_and_takes_what_is_clicked_twice() {
    let mut window = with_folder();
    window.run(Command::Open);
    window.click("alps/");
    window.click("All files");
    assert!(window.has("notes.txt"));
    window.click("Up a folder");
    window.click("alps/");
    window.click("other.orogeny");
    assert_eq!(window.opened(), "t.orogeny", "one click chooses");
    let pos = window.harness.get_by_label("other.orogeny").rect().center();
    // All of it in one frame: as frames go by here, two of them are too late for a second click.
    let events = &mut window.harness.input_mut().events;
    events.push(Event::PointerMoved(pos));
    for pressed in [true, false, true, false] {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        events.push(Event::PointerButton { pos, button, pressed, modifiers });
    }
    window.settle();
    assert_eq!(window.opened(), "alps/other.orogeny");
    // Where files were chosen before is offered.
    window.run(Command::Import);
    window.click("Recent folders");
    window.click(&window.path("alps").display().to_string());
    assert!(window.has("Nothing that is looked for is here"));
    window.click("Home");
    assert!(!window.has("There is no such folder, or it cannot be read"));
    window.type_into("Path", "no/such/folder/at.all");
    assert!(window.has("There is no such folder, or it cannot be read"));
    assert_eq!(window.editor().errors().count(), 0);
}

/// What is made while a dialog is open is seen in it.
#[test]
fn a_folder_is_read_again_when_it_changes() {
    let mut window = with_folder();
    window.run(Command::Open);
    assert!(!window.has("later.orogeny"));
    std::fs::write(window.path("later.orogeny"), "").unwrap();
    window.frames(3);
    assert!(window.has("later.orogeny"));
}

#[test]
fn the_place_of_a_new_terrain_is_chosen_and_given_up() {
    let mut window = with_folder();
    window.run(Command::New);
    window.click("Browse…");
    assert!(!window.has("Make"));
    window.press(Modifiers::NONE, Key::Escape);
    assert!(window.has("Make"), "it is the dialog for the terrain again");
    window.click("Browse…");
    let path = window.path("alps/island.orogeny");
    window.type_into("Path", &path.display().to_string());
    window.click("Choose");
    window.click("Make");
    window.settle();
    assert_eq!(window.editor().open_file(), Some(path.as_path()));
}

#[test]
fn a_parameter_s_file_is_chosen() {
    let mut window = with_folder();
    std::fs::write(window.path("alps/rocks.png"), "").unwrap();
    let open = |window: &mut Window, header: &str| {
        window.harness.get_by_label(header).scroll_to_me();
        window.frames(12);
        window.click(header);
        window.frames(12);
        window.harness.get_by_label("Browse…").scroll_to_me();
        window.frames(12);
        window.click("Browse…");
        window.click("alps/");
    };
    window.run(Command::Brush(BrushType::Clone));
    open(&mut window, "Source");
    // Terrains and heights can be copied from.
    assert!(window.has("rocks.png"));
    window.click("other.orogeny");
    window.click("Choose");
    let brush = window.editor().brush_json();
    let other = window.path("alps/other.orogeny").display().to_string();
    assert_eq!(brush["source"]["file"], other.as_str());
    window.run(Command::Brush(BrushType::Raise));
    open(&mut window, "Alpha");
    assert!(!window.has("other.orogeny"), "that is no picture");
    window.click("rocks.png");
    window.click("Choose");
    let rocks = window.path("alps/rocks.png").display().to_string();
    assert_eq!(window.editor().brush_json()["alpha"]["file"], rocks.as_str());
}

#[test]
fn presets_go_to_files_and_come_from_them() {
    let mut window = with_folder();
    window.type_into("Search", "trench");
    window.harness.get_by_label("Trench").click_secondary();
    window.frames(3);
    window.click("Write to a file…");
    let file = window.path("alps/trench.json");
    window.type_into("Path", &file.display().to_string());
    window.click("Write");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains("data:image/png"), "its picture goes along");
    std::fs::write(&file, text.replace("\"Trench\"", "\"Trench of theirs\"")).unwrap();
    window.run(Command::AddPreset);
    window.click("alps/");
    window.click("trench.json");
    window.click("Add");
    assert!(window.has("Trench of theirs"));
    let said: Vec<_> = window.editor().errors().collect();
    assert!(said.is_empty(), "{said:?}");
    assert!(Presets::open(Some(window.path("presets"))).get("Trench of theirs").is_ok());
}
