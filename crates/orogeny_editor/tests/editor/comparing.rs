//! The terrain as it was, beside how it is.

use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use orogeny_editor::Command;

use crate::support::{Window, curve};

#[test]
fn what_was_is_shown_and_what_is_comes_back_bit_for_bit() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    let first = Window::heights(&path);
    window.draw(&curve(6), Modifiers::NONE);
    let second = Window::heights(&path);
    window.draw(&curve(9), Modifiers::SHIFT);
    let now = Window::heights(&path);
    window.harness.key_press(Key::V);
    window.settle();
    assert!(window.editor().is_comparing());
    assert!(Window::heights(&path) == second, "before the last entry");
    window.click("1 Fill noise");
    window.settle();
    assert!(Window::heights(&path) == first, "after any that is clicked");
    // Nothing is changed meanwhile.
    window.draw(&curve(5), Modifiers::NONE);
    window.run(Command::Undo);
    window.run(Command::SelectAll);
    assert!(window.editor().last_message().unwrap().contains("go back to now"));
    assert_eq!(window.history().len(), 3);
    window.harness.key_press(Key::V);
    window.settle();
    assert!(!window.editor().is_comparing());
    assert!(Window::heights(&path) == now);
    window.draw(&curve(5), Modifiers::NONE);
    assert_eq!(window.history().len(), 4);
}

#[test]
fn the_map_shows_by_how_much_the_ground_differs() {
    let mut window = Window::open();
    window.draw(&curve(6), Modifiers::NONE);
    window.run(Command::Compare);
    window.click("Difference on the map");
    window.settle();
    window.frames(2);
    let label = window.harness.get_by_label_contains("m higher now, blue");
    let text = label.accesskit_node().label().or_else(|| label.value()).unwrap();
    let most_m: f64 = text.split(' ').nth(1).unwrap().parse().unwrap();
    // Half of full strength, 2.4 m at the radius of 12 m, drawn over itself a few times.
    assert!(most_m > 0.5, "{text}");
    window.run(Command::Compare);
    assert!(window.harness.query_by_label_contains("m higher now, blue").is_none());
}

#[test]
fn closing_and_being_killed_while_comparing_lose_nothing() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    window.draw(&curve(6), Modifiers::NONE);
    let now = Window::heights(&path);
    window.run(Command::Compare);
    assert!(Window::heights(&path) != now);
    let folder = window.close();
    assert!(Window::heights(&path) == now, "closing goes back first");
    // As a kill leaves it: what preferences say, and the terrain as it was.
    let mut window = Window::in_folder(folder);
    window.editor().open_last();
    window.settle();
    window.run(Command::Compare);
    let Window { harness, folder, .. } = window;
    let preferences = std::fs::read_to_string(folder.path().join("editor.json")).unwrap();
    drop(harness);
    std::fs::write(folder.path().join("editor.json"), preferences).unwrap();
    assert!(Window::heights(&path) != now);
    let mut window = Window::in_folder(folder);
    window.editor().open_last();
    window.settle();
    assert!(Window::heights(&path) == now, "the next start goes back");
    assert!(!window.editor().is_comparing());
}
