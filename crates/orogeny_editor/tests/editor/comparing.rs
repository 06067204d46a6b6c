//! The terrain as it was, beside how it is.

use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use orogeny_editor::Command;
use orogeny_engine::Mode;

use crate::support::{Window, curve};

/// What a label that tells of a difference says is the most, metres.
fn most_m(window: &Window, contained: &str) -> f64 {
    let label = window.harness.get_by_label_contains(contained);
    let text = label.accesskit_node().label().or_else(|| label.value()).unwrap();
    let words = text.split(' ').collect::<Vec<_>>();
    words[words.iter().position(|word| *word == "m").unwrap() - 1].parse().unwrap()
}

#[test]
fn the_difference_is_shown_while_the_terrain_is_worked_on() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    window.draw(&curve(6), Modifiers::NONE);
    let now = Window::heights(&path);
    let mode = window.editor().mode();
    window.run(Command::Compare);
    assert!(window.editor().is_comparing() && window.editor().mode() == Mode::Difference);
    assert!(Window::heights(&path) == now, "the terrain stays where it is");
    let once_m = most_m(&window, "m higher, blue");
    // Half of full strength, 2.4 m at the radius of 12 m, drawn over itself a few times.
    assert!(once_m > 0.5, "{once_m}");
    window.harness.get_by_label_contains("Since entry 1");
    // What is done goes on, and is seen at once.
    window.draw(&curve(6), Modifiers::NONE);
    assert_eq!(window.history().len(), 3);
    let twice_m = most_m(&window, "m higher, blue");
    assert!(twice_m > 1.4 * once_m, "{twice_m} after {once_m}");
    // Another entry is what is clicked; the terrain does not go there.
    window.click("3 Stroke raise");
    window.settle();
    window.harness.get_by_label_contains("Since entry 3");
    assert!(most_m(&window, "m higher, blue") < 0.01);
    window.run(Command::Undo);
    let undone_m = most_m(&window, "m higher, blue");
    assert!((undone_m - (twice_m - once_m)).abs() < 0.3 * once_m, "{undone_m}");
    assert!(Window::heights(&path) == now, "back by one, as asked");
    window.harness.key_press(Key::Escape);
    window.settle();
    assert!(!window.editor().is_comparing() && window.editor().mode() == mode);
    assert!(window.editor().errors().next().is_none());
}

#[test]
fn the_ground_is_seen_as_it_was_while_the_key_is_held() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    window.draw(&curve(6), Modifiers::NONE);
    let now = Window::heights(&path);
    let mode = window.editor().mode();
    window.harness.key_down(Key::V);
    window.settle();
    assert!(window.editor().sees_earlier() && window.editor().mode() == mode);
    window.harness.get_by_label_contains("As it was after entry 1");
    // Nothing is changed that is not seen.
    window.draw(&curve(5), Modifiers::NONE);
    window.run(Command::Undo);
    assert!(window.editor().last_message().unwrap().contains("go back to now"));
    assert!(Window::heights(&path) == now);
    window.harness.key_up(Key::V);
    window.settle();
    assert!(!window.editor().sees_earlier() && !window.editor().is_comparing());
    window.draw(&curve(5), Modifiers::NONE);
    assert_eq!(window.history().len(), 3);
    // While it is compared, the difference is back when the key is let go.
    window.run(Command::Compare);
    window.harness.key_down(Key::V);
    window.settle();
    assert!(window.editor().sees_earlier());
    window.harness.key_up(Key::V);
    window.settle();
    assert!(window.editor().is_comparing() && window.editor().mode() == Mode::Difference);
    // Without a key it stays until it is asked for again.
    window.run(Command::SeeEarlier);
    window.settle();
    assert!(window.editor().sees_earlier());
    window.run(Command::SeeEarlier);
    assert!(!window.editor().sees_earlier());
    assert!(window.editor().errors().next().is_none());
}

#[test]
fn the_map_shows_by_how_much_the_ground_differs() {
    let mut window = Window::open();
    window.draw(&curve(6), Modifiers::NONE);
    window.run(Command::Compare);
    window.click("Difference on the map");
    window.settle();
    window.frames(2);
    assert!(most_m(&window, "m higher now, blue") > 0.5);
    window.run(Command::Compare);
    assert!(window.harness.query_by_label_contains("m higher now, blue").is_none());
}

#[test]
fn closing_while_comparing_leaves_the_terrain_as_it_is() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    window.draw(&curve(6), Modifiers::NONE);
    let now = Window::heights(&path);
    window.run(Command::Mode(Mode::Difference));
    assert!(window.editor().is_comparing());
    let folder = window.close();
    assert!(Window::heights(&path) == now);
    let left: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().contains("-wal")), "{left:?}");
    // What was compared with what is not remembered.
    let mut window = Window::in_folder(folder);
    window.editor().open_last();
    window.settle();
    assert!(!window.editor().is_comparing() && window.editor().mode() != Mode::Difference);
}
