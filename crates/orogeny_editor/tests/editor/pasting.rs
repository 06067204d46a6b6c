//! Copying ground, and putting it down elsewhere.

use egui::{Event, Key, Modifiers, pos2};
use egui_kittest::kittest::Queryable as _;
use orogeny_editor::{Command, Hand};
use orogeny_engine::{Quiet, Terrain, TerrainGrid};

use crate::support::{MIDDLE, Window, settings};

/// A terrain looked down on, with a rectangle of it copied.
fn with_something_copied() -> Window {
    let mut window = Window::open();
    window.run(Command::LookDown);
    window.run(Command::Hand(Hand::Rectangle));
    let corner = pos2(MIDDLE.x - 60.0, MIDDLE.y - 60.0);
    window.draw(&[corner, pos2(MIDDLE.x - 20.0, MIDDLE.y - 20.0)], Modifiers::NONE);
    // As keys of the clipboard come.
    window.harness.event(Event::Copy);
    window.frames(2);
    window.settle();
    assert!(window.editor().last_message().unwrap().contains("are copied"));
    window
}

#[test]
fn what_is_copied_floats_is_moved_and_is_put_down() {
    let mut window = with_something_copied();
    let path = window.path("t.orogeny");
    let before = Window::heights(&path);
    window.harness.event(Event::PointerMoved(pos2(MIDDLE.x + 40.0, MIDDLE.y + 40.0)));
    window.frames(2);
    window.harness.event(Event::Paste(String::new()));
    window.frames(2);
    window.harness.get_by_label("Floating piece");
    let floating = window.editor().piece().unwrap().clone();
    assert!(Window::heights(&path) == before, "it only floats");
    // Dragged by its inside, beside its handles, without a selection or a stroke.
    let inside = pos2(MIDDLE.x + 55.0, MIDDLE.y + 40.0);
    window.draw(&[inside, inside + egui::vec2(20.0, 10.0)], Modifiers::NONE);
    let moved = window.editor().piece().unwrap().clone();
    assert!(moved.to_m[0] > floating.to_m[0] + 5.0 && moved.to_m[1] > floating.to_m[1] + 2.0, "{moved:?}");
    assert_eq!(window.history(), ["fill noise", "select"]);
    window.harness.key_press(Key::Enter);
    window.settle();
    assert!(window.editor().piece().is_none());
    assert_eq!(window.history(), ["fill noise", "select", "fill clone"]);
    let after = Window::heights(&path);
    // Something changed around where it was put, and nothing where it came from.
    let changed = before.iter().zip(&after).enumerate().filter(|(_, (before, after))| before != after);
    let places: Vec<_> = changed.map(|(index, _)| [index % 600, index / 600]).collect();
    let [x_m, z_m, width_m, depth_m] = moved.region_m;
    assert!(places.len() as f64 > width_m * depth_m / 4.0, "{}", places.len());
    let is_source = |place: &&[usize; 2]| {
        let [x, z] = place.map(|along| along as f64);
        (x_m..x_m + width_m / 2.0).contains(&x) && (z_m..z_m + depth_m / 2.0).contains(&z)
    };
    assert_eq!(places.iter().find(is_source), None);
    window.run(Command::Undo);
    assert!(Window::heights(&path) == before);
}

#[test]
fn what_floats_is_turned_by_its_panel_and_dropped_by_escape() {
    let mut window = with_something_copied();
    let history = window.history();
    window.run(Command::Paste);
    window.click("Mirrored");
    assert!(window.editor().piece().unwrap().is_mirrored);
    let options = egui_kittest::SnapshotOptions::new().threshold(0.8).max_failed_pixels(200);
    window.frames(12);
    window.harness.snapshot_options("floating_piece", &options);
    window.harness.key_press(Key::Escape);
    window.settle();
    assert!(window.editor().piece().is_none());
    window.run(Command::PutDown);
    assert_eq!(window.history(), history);
}

#[test]
fn with_nothing_selected_nothing_is_copied() {
    let mut window = Window::open();
    window.run(Command::Paste);
    assert!(window.editor().last_message().unwrap().contains("nothing was copied"));
    window.run(Command::Copy);
    assert!(window.editor().last_message().unwrap().contains("nothing is selected"));
    assert!(window.editor().piece().is_none());
}

#[test]
fn what_was_copied_is_put_down_in_another_terrain() {
    let mut window = with_something_copied();
    let from = Window::heights(&window.path("t.orogeny"));
    let path = window.path("flat.orogeny");
    let grid = TerrainGrid::new(600, 600, 1.0).unwrap();
    Terrain::create(&path, grid, -40.0, settings()).unwrap().close().unwrap();
    window.editor().open(&path);
    window.settle();
    window.harness.event(Event::PointerGone);
    window.frames(2);
    window.run(Command::Paste);
    let [x_m, z_m, width_m, depth_m] = window.editor().piece().unwrap().region_m;
    window.click("How it goes over into the ground");
    window.click("As it is");
    window.run(Command::PutDown);
    let said: Vec<_> = window.editor().errors().collect();
    assert!(said.is_empty(), "{said:?}");
    assert_eq!(window.history(), ["fill clone"]);
    // As it is, it lies where it was copied, with every bit; around it nothing changed.
    let now = Window::heights(&path);
    let (mut num_same, mut num_others) = (0, 0);
    for (index, (was, is)) in from.iter().zip(&now).enumerate() {
        let [x, z] = [index % 600, index / 600].map(|along| along as f64);
        let is_inside = (x_m..x_m + width_m).contains(&x) && (z_m..z_m + depth_m).contains(&z);
        match f32::from_bits(*is) {
            -40.0 => num_others += usize::from(is_inside),
            _ => {
                assert!(is_inside && was == is, "{x} {z}: {}", f32::from_bits(*is));
                num_same += 1;
            }
        }
    }
    assert!(
        num_same as f64 > 0.9 * width_m * depth_m && num_others < num_same / 10,
        "{num_same} {num_others}"
    );
    // The terrain that it came from is not needed any more.
    let folder = window.close();
    std::fs::remove_file(folder.path().join("t.orogeny")).unwrap();
    let again = folder.path().join("again.orogeny");
    let flat = Terrain::open_to_read(&folder.path().join("flat.orogeny"), settings()).unwrap();
    flat.replay(&again, settings(), &mut Quiet).unwrap();
    assert!(Window::heights(&again) == now);
}
