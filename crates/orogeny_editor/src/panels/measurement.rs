//! What the tape measures: lengths, heights, slope, and the ground along it.

use egui::Ui;

use super::plot::{Plot, Style};
use crate::editor::Editor;

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    let Some(measured) = editor.measured() else {
        ui.heading("Measured");
        ui.label("Drag over the ground with the left button");
        // As high as with what is measured.
        ui.take_available_space();
        return;
    };
    let mut is_closed = false;
    ui.horizontal(|ui| {
        ui.heading("Measured");
        is_closed = ui.small_button("Clear").on_hover_text("Takes the tape away").clicked();
        let [up_m, down_m] = measured.up_down_m();
        ui.label(format!(
            "{:.1} m on the map   {:.1} m along the ground   height {:+.2} m ({up_m:.1} m up, {down_m:.1} m down)   slope {:.1}°",
            measured.length_m,
            measured.along_ground_m(),
            measured.difference_m(),
            measured.mean_slope_degrees(),
        ))
        .on_hover_text(
            "The slope is the mean of all steps, up or down. The ground is measured as finely as it has been drawn so far",
        );
    });
    let plot = Plot {
        name: "The ground along the line",
        values: &measured.heights_m,
        style: Style::Line,
        ends: ["0 m".to_owned(), format!("{:.1} m", measured.length_m)],
        unit: Some(" m"),
    };
    let height = ui.available_height();
    plot.show(ui, height, |share| {
        let index = (share * (measured.heights_m.len() - 1) as f64).round() as usize;
        let height_m = measured.heights_m.get(index).copied().unwrap_or_default();
        format!("{height_m:.2} m, {:.1} m from the start", share * measured.length_m)
    });
    if is_closed {
        editor.viewport.tape_m = None;
    }
}
