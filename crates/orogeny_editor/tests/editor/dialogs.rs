//! Dialogs: making, opening, writing, preferences, first steps.

use std::path::PathBuf;

use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use orogeny_editor::{Command, Preferences};

use crate::support::{Window, curve, make_terrain};

#[test]
fn a_terrain_is_made_and_opened() {
    let mut window = Window::empty();
    let path = window.path("new.orogeny");
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::N);
    window.frames(3);
    window.type_into("Path", &path.display().to_string());
    window.click("Make");
    window.settle();
    assert_eq!(window.editor().open_file(), Some(path.as_path()));
    assert_eq!(window.layers(), ["Base"]);
    // A second one of that name is refused, and what is open stays.
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::N);
    window.frames(3);
    window.type_into("Path", &path.display().to_string());
    window.click("Make");
    window.settle();
    assert!(window.editor().errors().last().unwrap().contains("new.orogeny"));
    assert_eq!(window.editor().open_file(), Some(path.as_path()));
}

#[test]
fn heights_are_written_and_read() {
    let mut window = Window::open();
    let (terrain, file) = (window.path("t.orogeny"), window.path("out.tif"));
    window.draw(&curve(6), Modifiers::NONE);
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::E);
    window.frames(3);
    window.harness.get_by_label_contains("% of 16 bits used");
    window.type_into("Path", &file.display().to_string());
    window.click("Export");
    window.settle();
    let bytes = std::fs::read(&file).unwrap();
    assert!(bytes.starts_with(b"II") || bytes.starts_with(b"MM"), "no TIFF");
    let before = Window::heights(&terrain);
    // Taken back, and read again from the file: the same heights.
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.settle();
    assert!(Window::heights(&terrain) != before);
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::I);
    window.frames(3);
    window.type_into("Path", &file.display().to_string());
    window.click("Import");
    window.settle();
    let said: Vec<_> = window.editor().errors().collect();
    assert!(said.is_empty(), "{said:?}");
    assert!(Window::heights(&terrain) == before);
}

#[test]
fn sixteen_bits_hold_all_of_the_terrain_s_heights() {
    let mut window = Window::open();
    let (terrain, file) = (window.path("t.orogeny"), window.path("out.r16"));
    window.run(Command::Export);
    window.frames(3);
    window.type_into("Path", &file.display().to_string());
    window.harness.get_by_label("100 % of 16 bits used");
    window.harness.get_by_label_contains("The first sample is the north-west corner");
    window.click("Export");
    window.settle();
    let told = window.editor().last_message().unwrap().to_owned();
    let numbers: Vec<f64> = told.split(' ').filter_map(|word| word.parse().ok()).collect();
    // `sample 0 is LOW m, sample 65,535 is HIGH m`.
    let (low_m, high_m) = (numbers[1], numbers[2]);
    let bytes = std::fs::read(&file).unwrap();
    let heights = Window::heights(&terrain);
    assert_eq!(bytes.len(), 2 * heights.len());
    let step_m = (high_m - low_m) / 65_535.0;
    for (pair, bits) in bytes.chunks_exact(2).zip(heights) {
        let height_m = low_m + f64::from(u16::from_le_bytes([pair[0], pair[1]])) * step_m;
        assert!((height_m - f64::from(f32::from_bits(bits))).abs() < step_m + 0.001, "{height_m}");
    }
}

#[test]
fn files_that_are_dropped_are_opened_or_offered() {
    let mut window = Window::open();
    let before = Window::heights(&window.path("t.orogeny"));
    std::fs::write(window.path("h.r16"), vec![9_u8; 2 * 600 * 600]).unwrap();
    window.drop_file("h.r16");
    window.frames(3);
    window.click("Import");
    window.settle();
    assert_eq!(window.history(), ["fill noise", "import"]);
    assert!(Window::heights(&window.path("t.orogeny")) != before);
    window.drop_file("readme.txt");
    window.frames(2);
    assert!(window.editor().errors().last().unwrap().contains("readme.txt"));
    make_terrain(&window.path("other.orogeny"));
    window.drop_file("other.orogeny");
    window.settle();
    assert_eq!(window.editor().open_file().unwrap().file_name().unwrap(), "other.orogeny");
}

#[test]
fn the_first_steps_are_shown_once() {
    let mut window = Window::in_folder(tempfile::tempdir().unwrap());
    window.frames(2);
    for (_, button) in (0..5).zip(["Next", "Next", "Next", "Next", "Done"]) {
        window.click(button);
    }
    assert!(window.harness.query_by_label("Done").is_none());
    let folder = window.close();
    let window = Window::in_folder(folder);
    assert!(window.harness.query_by_label("Next").is_none());
}

#[test]
fn the_next_start_is_where_one_was() {
    let mut window = Window::open();
    let ctx = window.harness.ctx.clone();
    window.editor().run(Command::Brush(orogeny_engine::BrushType::Smooth), &ctx);
    window.editor().run(Command::Larger, &ctx);
    window.editor().run(Command::LookDown, &ctx);
    window.editor().run(Command::ToggleTheme, &ctx);
    window.frames(2);
    let (eye, radius_m) = (window.editor().camera().unwrap().eye_m, window.editor().brush_radius_m());
    let folder = window.close();
    let preferences = Preferences::read(&folder.path().join("editor.json")).unwrap();
    assert!(preferences.is_light && preferences.brush == "smooth");
    let mut window = Window::in_folder(folder);
    window.editor().open_last();
    window.settle();
    assert_eq!(window.editor().open_file().unwrap().file_name().unwrap(), "t.orogeny");
    assert_eq!(window.editor().camera().unwrap().eye_m, eye);
    assert_eq!(window.editor().brush_radius_m(), radius_m);
}

/// A terrain that is named from the folder that the program was started in is found from any other.
#[test]
fn what_was_open_is_remembered_by_all_of_its_path() {
    let mut window = Window::empty();
    let path = window.path("t.orogeny");
    make_terrain(&path);
    let depth = std::env::current_dir().unwrap().components().count() - 1;
    let from_here: PathBuf =
        std::iter::repeat_n("..".into(), depth).chain([path.strip_prefix("/").unwrap().to_owned()]).collect();
    assert!(from_here.is_relative() && from_here.is_file());
    window.editor().open(&from_here);
    window.settle();
    let folder = window.close();
    let preferences = Preferences::read(&folder.path().join("editor.json")).unwrap();
    assert!(
        preferences.recent[0].is_absolute() && preferences.recent[0].is_file(),
        "{:?}",
        preferences.recent
    );
}

#[test]
fn with_nothing_known_the_terrain_that_comes_along_is_opened() {
    let mut window = Window::empty();
    window.editor().open_last();
    window.settle();
    assert_eq!(window.editor().open_file().unwrap().file_name().unwrap(), "bundled.orogeny");
    let node = window.harness.get_by_label_contains("The terrain: draw");
    assert!(node.rect().width() > 300.0 && !node.accesskit_node().is_disabled());
}
