//! Selections by hand and by the panel.

use egui::{Event, Key, Modifiers, pos2};
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::{Command, Hand};

use crate::support::{MIDDLE, Window};

/// How many samples are selected at least by half.
fn num_selected(window: &Window) -> usize {
    Window::selected(&window.path("t.orogeny")).iter().filter(|share| **share >= 0.5).count()
}

const CORNERS: [egui::Pos2; 2] =
    [pos2(MIDDLE.x - 60.0, MIDDLE.y - 40.0), pos2(MIDDLE.x + 20.0, MIDDLE.y + 30.0)];

#[test]
fn rectangles_replace_add_take_away_and_intersect() {
    let mut window = Window::open();
    window.run(Command::LookDown);
    window.harness.key_press(Key::R);
    window.frames(2);
    assert_eq!(window.editor().hand(), Hand::Rectangle);
    window.draw(&CORNERS, Modifiers::NONE);
    assert_eq!(window.history(), ["fill noise", "select"]);
    let one = num_selected(&window);
    assert!(one > 400, "{one}");
    // The right half of it, and as much beyond.
    let half = [pos2(MIDDLE.x - 20.0, MIDDLE.y - 40.0), pos2(MIDDLE.x + 60.0, MIDDLE.y + 30.0)];
    window.draw(&half, Modifiers::SHIFT);
    let both = num_selected(&window);
    assert!((both as f64 / one as f64 - 1.5).abs() < 0.05, "{both} of {one}");
    window.draw(&half, Modifiers::COMMAND);
    let left = num_selected(&window);
    assert!((left as f64 / one as f64 - 0.5).abs() < 0.05, "{left} of {one}");
    window.draw(&CORNERS, Modifiers::COMMAND | Modifiers::SHIFT);
    assert_eq!(num_selected(&window), left, "all of it lies within the first");
    window.draw(&half, Modifiers::NONE);
    assert!((num_selected(&window) as f64 / one as f64 - 1.0).abs() < 0.05);
    // A click selects nothing and is no entry.
    let num_entries = window.history().len();
    window.draw(&[MIDDLE, MIDDLE], Modifiers::NONE);
    assert_eq!(window.history().len(), num_entries);
}

#[test]
fn a_lasso_selects_its_inside_and_escape_gives_it_up() {
    let mut window = Window::open();
    window.run(Command::LookDown);
    window.run(Command::Hand(Hand::Rectangle));
    window.draw(&CORNERS, Modifiers::NONE);
    let rectangle = num_selected(&window);
    window.run(Command::Hand(Hand::Lasso));
    // The triangle below the diagonal of that rectangle.
    let along =
        |from: egui::Pos2, to: egui::Pos2| (0..10).map(move |k| from + (to - from) * (k as f32 / 10.0));
    let [from, to] = CORNERS;
    let below = pos2(from.x, to.y);
    let path: Vec<_> = along(from, below).chain(along(below, to)).chain(along(to, from)).collect();
    window.draw(&path, Modifiers::NONE);
    let triangle = num_selected(&window);
    assert!((triangle as f64 / rectangle as f64 - 0.5).abs() < 0.08, "{triangle} of {rectangle}");
    let history = window.history();
    window.button(path[0], true, Modifiers::NONE);
    for point in &path {
        window.harness.event(Event::PointerMoved(*point));
        window.harness.step();
    }
    window.harness.key_press(Key::Escape);
    window.settle();
    window.button(path[3], false, Modifiers::NONE);
    window.settle();
    assert_eq!(window.history(), history);
}

#[test]
fn its_edge_grows_shrinks_and_fades() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    window.run(Command::LookDown);
    window.run(Command::Hand(Hand::Rectangle));
    window.draw(&CORNERS, Modifiers::NONE);
    let one = num_selected(&window);
    window.run(Command::GrowSelection);
    let grown = num_selected(&window);
    window.run(Command::ShrinkSelection);
    let shrunk = num_selected(&window);
    assert!(grown > one && shrunk < grown, "{one} {grown} {shrunk}");
    window.run(Command::FeatherSelection);
    let is_between = |share: &f32| *share > 0.01 && *share < 0.99;
    assert!(Window::selected(&path).iter().filter(|share| is_between(share)).count() > 100);
    window.run(Command::InvertSelection);
    let inverted = num_selected(&window);
    assert!(inverted > 600 * 600 / 2, "{inverted}");
    window.run(Command::SelectNothing);
    assert_eq!(num_selected(&window), 0);
    window.run(Command::SelectAll);
    assert_eq!(num_selected(&window), 600 * 600);
}

#[test]
fn the_panel_selects_by_height_and_by_slope() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    window.click("Select");
    window.settle();
    window.click("By height");
    window.settle();
    let heights = Window::heights(&path);
    let high = num_selected(&window);
    assert!(high > 1000 && high < 600 * 600 / 3 * 2, "{high}");
    // All that is selected is higher than all that is not.
    let selected = Window::selected(&path);
    let of = |is_wanted: &dyn Fn(f32) -> bool| {
        let chosen = heights.iter().zip(&selected).filter(|(_, share)| is_wanted(**share));
        chosen.map(|(bits, _)| f32::from_bits(*bits)).collect::<Vec<_>>()
    };
    let lowest = of(&|share| share >= 0.99).into_iter().fold(f32::INFINITY, f32::min);
    let highest = of(&|share| share <= 0.01).into_iter().fold(f32::NEG_INFINITY, f32::max);
    assert!(lowest >= highest, "{lowest} {highest}");
    window.click("By slope");
    window.settle();
    assert_eq!(window.history(), ["fill noise", "select", "select"]);
    assert!(window.harness.query_by_label("Feather").is_some());
    let said: Vec<_> = window.editor().errors().collect();
    assert!(said.is_empty(), "{said:?}");
}

#[test]
fn taking_a_brush_draws_again() {
    let mut window = Window::open();
    window.harness.key_press(Key::O);
    window.frames(2);
    assert_eq!(window.editor().hand(), Hand::Lasso);
    window.harness.key_press(Key::Num1);
    window.frames(2);
    assert_eq!(window.editor().hand(), Hand::Brush);
    window.draw(&crate::support::curve(5), Modifiers::NONE);
    assert_eq!(window.history(), ["fill noise", "stroke raise"]);
}
