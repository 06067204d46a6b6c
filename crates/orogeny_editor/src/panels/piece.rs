//! A floating piece: how it lies and how it goes over into the ground, in numbers.

use egui::{ComboBox, DragValue, Ui};

use crate::command::Command;
use crate::editor::Editor;
use crate::piece::BLENDS;

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    let Some(piece) = &mut editor.viewport.piece else { return };
    ui.heading("Floating piece");
    ui.label(
        egui::RichText::new(
            "Drag it; its corners scale, the handle beyond its edge turns, the one above it lifts",
        )
        .weak(),
    );
    egui::Grid::new("piece").num_columns(2).show(ui, |ui| {
        let number = |ui: &mut Ui, title: &str, value: DragValue<'_>| {
            let label = ui.label(title);
            ui.add(value).labelled_by(label.id);
            ui.end_row();
        };
        let [x_m, z_m] = &mut piece.to_m;
        number(ui, "East", DragValue::new(x_m).suffix(" m"));
        number(ui, "South", DragValue::new(z_m).suffix(" m"));
        number(ui, "Turned", DragValue::new(&mut piece.rotation_degrees).suffix("°"));
        number(ui, "Scale", DragValue::new(&mut piece.scale).range(0.05..=20.0).speed(0.01));
        number(ui, "Lifted", DragValue::new(&mut piece.offset_m).suffix(" m"));
    });
    ui.checkbox(&mut piece.is_mirrored, "Mirrored").on_hover_text("Left and right change places");
    let title = BLENDS.get(piece.blend).map(|(_, title)| *title).unwrap_or_default();
    let label = ui.label("How it goes over into the ground");
    let blend = ComboBox::from_id_salt("blend of a piece").selected_text(title).show_ui(ui, |ui| {
        for (index, (_, title)) in BLENDS.iter().enumerate() {
            ui.selectable_value(&mut piece.blend, index, *title);
        }
    });
    blend.response.labelled_by(label.id);
    ui.horizontal(|ui| {
        if ui.button("Put down").on_hover_text("Blends it into the ground (Enter)").clicked() {
            editor.run(Command::PutDown, &ui.ctx().clone());
        }
        if ui.button("Drop").on_hover_text("Takes it away again (Esc)").clicked() {
            editor.viewport.piece = None;
        }
    });
    ui.separator();
}
