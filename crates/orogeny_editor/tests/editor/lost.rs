//! The device that draws is lost.

use egui::{Event, Modifiers};
use orogeny_engine::Terrain;

use crate::support::{Window, curve};

/// In mid-stroke; what was acknowledged before stays, the stroke goes on, and what is drawn afterwards is drawn on the new device.
#[test]
fn a_device_that_is_lost_in_mid_stroke_costs_nothing() {
    let mut window = Window::open();
    let path = window.path("t.orogeny");
    window.draw(&curve(6), Modifiers::NONE);
    let acknowledged = window.history();
    let points = curve(20);
    window.button(points[0], true, Modifiers::NONE);
    for (index, point) in points.iter().enumerate() {
        if index == 10 {
            window.gpu.device().destroy();
        }
        window.harness.event(Event::PointerMoved(*point));
        window.harness.step();
    }
    let lost = window.gpu.check().unwrap_err().to_string();
    assert!(lost.contains("lost"), "{lost}");
    // As the window does: another device, and everything that was on the old one.
    let gpu = Window::new_gpu();
    window.editor().set_gpu(gpu.clone());
    window.gpu = gpu;
    window.button(points[19], false, Modifiers::NONE);
    window.settle();
    window.gpu.check().unwrap();
    assert_eq!(window.history(), [acknowledged, vec!["stroke raise".to_owned()]].concat());
    let drawn = Window::heights(&path);
    window.draw(&curve(5), Modifiers::NONE);
    assert!(Window::heights(&path) != drawn);
    window.gpu.check().unwrap();
    let folder = window.close();
    let report = Terrain::check(&folder.path().join("t.orogeny")).unwrap();
    assert!(report.problems.is_empty(), "{:?}", report.problems);
}
