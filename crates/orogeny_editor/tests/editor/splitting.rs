//! Two halves of the window over one terrain.

use egui::{ColorImage, Event, Key, Modifiers, PointerButton, Pos2, TextureId, vec2};
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::Command;
use orogeny_engine::Mode;

use crate::support::{Window, make_terrain, pixels};

const MINE: &str = "The terrain: draw";
const OTHER: &str = "The terrain from elsewhere";

impl Window {
    fn is_split(&self) -> bool {
        self.harness.query_by_label_contains(OTHER).is_some()
    }

    fn middle_of(&self, half: &str) -> Pos2 {
        self.harness.get_by_label_contains(half).rect().center()
    }

    /// The pictures of the halves, that of the one that is worked in first; each is named as it was at first.
    fn pictures(&mut self) -> Vec<(TextureId, ColorImage)> {
        // Something has just moved, so they are drawn as coarsely each time and without shadows, and no ring is in them.
        let at = self.middle_of(MINE);
        for event in [Event::PointerMoved(at), Event::PointerGone] {
            self.harness.event(event);
            self.harness.step();
        }
        self.editor().renew_pictures();
        let gpu = self.gpu.clone();
        let mut pictures: Vec<(TextureId, ColorImage)> = Vec::new();
        self.editor().take_pictures(|view, known| {
            let id = known.unwrap_or(TextureId::User(100 + pictures.len() as u64));
            pictures.push((id, pixels(&gpu, view)));
            id
        });
        pictures
    }
}

/// The share of pixels that differ clearly.
fn apart(a: &ColorImage, b: &ColorImage) -> f64 {
    assert_eq!(a.size, b.size);
    let differ = |(a, b): &(&egui::Color32, &egui::Color32)| {
        a.to_array().into_iter().zip(b.to_array()).any(|(a, b)| a.abs_diff(b) > 4)
    };
    a.pixels.iter().zip(&b.pixels).filter(differ).count() as f64 / a.pixels.len() as f64
}

#[test]
fn each_half_has_its_own_eye_and_mode() {
    let mut window = Window::open();
    let whole = window.harness.get_by_label_contains(MINE).rect();
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::Backslash);
    window.settle();
    assert!(window.is_split());
    let (mine, other) = (
        window.harness.get_by_label_contains(MINE).rect(),
        window.harness.get_by_label_contains(OTHER).rect(),
    );
    assert!(mine.right() < other.left() && mine.width() < 0.51 * whole.width(), "{mine:?} {other:?}");
    let (eye, mode) = (window.editor().camera().unwrap(), window.editor().mode());
    assert_ne!(mode, Mode::Slope);
    // The right one is worked in, looks down, and shows something else.
    window.harness.key_press(Key::Backslash);
    window.frames(2);
    assert!(window.middle_of(MINE).x > window.middle_of(OTHER).x);
    assert_eq!(window.editor().camera(), Some(eye), "it begins where the first one is");
    window.run(Command::LookDown);
    window.run(Command::Mode(Mode::Slope));
    let above = window.editor().camera().unwrap();
    assert!(above != eye && window.editor().mode() == Mode::Slope);
    // A press in the left one works in that.
    let at = window.middle_of(OTHER);
    window.harness.event(Event::PointerMoved(at));
    window.harness.step();
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Middle, Modifiers::NONE);
        window.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        window.harness.step();
    }
    assert_eq!((window.editor().camera(), window.editor().mode()), (Some(eye), mode));
    let shown = window.pictures();
    assert!(apart(&shown[0].1, &shown[1].1) > 0.3, "they show the same");
    // What is closed is the one that is not worked in.
    window.run(Command::SwitchView);
    window.run(Command::SplitView);
    assert!(!window.is_split());
    assert_eq!((window.editor().camera(), window.editor().mode()), (Some(above), Mode::Slope));
    assert_eq!(window.harness.get_by_label_contains(MINE).rect(), whole);
    assert_eq!(window.editor().errors().count(), 0);
}

#[test]
fn what_is_drawn_in_one_half_is_seen_in_both() {
    let mut window = Window::open();
    window.run(Command::SplitView);
    window.run(Command::SwitchView);
    window.run(Command::LookDown);
    for _ in 0..9 {
        window.run(Command::Larger);
        window.run(Command::Stronger);
    }
    window.settle();
    let before = window.pictures();
    let names: Vec<_> = before.iter().map(|(name, _)| *name).collect();
    let middle = window.middle_of(MINE);
    let heights = Window::heights(&window.path("t.orogeny"));
    let points: Vec<_> = (0..10).map(|k| middle + vec2(8.0 * k as f32 - 40.0, 0.0)).collect();
    window.draw(&points, Modifiers::NONE);
    window.frames(4);
    assert_eq!(window.history(), ["fill noise", "stroke raise"]);
    assert!(Window::heights(&window.path("t.orogeny")) != heights);
    let after = window.pictures();
    assert_eq!(after.iter().map(|(name, _)| *name).collect::<Vec<_>>(), names);
    for (before, after) in before.iter().zip(&after) {
        assert!(apart(&before.1, &after.1) > 0.01, "the stroke is not seen in {:?}", before.0);
    }
    // And it goes from both.
    window.run(Command::Undo);
    window.frames(4);
    for (before, undone) in before.iter().zip(window.pictures()) {
        assert!(apart(&before.1, &undone.1) < 0.002, "the stroke is still seen in {:?}", before.0);
    }
}

/// Bytes that the device has given out.
fn allocated(window: &Window) -> u64 {
    window.gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
    window.gpu.device().generate_allocator_report().unwrap().total_allocated_bytes
}

#[test]
fn what_the_other_half_held_is_given_back() {
    let mut window = Window::open();
    window.pictures();
    let before = allocated(&window);
    for round in 0..3 {
        window.run(Command::SplitView);
        let names: Vec<_> = window.pictures().into_iter().map(|(name, _)| name).collect();
        assert!(allocated(&window) > before + (1 << 20), "it has pages of its own");
        window.run(Command::SplitView);
        window.frames(4);
        assert!(allocated(&window) < before + (1 << 20), "round {round}: {} {before}", allocated(&window));
        assert_eq!(window.editor().take_left_pictures(), names[1..]);
    }
    // Another terrain leaves the pictures of both.
    window.run(Command::SplitView);
    window.pictures();
    let path = window.path("other.orogeny");
    make_terrain(&path);
    window.editor().open(&path);
    window.settle();
    assert!(!window.is_split());
    assert_eq!(window.editor().take_left_pictures().len(), 2);
}

#[test]
fn a_difference_is_shown_in_one_half_alone() {
    let mut window = Window::open();
    let middle = window.middle_of(MINE);
    window.draw(&[middle, middle + vec2(30.0, 0.0)], Modifiers::NONE);
    window.run(Command::SplitView);
    window.run(Command::Compare);
    assert_eq!(window.editor().mode(), Mode::Difference);
    window.run(Command::SwitchView);
    assert!(window.editor().mode() != Mode::Difference && window.editor().is_comparing());
    // As it was is seen in both.
    window.run(Command::SeeEarlier);
    assert!(window.editor().sees_earlier());
    window.run(Command::SeeEarlier);
    assert!(window.editor().is_comparing() && !window.editor().sees_earlier());
    // With the half that compares the past is closed.
    window.run(Command::SplitView);
    assert!(!window.editor().is_comparing());
    assert_eq!(window.editor().errors().count(), 0);
}

/// The device is lost with both halves open: both are drawn on the new one.
#[test]
fn both_halves_come_back_on_another_device() {
    let mut window = Window::open();
    window.run(Command::SplitView);
    window.pictures();
    window.gpu.device().destroy();
    window.frames(2);
    let gpu = Window::new_gpu();
    window.editor().set_gpu(gpu.clone());
    window.gpu = gpu;
    window.settle();
    let shown = window.pictures();
    assert_eq!(shown.len(), 2);
    let colours: std::collections::HashSet<_> = shown[1].1.pixels.iter().collect();
    assert!(colours.len() > 20, "{} colours", colours.len());
}
