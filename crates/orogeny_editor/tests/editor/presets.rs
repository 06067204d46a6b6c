//! Brushes under names: kept, renamed, deleted, shared.

use egui::{Key, PointerButton};
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::Command;

use crate::support::Window;

/// A window in which only presets are listed that are searched for, with one of the user's.
fn with_one() -> Window {
    let mut window = Window::open();
    window.run(Command::Larger);
    window.type_into("Search", "my hills");
    window.type_into("Name of the preset", "My hills");
    window.click("Save brush");
    window.harness.get_by_label("My hills");
    window
}

/// Chooses from what the right button shows.
fn choose(window: &mut Window, preset: &str, title: &str) {
    let at = window.harness.get_by_label(preset).rect().center();
    window.harness.event(egui::Event::PointerMoved(at));
    for pressed in [true, false] {
        let modifiers = egui::Modifiers::NONE;
        let button = PointerButton::Secondary;
        window.harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        window.frames(1);
    }
    window.frames(2);
    window.click(title);
    window.settle();
}

#[test]
fn a_preset_is_renamed_and_deleted() {
    let mut window = with_one();
    let num_files = |window: &Window| std::fs::read_dir(window.path("presets")).unwrap().count();
    assert_eq!(num_files(&window), 1);
    window.type_into("Name of the preset", "My hills, wide");
    choose(&mut window, "My hills", "Rename");
    assert!(window.harness.query_by_label("My hills").is_none());
    window.harness.get_by_label("My hills, wide");
    choose(&mut window, "My hills, wide", "Delete");
    assert!(window.harness.query_by_label("My hills, wide").is_none());
    assert_eq!(num_files(&window), 0);
    let said: Vec<_> = window.editor().errors().collect();
    assert!(said.is_empty(), "{said:?}");
}

#[test]
fn a_preset_that_is_dropped_is_kept_and_one_of_its_name_is_not_replaced() {
    let mut window = with_one();
    let files: Vec<_> = std::fs::read_dir(window.path("presets")).unwrap().collect();
    let text = std::fs::read_to_string(files[0].as_ref().unwrap().path()).unwrap();
    std::fs::write(window.path("theirs.json"), text.replace("My hills", "My hills of theirs")).unwrap();
    window.drop_file("theirs.json");
    window.frames(3);
    window.harness.get_by_label("My hills of theirs");
    window.drop_file("theirs.json");
    window.frames(3);
    assert!(window.editor().errors().last().unwrap().contains("My hills of theirs"));
    window.harness.key_press(Key::Escape);
    window.settle();
}
