//! Curves: dragged, added, removed, typed and taken from shapes.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect};
use egui_kittest::kittest::Queryable as _;
use serde_json::{Value, json};

use crate::support::Window;

/// With the curve of the brush's profile unfolded.
fn window() -> Window {
    let mut window = Window::open();
    // Each of its frames is a quarter of a second.
    window.harness.ctx.options_mut(|options| options.input_options.max_double_click_delay = 3.0);
    // Its header is far down in a panel that scrolls.
    window.harness.get_by_label("Profile curve").scroll_to_me();
    window.frames(12);
    window.click("Profile curve");
    window.frames(12);
    window.harness.get_by_label("Add point").scroll_to_me();
    window.frames(12);
    window
}

fn drawing(window: &Window) -> Rect {
    window.harness.get_by_label_contains("Curve of profile curve").rect().shrink(8.0)
}

/// A place of the drawing, from 0 to 1 each way.
fn at(window: &Window, x: f32, y: f32) -> Pos2 {
    let rect = drawing(window);
    Pos2::new(rect.left() + x * rect.width(), rect.bottom() - y * rect.height())
}

fn press(window: &mut Window, pos: Pos2, button: PointerButton) {
    window.harness.event(Event::PointerMoved(pos));
    window.harness.step();
    for pressed in [true, false] {
        window.harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        window.harness.step();
    }
}

fn curve(window: &mut Window) -> Value {
    window.editor().brush_json().get("profile_curve").cloned().unwrap_or_default()
}

fn points(window: &mut Window) -> Vec<[f64; 2]> {
    serde_json::from_value(curve(window)).unwrap()
}

#[test]
fn a_shape_is_taken_and_its_points_are_dragged() {
    let mut window = window();
    assert_eq!(curve(&mut window), Value::Null);
    window.click("Shape");
    window.click("Line down");
    assert_eq!(curve(&mut window), json!([[0.0, 1.0], [1.0, 0.0]]));
    // A curve without the choice of it would be refused.
    assert_eq!(window.editor().brush_json()["profile"], "curve");
    let (from, to) = (at(&window, 0.0, 1.0), at(&window, 0.0, 0.5));
    window.button(from, true, Modifiers::NONE);
    for share in [0.3, 0.7, 1.0] {
        window.harness.event(Event::PointerMoved(from + (to - from) * share));
        window.harness.step();
    }
    window.button(to, false, Modifiers::NONE);
    let dragged = points(&mut window);
    assert!((dragged[0][1] - 0.5).abs() < 0.03 && dragged[1] == [1.0, 0.0], "{dragged:?}");
}

#[test]
fn a_double_click_adds_a_point_and_the_right_button_or_delete_takes_it_away() {
    let mut window = window();
    let place = at(&window, 0.5, 0.9);
    for _ in 0..2 {
        press(&mut window, place, PointerButton::Primary);
    }
    window.frames(2);
    let added = points(&mut window);
    assert!(
        added.len() == 3 && (added[1][0] - 0.5).abs() < 0.02 && (added[1][1] - 0.9).abs() < 0.03,
        "{added:?}"
    );
    press(&mut window, place, PointerButton::Secondary);
    window.frames(2);
    assert_eq!(points(&mut window).len(), 2);
    window.click("Add point");
    assert_eq!(points(&mut window), [[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]]);
    window.frames(20);
    let middle = at(&window, 0.5, 0.5);
    press(&mut window, middle, PointerButton::Primary);
    window.harness.key_press(Key::Delete);
    window.frames(2);
    assert_eq!(points(&mut window), [[0.0, 0.0], [1.0, 1.0]]);
}

#[test]
fn points_are_typed_and_the_default_comes_back() {
    let mut window = window();
    window.click("Add point");
    let number = window.harness.get_by_role_and_label(Role::SpinButton, "y of point 2");
    number.focus();
    window.frames(2);
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.frames(1);
    window.harness.event(Event::Text("0.125".to_owned()));
    window.harness.key_press(Key::Enter);
    window.frames(3);
    assert_eq!(points(&mut window)[1], [0.5, 0.125]);
    window.harness.get_by_label("Default").scroll_to_me();
    window.frames(12);
    window.click("Default");
    let brush = window.editor().brush_json();
    assert!(!brush.contains_key("profile_curve") && !brush.contains_key("profile"), "{brush:?}");
}
