//! The palette: brushes by what they are for, presets, and a search over both.

use egui::{CollapsingHeader, TextEdit, Ui};
use orogeny_engine::{BrushType, Preset};

use crate::command::{Command, capitalised, words};
use crate::editor::Editor;

/// Brushes by what they are for.
const GROUPS: [(&str, &[BrushType]); 7] = [
    (
        "Sculpt",
        &[
            BrushType::Raise,
            BrushType::Lower,
            BrushType::Ledge,
            BrushType::Level,
            BrushType::SetHeight,
            BrushType::Ramp,
            BrushType::Grab,
            BrushType::Smear,
        ],
    ),
    ("Noise", &[BrushType::Roughen, BrushType::Noise]),
    ("Filter", &[BrushType::Smooth, BrushType::Sharpen, BrushType::Terrace, BrushType::RangeMap]),
    (
        "Erosion",
        &[BrushType::ErodeThermal, BrushType::ErodeFluvial, BrushType::ErodeDroplets, BrushType::FillPits],
    ),
    ("Copy", &[BrushType::Clone, BrushType::Stamp]),
    ("Masks", &[BrushType::PaintMask, BrushType::EraseMask, BrushType::FlowMask, BrushType::RainMask]),
    ("Your own", &[BrushType::Custom]),
];

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    ui.heading("Brushes");
    ui.horizontal(|ui| {
        let label = ui.label("Search");
        let search = TextEdit::singleline(&mut editor.panels.brush_search).hint_text("Brushes and presets");
        ui.add(search.desired_width(f32::INFINITY)).labelled_by(label.id);
    });
    let search = editor.panels.brush_search.to_lowercase();
    let is_found = |text: &str| search.is_empty() || text.to_lowercase().contains(&search);
    for (group, brushes) in GROUPS {
        let found: Vec<_> = brushes
            .iter()
            .filter(|brush| is_found(&words(brush.name())) || is_found(brush.summary()) || is_found(group))
            .collect();
        if found.is_empty() {
            continue;
        }
        ui.label(egui::RichText::new(group).weak());
        ui.horizontal_wrapped(|ui| {
            for brush_type in found {
                let shortcut = editor.keymap.shortcut(Command::Brush(*brush_type));
                let key =
                    shortcut.map(|key| format!(" ({})", ui.ctx().format_shortcut(&key))).unwrap_or_default();
                let is_chosen = editor.tool.brush_type == *brush_type;
                let button = ui
                    .selectable_label(is_chosen, capitalised(&words(brush_type.name())))
                    .on_hover_text(format!("{}{key}", capitalised(brush_type.summary())));
                if button.clicked() {
                    editor.take_brush(*brush_type);
                }
            }
        });
    }
    presets(editor, ui, is_found);
}

fn presets(editor: &mut Editor, ui: &mut Ui, is_found: impl Fn(&str) -> bool) {
    let mut chosen = None;
    let is_searched = !editor.panels.brush_search.is_empty();
    CollapsingHeader::new("Presets").open(is_searched.then_some(true)).show(ui, |ui| {
        for known in editor.options.presets.iter() {
            let Preset { name, description, tags, brush, .. } = &known.preset;
            if !(is_found(name) || is_found(description) || tags.iter().any(|tag| is_found(tag))) {
                continue;
            }
            if ui.selectable_label(false, name).on_hover_text(description).clicked() {
                chosen = Some(brush.clone());
            }
        }
        ui.horizontal(|ui| {
            let name = TextEdit::singleline(&mut editor.panels.preset_name).hint_text("Name");
            ui.add(name.desired_width(130.0));
            if ui
                .button("Save brush")
                .on_hover_text("Keeps the brush with its parameters as a preset")
                .clicked()
            {
                save(editor);
            }
        });
    });
    let Some(object) = chosen else { return };
    match editor.options.presets.brush_object(&object) {
        Ok(object) => editor.tool.take_up(&object),
        Err(err) => editor.tell(err.to_string(), true),
    }
}

fn save(editor: &mut Editor) {
    let brush = editor.tool.brush_json(crate::tool::Twist::None);
    let saved = Preset::new(editor.panels.preset_name.trim(), brush)
        .and_then(|preset| editor.options.presets.save(&preset, true));
    match saved {
        Ok(path) => {
            editor.panels.preset_name.clear();
            editor.tell(format!("the brush was kept in `{}`", path.display()), false);
        }
        Err(err) => editor.tell(err.to_string(), true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_brush_is_in_one_group() {
        for brush_type in BrushType::ALL {
            let num = GROUPS.iter().filter(|(_, brushes)| brushes.contains(&brush_type)).count();
            assert_eq!(num, 1, "{brush_type:?}");
        }
    }
}
