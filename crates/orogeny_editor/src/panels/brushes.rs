//! The palette: brushes by what they are for, presets, and a search over both.

use egui::{CollapsingHeader, Color32, Rect, Sense, TextEdit, TextureHandle, Ui, Vec2, pos2, vec2};
use orogeny_engine::presets::PresetOrigin;
use orogeny_engine::{BrushType, Preset};
use serde_json::{Map, Value};

use super::Dialog;
use crate::command::{Command, capitalised, words};
use crate::editor::Editor;
use crate::thumbnails::Thumbnails;

/// How large a preset's picture is in the list, in points.
const THUMBNAIL: Vec2 = vec2(40.0, 30.0);

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
                // One that the user wrote is chosen by its own name, below.
                let is_own = *brush_type == BrushType::Custom && editor.tool.file().is_some();
                let is_chosen = editor.tool.brush_type == *brush_type && !is_own;
                let button = ui
                    .selectable_label(is_chosen, capitalised(&words(brush_type.name())))
                    .on_hover_text(format!("{}{key}", capitalised(brush_type.summary())));
                if button.clicked() {
                    editor.take_brush(*brush_type);
                }
            }
        });
    }
    super::own_brushes::palette(editor, ui, &is_found);
    presets(editor, ui, is_found);
}

/// What is wished of a preset.
enum PresetWish {
    Take(Map<String, Value>),
    Rename(String),
    Remove(String),
    CopyText(String),
    Write(String),
    Add,
}

fn presets(editor: &mut Editor, ui: &mut Ui, is_found: impl Fn(&str) -> bool) {
    let mut wish = None;
    let is_searched = !editor.panels.brush_search.is_empty();
    CollapsingHeader::new("Presets").open(is_searched.then_some(true)).show(ui, |ui| {
        let has_name = !editor.panels.preset_name.trim().is_empty();
        for known in editor.options.presets.iter() {
            let Preset { name, description, tags, brush, .. } = &known.preset;
            if !(is_found(name) || is_found(description) || tags.iter().any(|tag| is_found(tag))) {
                continue;
            }
            let is_own = matches!(known.origin, PresetOrigin::User { .. });
            let label = ui.horizontal(|ui| {
                let picture = thumbnail(&mut editor.thumbnails, ui, brush);
                ui.selectable_label(false, name).on_hover_ui(|ui| {
                    ui.label(description);
                    if let Some(picture) = picture {
                        ui.image((picture.id(), picture.size_vec2()));
                    }
                    ui.label(egui::RichText::new("The right button has more").weak());
                })
            });
            let label = label.inner;
            if label.clicked() {
                wish = Some(PresetWish::Take(brush.clone()));
            }
            label.context_menu(|ui| {
                let rename = ui.add_enabled(is_own && has_name, egui::Button::new("Rename"));
                if rename.on_hover_text("To the name that is typed below the presets").clicked() {
                    wish = Some(PresetWish::Rename(name.clone()));
                }
                let remove = ui.add_enabled(is_own, egui::Button::new("Delete"));
                if remove.on_hover_text("Its file; those that come with the program stay").clicked() {
                    wish = Some(PresetWish::Remove(name.clone()));
                }
                let copy = ui.button("Copy as text");
                if copy
                    .on_hover_text("To be sent to someone: as a file dropped on the window it is kept there")
                    .clicked()
                {
                    wish = Some(PresetWish::CopyText(name.clone()));
                }
                if ui.button("Write to a file…").on_hover_text("With its picture").clicked() {
                    wish = Some(PresetWish::Write(name.clone()));
                }
            });
        }
        ui.horizontal(|ui| {
            let name = TextEdit::singleline(&mut editor.panels.preset_name).hint_text("Name");
            let name = ui.add(name.desired_width(130.0));
            name.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Name of the preset"));
            if ui
                .button("Save brush")
                .on_hover_text("Keeps the brush with its parameters as a preset")
                .clicked()
            {
                save(editor);
            }
        });
        if ui.button("From a file…").on_hover_text("Keeps a preset that someone gave you").clicked() {
            wish = Some(PresetWish::Add);
        }
    });
    let Some(wish) = wish else { return };
    if let Err(err) = grant(editor, ui, wish) {
        editor.tell(err.to_string(), true);
    }
}

/// Draws a preset's picture, small; gives it where it is there. Those that are scrolled out of sight are not drawn.
fn thumbnail(thumbnails: &mut Thumbnails, ui: &mut Ui, brush: &Map<String, Value>) -> Option<TextureHandle> {
    let (rect, _) = ui.allocate_exact_size(THUMBNAIL, Sense::hover());
    if !ui.is_rect_visible(rect) {
        return None;
    }
    let picture = thumbnails.of_list(ui.ctx(), brush)?;
    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(picture.id(), rect, whole, Color32::WHITE);
    Some(picture)
}

fn grant(editor: &mut Editor, ui: &Ui, wish: PresetWish) -> orogeny_engine::Result<()> {
    let presets = &mut editor.options.presets;
    match wish {
        PresetWish::Take(brush) => {
            let object = presets.brush_object(&brush)?;
            editor.tool.take_up(&object);
        }
        PresetWish::Rename(name) => {
            let mut preset = presets.get(&name)?.preset.clone();
            preset.name = editor.panels.preset_name.trim().to_owned();
            // The new one is on disk before the old one goes.
            presets.save(&preset, false)?;
            presets.remove(&name)?;
            editor.panels.preset_name.clear();
        }
        PresetWish::Remove(name) => {
            let file = presets.remove(&name)?;
            editor.tell(format!("`{}` was deleted", file.display()), false);
        }
        PresetWish::CopyText(name) => {
            ui.ctx().copy_text(presets.get(&name)?.preset.to_json_text()?);
            editor.tell(format!("the preset {name} was copied as text"), false);
        }
        PresetWish::Write(name) => editor.panels.dialog = Some(Dialog::write_preset(editor, &name)),
        PresetWish::Add => editor.run(Command::AddPreset, &ui.ctx().clone()),
    }
    Ok(())
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
