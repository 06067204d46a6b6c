//! Panels: what stands in them, and what it looks like.

use egui::Modifiers;
use egui_kittest::SnapshotOptions;
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::{Command, Hand};
use orogeny_engine::{BrushType, Parameter};

use crate::support::{MIDDLE, Window, curve};

#[test]
fn every_brush_shows_its_parameters() {
    let mut window = Window::open();
    let ctx = window.harness.ctx.clone();
    for brush_type in BrushType::ALL {
        window.editor().run(Command::Brush(brush_type), &ctx);
        window.frames(2);
        for parameter in Parameter::of(brush_type) {
            let words = parameter.name.replace('_', " ");
            let title = words[..1].to_uppercase() + &words[1..];
            let found = window.harness.query_all_by_label_contains(&title).count();
            assert!(found > 0, "{brush_type:?}: {title}");
        }
    }
}

#[test]
fn the_search_leaves_the_brushes_that_it_names() {
    let mut window = Window::open();
    assert!(window.harness.query_by_label("Terrace").is_some());
    window.type_into("Search", "slope");
    assert!(window.harness.query_by_label("Terrace").is_none());
    window.harness.get_by_label("Ramp").click();
    window.frames(2);
    assert_eq!(window.editor().brush_type(), BrushType::Ramp);
}

#[test]
fn the_history_goes_to_any_entry() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    let before = Window::heights(&path);
    window.draw(&curve(4), Modifiers::NONE);
    window.draw(&curve(7), Modifiers::NONE);
    let after = Window::heights(&path);
    window.harness.get_by_label("1 Fill noise").click();
    window.settle();
    assert!(Window::heights(&path) == before);
    window.harness.get_by_label("3 Stroke raise").click();
    window.settle();
    assert!(Window::heights(&path) == after);
}

/// Panels as they look; the ground in them is left blank, as its picture has tests of its own. `UPDATE_SNAPSHOTS=1` renews them, to be looked at.
#[test]
fn panels_look_as_they_did() {
    let mut window = Window::open();
    let options = SnapshotOptions::new().threshold(0.8).max_failed_pixels(200);
    let ctx = window.harness.ctx.clone();
    window.harness.snapshot_options("window", &options);
    window.editor().run(Command::Export, &ctx);
    window.frames(3);
    window.harness.get_by_label_contains("% of 16 bits used");
    window.editor().run(Command::Cancel, &ctx);
    window.editor().run(Command::ToggleTheme, &ctx);
    window.editor().run(Command::ShowTutorial, &ctx);
    window.frames(3);
    window.harness.snapshot_options("first_steps_light", &options);
    window.editor().run(Command::Cancel, &ctx);
    window.editor().run(Command::ToggleTheme, &ctx);
    window.run(Command::ShowMap);
    window.run(Command::ShowHistogram);
    window.run(Command::Hand(Hand::Tape));
    window.draw(&[MIDDLE, MIDDLE + egui::vec2(90.0, -40.0)], Modifiers::NONE);
    window.frames(3);
    window.harness.snapshot_options("map_histogram_tape", &options);
    window.run(Command::ShowMap);
    window.run(Command::ShowHistogram);
    window.click("Clear");
    window.run(Command::Hand(Hand::Brush));
    window.click("Select");
    window.frames(20);
    window.harness.snapshot_options("select", &options);
}

/// What an export is going to be, and presets with their pictures.
#[test]
fn exports_and_presets_look_as_they_did() {
    let mut window = Window::open();
    let options = SnapshotOptions::new().threshold(0.8).max_failed_pixels(200);
    window.run(Command::Export);
    // From where tests run: no path of the machine is in a picture.
    window.type_into("Path", "terrains/island.r16");
    window.click("Preset");
    window.click("Unreal R16");
    window.harness.event(egui::Event::PointerGone);
    window.frames(20);
    window.harness.snapshot_options("export", &options);
    window.run(Command::Cancel);
    window.type_into("Search", "trench");
    window.harness.event(egui::Event::PointerGone);
    window.settle();
    window.frames(20);
    window.harness.snapshot_options("presets", &options);
}
