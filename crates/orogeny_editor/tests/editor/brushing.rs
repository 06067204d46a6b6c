//! Strokes by mouse.

use egui::{Event, Key, Modifiers, PointerButton};
use egui_kittest::kittest::Queryable as _;

use crate::support::{MIDDLE, Window, curve};

#[test]
fn a_stroke_is_one_entry_and_is_taken_back_and_done_again() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    let before = Window::heights(&path);
    window.draw(&curve(12), Modifiers::NONE);
    assert_eq!(window.history(), ["fill noise", "stroke raise"]);
    let after = Window::heights(&path);
    let is_higher = |(before, after): (&u32, &u32)| f32::from_bits(*after) >= f32::from_bits(*before);
    assert!(before != after && before.iter().zip(&after).all(is_higher));
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.settle();
    assert!(Window::heights(&path) == before, "taken back");
    window.harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    window.settle();
    assert!(Window::heights(&path) == after, "done again");
    // The opposite, and smoothing, by keys that are held.
    window.draw(&curve(5), Modifiers::COMMAND);
    window.draw(&curve(5), Modifiers::SHIFT);
    assert_eq!(window.history()[2..], ["stroke lower", "stroke smooth"]);
}

#[test]
fn escape_takes_back_what_is_being_drawn() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    let before = Window::heights(&path);
    let points = curve(9);
    window.button(points[0], true, Modifiers::NONE);
    for point in &points {
        window.harness.event(Event::PointerMoved(*point));
        window.harness.step();
    }
    window.harness.key_press(Key::Escape);
    window.settle();
    window.button(points[8], false, Modifiers::NONE);
    window.settle();
    assert_eq!(window.history(), ["fill noise"]);
    assert!(Window::heights(&path) == before);
    assert!(window.editor().last_message().unwrap().contains("cancelled"));
}

/// The same pointer events at 15, 60 and 240 frames a second are the same stroke, bit for bit.
#[test]
fn strokes_do_not_depend_on_how_many_frames_they_take() {
    let points = curve(32);
    let mut results = Vec::new();
    for events_a_frame in [16, 4, 1] {
        let mut window = Window::open();
        window.button(points[0], true, Modifiers::NONE);
        for group in points.chunks(events_a_frame) {
            for point in group {
                window.harness.event(Event::PointerMoved(*point));
            }
            window.harness.step();
            // Slow frames see more of what was drawn before they go on.
            std::thread::sleep(std::time::Duration::from_millis(4 * events_a_frame as u64));
            window.frames(if events_a_frame == 4 { 3 } else { 1 });
        }
        window.button(points[31], false, Modifiers::NONE);
        window.settle();
        assert_eq!(window.history().len(), 2);
        let folder = window.close();
        results.push(Window::heights(&folder.path().join("t.orogeny")));
    }
    assert!(results[0] == results[1] && results[1] == results[2]);
}

#[test]
fn an_airbrush_goes_on_where_the_hand_rests() {
    let sum = |heights: &[u32]| heights.iter().map(|bits| f64::from(f32::from_bits(*bits))).sum::<f64>();
    let mut results = Vec::new();
    for (has_airbrush, num_frames) in [(false, 4), (false, 40), (true, 4), (true, 40)] {
        let mut window = Window::open();
        if has_airbrush {
            window.harness.get_by_label("Airbrush").scroll_to_me();
            window.frames(3);
            window.click("Airbrush");
        }
        window.button(MIDDLE, true, Modifiers::NONE);
        window.frames(num_frames);
        // A hand that is lifted does not move before.
        window.harness.event(Event::PointerButton {
            pos: MIDDLE,
            button: PointerButton::Primary,
            pressed: false,
            modifiers: Modifiers::NONE,
        });
        window.harness.step();
        window.settle();
        assert_eq!(window.history().len(), 2);
        let folder = window.close();
        results.push(sum(&Window::heights(&folder.path().join("t.orogeny"))));
    }
    assert_eq!(results[0], results[1], "a dab is a dab");
    // Of the plain dab as much as an airbrush adds in some time.
    assert!(results[3] - results[2] > results[2] - results[0], "{results:?}");
    assert!(results[3] > results[0] + 1.0, "{results:?}");
}

#[test]
fn keys_change_size_and_strength_and_the_wheel_comes_nearer() {
    let mut window = Window::open();
    let eye = |window: &mut Window| window.editor().camera().unwrap().eye();
    let (radius_m, share) = (window.editor().brush_radius_m(), window.editor().brush_share());
    for key in [Key::CloseBracket, Key::CloseBracket, Key::CloseBracket, Key::Minus, Key::Minus, Key::Minus] {
        window.harness.key_press(key);
        window.frames(1);
    }
    assert!((window.editor().brush_radius_m() / radius_m - 2.0).abs() < 1.0e-6);
    assert!((window.editor().brush_share() / share - 0.5).abs() < 1.0e-6);
    let before = eye(&mut window);
    window.harness.event(Event::PointerMoved(MIDDLE));
    window.frames(1);
    window.harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: egui::vec2(0.0, 3.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    window.frames(2);
    let near = eye(&mut window);
    assert!((near - before).length() > 1.0, "{before} {near}");
    // The middle button drags the ground.
    window.harness.event(Event::PointerButton {
        pos: MIDDLE,
        button: PointerButton::Middle,
        pressed: true,
        modifiers: Modifiers::NONE,
    });
    window.frames(1);
    window.harness.event(Event::PointerMoved(MIDDLE + egui::vec2(60.0, 10.0)));
    window.frames(1);
    let dragged = eye(&mut window);
    assert!((dragged - near).length() > 1.0 && (dragged.y - near.y).abs() < 1.0e-9);
    assert_eq!(window.history(), ["fill noise"], "looking changes nothing");
}
