//! Brushes that the user wrote.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use orogeny_engine::BrushType;

use crate::support::Window;

const LIFT: &str = "// Lifts the ground.\n// @param lift_m: f32 = 5 (0 .. 50) \"how far, metres\"\n\
    fn brush(at: BrushInput) -> f32 {\n    return at.height_m + parameters.lift_m * at.weight;\n}\n";

/// With a brush in the folder for them.
fn window() -> Window {
    let mut window = Window::open();
    std::fs::create_dir_all(window.path("brushes")).unwrap();
    std::fs::write(window.path("brushes/lift_up.wgsl"), LIFT).unwrap();
    window.click("Reload");
    window
}

#[test]
fn those_of_the_folder_are_in_the_palette_with_their_parameters() {
    let mut window = window();
    window.click("Lift up");
    assert_eq!(window.editor().brush_type(), BrushType::Custom);
    window.harness.get_by_label("Lifts the ground.");
    // Each has its value, its unit and a way back.
    let number = window.harness.get_by_role_and_label(Role::SpinButton, "Lift");
    assert_eq!(number.value().as_deref(), Some("5.0 m"));
    number.focus();
    window.frames(2);
    window.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.frames(1);
    window.harness.event(egui::Event::Text("70".to_owned()));
    window.harness.key_press(egui::Key::Enter);
    window.frames(3);
    let value = |window: &Window| window.harness.get_by_role_and_label(Role::SpinButton, "Lift").value();
    assert_eq!(value(&window).as_deref(), Some("50.0 m"), "beyond its range");
    assert_eq!(window.editor().brush_json()["parameters"]["lift_m"], 50.0);
    window.harness.get_all_by_label("x").next().unwrap().click();
    window.frames(3);
    assert_eq!(value(&window).as_deref(), Some("5.0 m"));
}

#[test]
fn a_file_that_breaks_is_told_and_its_last_good_version_stays() {
    let mut window = window();
    window.click("Lift up");
    std::fs::write(window.path("brushes/lift_up.wgsl"), LIFT.replace("weight;", "waight; // broken"))
        .unwrap();
    window.click("Reload");
    let told = window.editor().errors().last().unwrap().to_owned();
    assert!(told.contains("lift_up.wgsl:4"), "{told}");
    window.harness.get_by_label_contains("Mend that line");
    window.harness.get_by_role_and_label(Role::SpinButton, "Lift");
    // What is painted with is a copy that compiles, and is not what a preset would name.
    let (painted, kept) =
        (window.editor().painted_file().unwrap(), window.editor().brush_json()["file"].clone());
    assert_eq!(std::fs::read_to_string(&painted).unwrap(), LIFT);
    assert!(kept.as_str().unwrap().ends_with("brushes/lift_up.wgsl") && kept != painted.as_str());
    let num_told = window.editor().errors().count();
    window.click("Reload");
    assert_eq!(window.editor().errors().count(), num_told, "it is told once");
    std::fs::write(window.path("brushes/lift_up.wgsl"), LIFT.replace("Lifts the ground", "Lifts more"))
        .unwrap();
    window.click("Reload");
    window.harness.get_by_label("Lifts more.");
    assert!(window.harness.query_by_label_contains("Mend that line").is_none());
    assert_eq!(window.editor().painted_file().as_deref(), kept.as_str());
}

#[test]
fn a_file_that_is_dropped_is_kept_for_the_next_start() {
    let mut window = Window::open();
    std::fs::write(window.path("dent.wgsl"), LIFT.replace("Lifts", "Dents")).unwrap();
    window.drop_file("dent.wgsl");
    window.frames(3);
    window.harness.get_by_label("Dents the ground.");
    std::fs::write(window.path("bad.wgsl"), "fn no() {}").unwrap();
    window.drop_file("bad.wgsl");
    window.frames(3);
    assert!(window.editor().errors().last().unwrap().contains("bad.wgsl"));
    let mut window = Window::in_folder(window.close());
    window.frames(2);
    // It is in the palette, and in the hand as it was before.
    window.harness.get_by_role_and_label(Role::Button, "Dent");
    window.harness.get_by_label("Dents the ground.");
}
