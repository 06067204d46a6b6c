//! What an export is going to be, and what is in a file before it is imported.

use egui::Modifiers;
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::Command;
use orogeny_engine::presets::ExportPresets;

use crate::support::{Window, curve};

/// With the dialog for an export as a preset says.
fn exporting(preset: &str, name: &str) -> Window {
    let mut window = Window::open();
    window.run(Command::Export);
    let file = window.path(name);
    window.type_into("Path", &file.display().to_string());
    window.click("Preset");
    window.click(preset);
    window
}

#[test]
fn a_preset_says_what_the_file_is_and_what_has_to_be_typed_there() {
    let mut window = exporting("Unreal R16", "island.png");
    window.harness.get_by_label("100 % of 16 bits used");
    // 505 samples are the most that Unreal takes of 600; they reach from corner to corner.
    window.harness.get_by_label_contains("R16, 505 x 505 samples, 1.1885 m apart");
    window.harness.get_by_label_contains("Scale X 118.849, Y 118.849, Z ");
    window.harness.get_by_label_contains("Location Z ");
    window.click("Export");
    window.settle();
    assert_eq!(window.editor().errors().count(), 0, "{:?}", window.editor().last_message());
    assert_eq!(std::fs::metadata(window.path("island.r16")).unwrap().len(), 2 * 505 * 505);
}

#[test]
fn unity_has_its_southern_row_first() {
    let mut window = exporting("Unity RAW", "island.png");
    window.harness.get_by_label_contains("Byte Order Windows");
    window.harness.get_by_label_contains("The first sample is the south-west corner");
    window.click("Export");
    window.settle();
    let bytes = std::fs::read(window.path("island.raw")).unwrap();
    assert_eq!(bytes.len(), 2 * 513 * 513);
    let sample = |index: usize| u16::from_le_bytes([bytes[2 * index], bytes[2 * index + 1]]);
    let heights = Window::heights(&window.path("t.orogeny"));
    let height_m = |x: usize, z: usize| f32::from_bits(heights[600 * z + x]);
    let all: Vec<f32> = heights.iter().map(|bits| f32::from_bits(*bits)).collect();
    let low_m = all.iter().copied().fold(f32::INFINITY, f32::min);
    let high_m = all.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let back_m = |index: usize| low_m + f32::from(sample(index)) / 65_535.0 * (high_m - low_m);
    for (index, [x, z]) in [(0, [0, 599]), (512, [599, 599]), (512 * 513, [0, 0])] {
        assert!(
            (back_m(index) - height_m(x, z)).abs() < 0.01,
            "{index}: {} {}",
            back_m(index),
            height_m(x, z)
        );
    }
}

#[test]
fn an_export_of_one_s_own_is_kept_in_a_file() {
    let mut window = exporting("Godot HTerrain RAW", "island.png");
    window.type_into("Name of the export", "Our island");
    window.click("Save export");
    let own = ExportPresets::open(Some(window.path("presets/exports")));
    assert_eq!(own.get("Our island").unwrap().ending, "raw");
    window.click("Preset");
    window.click("Our island");
    window.click("Delete");
    assert!(ExportPresets::open(Some(window.path("presets/exports"))).get("Our island").is_err());
    assert_eq!(window.editor().errors().count(), 0);
}

#[test]
fn a_file_is_seen_before_it_is_imported() {
    let mut window = Window::open();
    let file = window.path("h.npy");
    window.draw(&curve(6), Modifiers::NONE);
    window.run(Command::Export);
    window.type_into("Path", &file.display().to_string());
    window.click("Export");
    window.settle();
    let before = Window::heights(&window.path("t.orogeny"));
    window.run(Command::Import);
    window.type_into("Path", &file.display().to_string());
    window.settle();
    window.harness.get_by_label("600 x 600 samples");
    window.harness.get_by_label("It covers 100.0 % of the terrain");
    let picture = window.harness.get_by_label("The file from above, north at the top").rect();
    assert!(picture.width() > 150.0, "{picture:?}");
    // Moved to the south-east, what is beyond the edge is left out.
    window.type_number("x", "300");
    window.harness.get_by_label("It covers 50.0 % of the terrain");
    window.harness.get_by_label_contains("edge is left out");
    window.click("Import");
    window.settle();
    let after = Window::heights(&window.path("t.orogeny"));
    assert_eq!(after[300..600], before[..300]);
    assert_eq!(after[..300], before[..300]);
}

#[test]
fn what_a_file_does_not_say_is_asked_for() {
    let mut window = Window::open();
    let samples: Vec<u8> = (0..120_u16 * 50).flat_map(|k| (k % 120).to_le_bytes()).collect();
    std::fs::write(window.path("h.raw"), samples).unwrap();
    window.drop_file("h.raw");
    window.settle();
    // 77 x 77 is not all of it.
    assert!(window.harness.query_by_label("77 x 77 samples").is_none());
    window.click("Square");
    for (label, text) in [("wide", "120"), ("deep", "50")] {
        window.type_number(label, text);
    }
    window.settle();
    window.harness.get_by_label("120 x 50 samples");
    window.harness.get_by_label("0.00 to 119.00 m high");
    window.click("Import");
    window.settle();
    let heights = Window::heights(&window.path("t.orogeny"));
    assert_eq!(f32::from_bits(heights[600 * 49 + 119]), 119.0);
}

#[test]
fn a_file_is_turned_before_it_is_imported() {
    let mut window = Window::open();
    // 120 x 50 samples, each of another height.
    let samples: Vec<u8> = (0..120 * 50).flat_map(|k: u16| k.to_le_bytes()).collect();
    std::fs::write(window.path("h.raw"), samples).unwrap();
    window.drop_file("h.raw");
    window.settle();
    window.click("Square");
    for (label, text) in [("wide", "120"), ("deep", "50")] {
        window.type_number(label, text);
    }
    window.settle();
    let picture =
        |window: &Window| window.harness.get_by_label("The file from above, north at the top").rect();
    assert!(picture(&window).width() > picture(&window).height());
    window.click("Turn right");
    window.settle();
    window.harness.get_by_label("50 x 120 samples");
    window.harness.get_by_label("Turned by 90° clockwise");
    assert!(picture(&window).width() < picture(&window).height());
    window.click("Mirror north-south");
    window.settle();
    window.harness.get_by_label("Turned by 90° clockwise, then mirrored north-south");
    window.click("Import");
    window.settle();
    let heights = Window::heights(&window.path("t.orogeny"));
    let at = |x: usize, z: usize| f32::from_bits(heights[600 * z + x]);
    // By a quarter its western column is the northern row, from the east; mirrored that is the southern one.
    for (x, z) in [(0, 0), (49, 0), (0, 119), (49, 119), (13, 77)] {
        let (column, row) = (119 - z, 49 - x);
        assert_eq!(at(x, z), (120 * row + column) as f32, "{x} {z}");
    }
    assert_eq!(window.editor().errors().count(), 0);
}
