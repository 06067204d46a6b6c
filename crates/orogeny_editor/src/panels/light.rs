//! Light and water: how the ground is looked at.

use egui::{CollapsingHeader, DragValue, Slider, Ui};

use crate::editor::Editor;

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    let [low_m, high_m] =
        editor.document.as_ref().map_or([0.0, 1.0], |document| document.pane.view.range_m());
    let request = &mut editor.request;
    CollapsingHeader::new("Light and water").show(ui, |ui| {
        ui.add(Slider::new(&mut request.sun_azimuth_degrees, 0.0..=360.0).suffix("°").text("Sun from"))
            .on_hover_text("Degrees from north, clockwise; also L and the left button over the ground");
        ui.add(Slider::new(&mut request.sun_altitude_degrees, -5.0..=90.0).suffix("°").text("Sun's height"));
        ui.add(Slider::new(&mut request.haze, 0.0..=20.0).text("Haze"));
        ui.add(Slider::new(&mut request.slope_exaggeration, 0.0..=10.0).text("Slopes")).on_hover_text(
            "How many times as steep slopes are for light: more where flat land is to show its shape",
        );
        ui.add(Slider::new(&mut request.exposure_stops, -4.0..=4.0).text("Exposure"));
        ui.checkbox(&mut request.has_shadows, "Shadows");
        let mut has_water = request.water_level_m.is_some();
        ui.horizontal(|ui| {
            if ui.checkbox(&mut has_water, "Water").changed() {
                request.water_level_m = has_water.then_some(low_m + (high_m - low_m) / 4.0);
            }
            if let Some(level_m) = &mut request.water_level_m {
                ui.add(DragValue::new(level_m).range(-1.0e5..=1.0e5).suffix(" m"));
            }
        });
    });
}
