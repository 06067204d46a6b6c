//! The layer stack, the uppermost first.

use egui::{ComboBox, Slider, TextEdit, Ui};
use orogeny_engine::{Blend, LayerDescription};
use serde_json::{Value, json};

use crate::command::{Command, capitalised};
use crate::editor::Editor;

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    ui.heading("Layers");
    let Some(document) = &editor.document else { return };
    let current = document.layer;
    let layers = document.status.descriptions.clone();
    let mut operations: Vec<(String, Value)> = Vec::new();
    for layer in layers.iter().rev() {
        ui.horizontal(|ui| row(editor, ui, layer, current, &mut operations));
    }
    ui.horizontal(|ui| {
        let buttons = [
            ("Add", Command::AddLayer),
            ("Copy", Command::DuplicateLayer),
            ("Up", Command::RaiseLayer),
            ("Down", Command::LowerLayer),
            ("Remove", Command::RemoveLayer),
        ];
        for (icon, command) in buttons {
            let is_possible = super::menu::is_possible(editor, command);
            let button = ui.add_enabled(is_possible, egui::Button::new(icon)).on_hover_text(command.title());
            button
                .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, is_possible, command.title()));
            if button.clicked() {
                editor.run(command, &ui.ctx().clone());
            }
        }
    });
    let made_by = editor.document.as_ref().and_then(|document| document.current_layer()?.content.procedure());
    let made_by = made_by.map(|procedure| procedure.brush.to_json());
    ui.horizontal_wrapped(|ui| {
        let mut give = |ui: &mut Ui, title: &str, command: Command| {
            if ui.button(title).on_hover_text(command.title()).clicked() {
                editor.run(command, &ui.ctx().clone());
            }
        };
        match &made_by {
            None => {
                ui.label("Brush as");
                give(ui, "Procedure", Command::AddProcedure);
                give(ui, "Effect", Command::AddEffect);
            }
            Some(object) => {
                give(ui, "Tune", Command::TuneLayer);
                give(ui, "Collapse", Command::CollapseLayer);
                if ui.button("Take brush").on_hover_text("Takes up the brush that makes the layer").clicked()
                {
                    editor.tool.take_up(object);
                }
            }
        }
    });
    if let Some(layer) = layers.iter().find(|layer| layer.id == current) {
        details(ui, layer, &mut operations);
    }
    for (what, operation) in operations {
        editor.apply(&what, vec![operation]);
    }
}

fn row(
    editor: &mut Editor,
    ui: &mut Ui,
    layer: &LayerDescription,
    current: u32,
    operations: &mut Vec<(String, Value)>,
) {
    let id = layer.id;
    let mut set = |what: &str, field: &str, value: Value| {
        operations.push((what.to_owned(), json!({"op": "set_layer", "layer": id, field: value})));
    };
    let mut is_visible = layer.visible;
    if ui.checkbox(&mut is_visible, "").on_hover_text("Whether the layer counts").changed() {
        set("hide or show a layer", "visible", is_visible.into());
    }
    let lock = ui.add(egui::Button::selectable(layer.locked, "Lock").small());
    if lock.on_hover_text("Whether the layer is protected from being painted on").clicked() {
        set("lock or unlock a layer", "locked", (!layer.locked).into());
    }
    if let Some((renamed, name)) = &mut editor.panels.renaming
        && *renamed == id
    {
        let response = ui.add(TextEdit::singleline(name).desired_width(130.0));
        if response.lost_focus() {
            let name = name.trim().to_owned();
            editor.panels.renaming = None;
            if !name.is_empty()
                && name != layer.name
                && !ui.input(|input| input.key_pressed(egui::Key::Escape))
            {
                set("rename a layer", "name", name.into());
            }
        } else {
            response.request_focus();
        }
        return;
    }
    let indent = if layer.group.is_some() { "    " } else { "" };
    let stale = if layer.is_stale { " (stale)" } else { "" };
    let made_of =
        layer.brush.map_or_else(|| layer.content.to_owned(), |brush| format!("{} {brush}", layer.content));
    let label = ui
        .selectable_label(id == current, format!("{indent}{}{stale}", layer.name))
        .on_hover_text(format!("{}; double-click renames it", capitalised(&made_of)));
    if label.double_clicked() {
        editor.panels.renaming = Some((id, layer.name.clone()));
    } else if label.clicked()
        && let Some(document) = &mut editor.document
    {
        document.layer = id;
    }
}

fn details(ui: &mut Ui, layer: &LayerDescription, operations: &mut Vec<(String, Value)>) {
    let id = layer.id;
    let opacity_id = ui.scope_id().with("opacity");
    let mut percent = ui.data_mut(|data| data.get_temp::<f32>(opacity_id)).unwrap_or(layer.opacity * 100.0);
    let slider = ui.add(Slider::new(&mut percent, 0.0..=100.0).suffix(" %").text("Opacity"));
    // One operation for a drag, not one for each of its frames.
    if slider.dragged() {
        ui.data_mut(|data| data.insert_temp(opacity_id, percent));
    } else {
        ui.data_mut(|data| data.remove::<f32>(opacity_id));
        if slider.drag_stopped() || slider.changed() {
            let operation = json!({"op": "set_layer", "layer": id, "opacity": percent / 100.0});
            operations.push(("opacity of a layer".to_owned(), operation));
        }
    }
    let mut blend = layer.blend;
    ComboBox::from_label("Blend").selected_text(blend.name()).show_ui(ui, |ui| {
        for other in Blend::ALL {
            ui.selectable_value(&mut blend, other, other.name());
        }
    });
    if blend != layer.blend {
        operations.push((
            "blend of a layer".to_owned(),
            json!({"op": "set_layer", "layer": id, "blend": blend.name()}),
        ));
    }
    if layer.is_stale
        && ui.button("Work out again").on_hover_text("What is below it has changed since").clicked()
    {
        operations.push(("refresh a layer".to_owned(), json!({"op": "refresh_layer", "layer": id})));
    }
    ui.horizontal(|ui| {
        let mut mask = |ui: &mut Ui, title: &str, hint: &str, from: &str| {
            if ui.button(title).on_hover_text(hint).clicked() {
                let operation = match from {
                    "invert" => json!({"op": "set_mask", "layer": id, "invert": true}),
                    from => json!({"op": "set_mask", "layer": id, "from": from}),
                };
                operations.push(("mask of a layer".to_owned(), operation));
            }
        };
        ui.label("Mask");
        mask(ui, "All", "The layer counts everywhere", "all");
        mask(ui, "None", "The layer counts nowhere", "nothing");
        mask(ui, "Selection", "The layer counts where something is selected", "selection");
        mask(ui, "Invert", "The layer counts where it did not", "invert");
    });
}
