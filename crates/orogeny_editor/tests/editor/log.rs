//! The program's log in its window.

use egui::Modifiers;
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::Command;
use tracing::Level;

use crate::support::Window;

#[test]
fn lines_are_filtered_searched_and_copied() {
    let mut window = Window::open();
    let log = window.log.clone();
    log.push(Level::WARN, "orogeny_engine::apply", "the device was lost");
    log.push(Level::INFO, "orogeny_editor", "a stroke was painted");
    log.push(Level::DEBUG, "orogeny_editor", "a page was read");
    window.harness.key_press_modifiers(Modifiers::COMMAND, egui::Key::L);
    window.frames(4);
    let shows = |window: &Window, text: &str| window.harness.query_by_label_contains(text).is_some();
    assert!(shows(&window, "device was lost") && shows(&window, "stroke was painted"));
    assert!(!shows(&window, "page was read"), "it is but a detail");
    window.click("and worse");
    window.click("Details");
    assert!(shows(&window, "page was read"));
    window.click("and worse");
    window.click("Warnings");
    assert!(shows(&window, "device was lost") && !shows(&window, "stroke was painted"));
    window.click("and worse");
    window.click("Details");
    window.type_into("Search the log", "engine LOST");
    assert!(shows(&window, "device was lost") && !shows(&window, "page was read"));
    window.click("Copy lines");
    assert_eq!(window.editor().last_message(), Some("1 lines of the log were copied"));
    window.click("Clear log");
    assert!(!shows(&window, "device was lost"));
    window.run(Command::ShowLog);
    assert!(window.harness.query_by_label("Clear log").is_none());
}
