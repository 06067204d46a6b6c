//! Making a terrain: its file, size, spacing and height.

use std::path::PathBuf;

use egui::{Context, DragValue, TextEdit};
use orogeny_engine::TerrainGrid;

use super::Dialog;
use crate::editor::Editor;

/// What is typed so far.
#[derive(Debug, Clone)]
pub(crate) struct NewTerrain {
    pub(super) path: String,
    /// Whether it was not drawn yet.
    is_new: bool,
    num_samples: [i64; 2],
    spacing_m: f64,
    height_m: f32,
}

impl Dialog {
    /// Making a terrain beside the one that is open.
    pub(crate) fn new_terrain(editor: &Editor) -> Self {
        let folder = super::files::folder(editor);
        let is_free = |path: &PathBuf| !path.exists();
        let path =
            (1..).map(|k| folder.join(format!("terrain-{k}.orogeny"))).find(is_free).unwrap_or_default();
        Self::New(NewTerrain {
            path: path.display().to_string(),
            is_new: true,
            num_samples: [2049, 2049],
            spacing_m: 1.0,
            height_m: 0.0,
        })
    }
}

pub(super) fn show(editor: &mut Editor, ctx: &Context, mut new: NewTerrain) -> Option<Dialog> {
    let (mut is_made, mut is_browsing) = (false, false);
    let shown = super::window(ctx, "New terrain", |ui| {
        egui::Grid::new("new terrain").num_columns(2).show(ui, |ui| {
            let label = ui.label("Path");
            ui.horizontal(|ui| {
                let field = TextEdit::singleline(&mut new.path).desired_width(300.0);
                let field = ui.add(field).labelled_by(label.id);
                if std::mem::take(&mut new.is_new) {
                    field.request_focus();
                }
                is_browsing = ui.button("Browse…").clicked();
            });
            ui.end_row();
            let label = ui.label("Samples");
            ui.horizontal(|ui| {
                for num in &mut new.num_samples {
                    ui.add(DragValue::new(num).range(1..=1 << 20).speed(8)).labelled_by(label.id);
                }
            });
            ui.end_row();
            let label = ui.label("Spacing");
            ui.add(DragValue::new(&mut new.spacing_m).range(1.0e-3..=1.0e4).speed(0.05).suffix(" m"))
                .labelled_by(label.id);
            ui.end_row();
            let label = ui.label("Height");
            ui.add(DragValue::new(&mut new.height_m).speed(1.0).suffix(" m")).labelled_by(label.id);
            ui.end_row();
        });
        let [width_m, depth_m] = new.num_samples.map(|num| (num - 1) as f64 * new.spacing_m / 1000.0);
        ui.label(format!("{width_m:.2} km x {depth_m:.2} km"));
        is_made = ui.button("Make").clicked();
    });
    if is_made {
        let [width, depth] = new.num_samples;
        return match TerrainGrid::new(width.unsigned_abs(), depth.unsigned_abs(), new.spacing_m) {
            Ok(grid) => {
                editor.create(&PathBuf::from(new.path.trim()), grid, new.height_m);
                None
            }
            Err(err) => {
                editor.tell(err.to_string(), true);
                Some(Dialog::New(new))
            }
        };
    }
    if is_browsing {
        return Some(Dialog::browse_for_new(new));
    }
    shown.map(|()| Dialog::New(new))
}
