//! The tape, the map, the histogram, and places that are kept.

use egui::{Key, Modifiers, pos2};
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::{Command, Hand};

use crate::support::{MIDDLE, Window};

#[test]
fn the_tape_measures_the_ground_under_it() {
    let mut window = Window::open();
    window.run(Command::LookDown);
    window.harness.key_press(Key::M);
    window.frames(2);
    assert_eq!(window.editor().hand(), Hand::Tape);
    let [from, to] = [pos2(MIDDLE.x - 80.0, MIDDLE.y), pos2(MIDDLE.x + 80.0, MIDDLE.y)];
    window.draw(&[from, pos2(MIDDLE.x, MIDDLE.y - 50.0), to], Modifiers::NONE);
    window.settle();
    let measured = window.editor().measured().unwrap();
    // What a window of 1,000 points shows, looking straight down, is on the map as it is on the screen.
    let eye = window.editor().camera().unwrap().eye();
    assert!(measured.length_m > 50.0 && measured.length_m < 2.0 * eye.y, "{}", measured.length_m);
    assert!(measured.along_ground_m() > measured.length_m);
    let [up_m, down_m] = measured.up_down_m();
    assert!((up_m - down_m - measured.difference_m()).abs() < 1.0e-6 && up_m + down_m > 0.5);
    window.harness.get_by_label("The ground along the line");
    window.harness.get_by_label_contains("m along the ground");
    assert_eq!(window.history(), ["fill noise"], "measuring changes nothing");
    // It measures what is there now.
    window.run(Command::Hand(Hand::Brush));
    let across: Vec<_> = (0..20).map(|k| pos2(MIDDLE.x, 250.0 + 10.0 * k as f32)).collect();
    window.draw(&across, Modifiers::NONE);
    assert_eq!(window.history(), ["fill noise", "stroke raise"]);
    let raised = window.editor().measured().unwrap();
    assert_eq!(raised.length_m, measured.length_m);
    assert!(raised.heights_m != measured.heights_m);
    window.click("Clear");
    assert!(window.editor().measured().is_none());
}

#[test]
fn a_click_on_the_map_goes_there() {
    let mut window = Window::open();
    window.run(Command::LookDown);
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::M);
    window.frames(3);
    window.settle();
    let map = window.harness.get_by_label_contains("The terrain from above").rect();
    assert!(map.width() > 100.0 && (map.width() - map.height()).abs() < 1.0, "{map:?}");
    let before = window.editor().camera().unwrap();
    let corner = map.min + 0.25 * map.size();
    window.button(corner, true, Modifiers::NONE);
    window.button(corner, false, Modifiers::NONE);
    window.settle();
    let after = window.editor().camera().unwrap();
    assert_eq!((before.heading, before.pitch), (after.heading, after.pitch));
    // It looks at the place that was clicked: a quarter of the way from the north-west corner.
    let (eye, ahead) = (after.eye(), after.ahead());
    let at = eye + ahead * ((10.0 - eye.y) / ahead.y);
    assert!((at.x - 150.0).abs() < 3.0 && (at.z - 150.0).abs() < 3.0, "{at}");
    assert_eq!(window.history(), ["fill noise"]);
}

#[test]
fn the_histogram_is_of_all_heights() {
    let mut window = Window::open();
    window.run(Command::ShowHistogram);
    window.settle();
    window.harness.get_by_label("How much of the terrain lies how high");
    window.harness.get_by_label("All of the terrain, in 300 x 300 means of 2 x 2 samples");
}

#[test]
fn places_are_kept_for_each_terrain_and_come_back_after_a_start() {
    let mut window = Window::open();
    let place = |window: &mut Window| window.editor().camera().unwrap();
    window.run(Command::GoToPlace(2));
    assert!(window.editor().last_message().unwrap().contains("no place was kept as 2"));
    window.run(Command::LookDown);
    let down = place(&mut window);
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::Num2);
    window.frames(2);
    window.run(Command::FrameAll);
    assert_ne!(place(&mut window), down);
    window.harness.key_press_modifiers(Modifiers::ALT, Key::Num2);
    window.frames(2);
    assert_eq!(place(&mut window), down);
    window.run(Command::FrameAll);
    let folder = window.close();
    let mut window = Window::in_folder(folder);
    window.editor().open_last();
    window.settle();
    window.run(Command::ShowMap);
    window.click("Go to place 2");
    assert_eq!(place(&mut window), down);
    assert_eq!(window.editor().brush_type().name(), "raise", "the number alone is a brush's key");
}
