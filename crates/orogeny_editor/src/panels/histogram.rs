//! How much of the terrain lies how high.

use egui::Ui;

use super::plot::{Plot, Style};
use crate::editor::Editor;
use crate::overview::{NUM_COLUMNS, histogram};

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    ui.heading("Heights");
    let Some(document) = &mut editor.document else { return };
    document.overview.want(&document.session);
    let Some(survey) = document.overview.survey() else {
        ui.label("On its way");
        return;
    };
    let (columns, [low_m, high_m]) = histogram(survey.heights_m());
    let plot = Plot {
        name: "How much of the terrain lies how high",
        values: &columns,
        style: Style::Columns,
        ends: [format!("{low_m:.1} m"), format!("{high_m:.1} m")],
        unit: None,
    };
    let total: f64 = columns.iter().sum();
    plot.show(ui, 110.0, |share| {
        let index = ((share * NUM_COLUMNS as f64) as usize).min(NUM_COLUMNS - 1);
        let step_m = (high_m - low_m) / NUM_COLUMNS as f32;
        let from_m = low_m + step_m * index as f32;
        let percent = 100.0 * columns.get(index).copied().unwrap_or_default() / total.max(1.0);
        format!("{percent:.1} % at {from_m:.1} to {:.1} m", from_m + step_m)
    });
    let (width, depth, each) = (survey.width(), survey.depth(), survey.samples_each);
    let text = format!("All of the terrain, in {width} x {depth} means of {each} x {each} samples");
    ui.label(egui::RichText::new(text).weak());
}
