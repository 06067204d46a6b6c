//! Theme, size and keys.

use egui::{ComboBox, Context, ScrollArea, Slider, TextEdit};

use crate::command::Command;
use crate::editor::Editor;
use crate::keymap::{Habit, Keymap};

/// Whether it stays open.
pub(super) fn show(editor: &mut Editor, ctx: &Context) -> bool {
    let before = editor.preferences.clone();
    let shown = super::window(ctx, "Preferences", |ui| {
        let preferences = &mut editor.preferences;
        ui.checkbox(&mut preferences.is_light, "Light");
        let mut scale =
            if preferences.interface_scale > 0.0 { preferences.interface_scale } else { ctx.zoom_factor() };
        let slider =
            ui.add(Slider::new(&mut scale, 0.5..=3.0).text("Size of everything").update_while_editing(false));
        if slider.drag_stopped() || slider.lost_focus() {
            preferences.interface_scale = scale;
        }
        ComboBox::from_label("Keys as in").selected_text(preferences.habit.title()).show_ui(ui, |ui| {
            for habit in Habit::ALL {
                ui.selectable_value(&mut preferences.habit, habit, habit.title());
            }
        });
        ui.separator();
        let keymap = preferences.keymap();
        ScrollArea::vertical().max_height(300.0).show(ui, |ui| {
            egui::Grid::new("keys").num_columns(2).striped(true).show(ui, |ui| {
                for command in Command::all() {
                    let label = ui.label(command.title());
                    let id = ui.scope_id().with(command);
                    let written = keymap.shortcut(command).map(|key| Keymap::text(&key)).unwrap_or_default();
                    let typed = ui.data_mut(|data| data.get_temp::<String>(id));
                    let mut text = typed.unwrap_or_else(|| written.clone());
                    let field =
                        ui.add(TextEdit::singleline(&mut text).desired_width(110.0)).labelled_by(label.id);
                    if field.has_focus() {
                        ui.data_mut(|data| data.insert_temp(id, text));
                    } else {
                        ui.data_mut(|data| data.remove::<String>(id));
                        let is_key = text.is_empty() || Keymap::parse(&text).is_some();
                        if field.lost_focus() && text != written && is_key {
                            preferences.keys.insert(command.id(), text);
                        }
                    }
                    ui.end_row();
                }
            });
        });
        if ui.button("All keys as they were").clicked() {
            preferences.keys.clear();
        }
    });
    if editor.preferences != before {
        editor.keymap = editor.preferences.keymap();
        editor.remember();
    }
    shown.is_some()
}
