//! Brushes that the user wrote: in the palette, with the parameters that their files declare.

use std::path::{Path, PathBuf};

use egui::{DragValue, RichText, Slider, Ui};
use orogeny_engine::CustomParameter;
use serde_json::{Map, Value};

use super::WARNING;
use crate::command::{Command, capitalised, words};
use crate::editor::Editor;
use crate::own_brushes::LOOK_EVERY;

/// The parameter that holds those which a file declares.
const PARAMETERS: &str = "parameters";
/// Where ranges begin that are too wide for a slider.
const WIDE: f32 = 1000.0;

/// What is wished of one of them.
enum Wish {
    Take(PathBuf),
    Forget(PathBuf),
    Add,
    Reload,
}

/// Those that there are, below the brushes of the program.
pub(super) fn palette(editor: &mut Editor, ui: &mut Ui, is_found: &impl Fn(&str) -> bool) {
    editor.look_at_own_brushes();
    if editor.tool.file().is_some() {
        // A file that changes brings no event.
        ui.ctx().request_repaint_after(LOOK_EVERY);
    }
    let mut wish = None;
    let in_hand = editor.tool.file().map(PathBuf::from);
    ui.horizontal_wrapped(|ui| {
        for (path, name, brush) in editor.own_brushes.iter() {
            if !(is_found(&name) || is_found(brush.summary()) || is_found("your own")) {
                continue;
            }
            let title = RichText::new(capitalised(&name));
            let title = if brush.wrong().is_some() { title.color(WARNING) } else { title };
            let label = ui.selectable_label(in_hand.as_deref() == Some(path), title).on_hover_ui(|ui| {
                ui.label(brush.wrong().unwrap_or(brush.summary()));
                ui.label(RichText::new(path.display().to_string()).weak());
            });
            if label.clicked() {
                wish = Some(Wish::Take(path.to_owned()));
            }
            label.context_menu(|ui| {
                let is_elsewhere = editor.preferences.own_brushes.iter().any(|other| other == path);
                let forget = ui.add_enabled(is_elsewhere, egui::Button::new("Take out of the palette"));
                if forget.on_hover_text("Its file stays; those of the folder are always here").clicked() {
                    wish = Some(Wish::Forget(path.to_owned()));
                }
            });
        }
        let folder = editor.own_brushes.folder().map_or_else(String::new, |folder| {
            format!("; every .wgsl file in `{}` is here as well", folder.display())
        });
        let add = ui.small_button("Add…");
        if add.on_hover_text(format!("A WGSL file of your own{folder}")).clicked() {
            wish = Some(Wish::Add);
        }
        let reload = ui.small_button("Reload");
        if reload.on_hover_text("Reads your own brushes again; it happens by itself every second").clicked() {
            wish = Some(Wish::Reload);
        }
    });
    match wish {
        Some(Wish::Take(path)) => editor.take_own_brush(&path),
        Some(Wish::Forget(path)) => {
            editor.preferences.own_brushes.retain(|other| *other != path);
            editor.own_brushes.look_at_once();
        }
        Some(Wish::Add) => editor.run(Command::AddBrush, &ui.ctx().clone()),
        Some(Wish::Reload) => editor.own_brushes.look_at_once(),
        None => {}
    }
}

/// What the brush in the hand is called, where the user wrote it.
pub(super) fn title(editor: &Editor) -> Option<String> {
    let file = PathBuf::from(editor.tool.file()?);
    let found = editor.own_brushes.iter().find(|(path, ..)| *path == file);
    found.map(|(_, name, _)| capitalised(&name))
}

/// What the file of the brush in the hand declares, and what is wrong with it; whether it declares anything that is known.
pub(super) fn parameters(editor: &Editor, ui: &mut Ui, object: &mut Map<String, Value>) -> bool {
    let Some(file) = editor.tool.file() else { return false };
    let Some(brush) = editor.own_brushes.get(Path::new(&file)) else { return false };
    if let Some(wrong) = brush.wrong() {
        ui.label(RichText::new(wrong).monospace().color(WARNING));
        let what_paints =
            if brush.parameters().is_some() { "the last good version paints" } else { "it cannot paint" };
        ui.label(format!(
            "Mend that line and save the file: it is read again within a second; until then {what_paints}."
        ));
    }
    let Some(declared) = brush.parameters() else { return false };
    if !brush.summary().is_empty() {
        ui.label(RichText::new(brush.summary()).weak());
    }
    let mut values = object.get(PARAMETERS).and_then(Value::as_object).cloned().unwrap_or_default();
    let before = values.clone();
    for parameter in declared {
        ui.horizontal(|ui| one(ui, parameter, &mut values));
    }
    // What a file no longer declares would be refused.
    values.retain(|name, _| declared.iter().any(|parameter| parameter.name == *name));
    if values.is_empty() {
        object.remove(PARAMETERS);
    } else if values != before || !object.contains_key(PARAMETERS) {
        object.insert(PARAMETERS.to_owned(), values.into());
    }
    true
}

fn one(ui: &mut Ui, parameter: &CustomParameter, values: &mut Map<String, Value>) {
    let CustomParameter { name, default, min, max, meaning } = parameter;
    let (title, unit) = title_and_unit(name);
    let given = values.get(name).and_then(Value::as_f64);
    let mut value = given.map_or(*default, |given| given as f32).clamp(*min, *max);
    let response = if max - min > WIDE {
        let speed = (value.abs() * 0.01).max(0.01);
        ui.add(DragValue::new(&mut value).range(*min..=*max).speed(speed).suffix(unit))
    } else {
        ui.add(Slider::new(&mut value, *min..=*max).suffix(unit))
    };
    let told = format!("{} ({min} to {max}, by default {default})", capitalised(meaning));
    let label = ui.label(title).on_hover_text(&told);
    let response = response.on_hover_text(told).labelled_by(label.id);
    if response.changed() {
        values.insert(name.clone(), rounded(value).into());
    }
    if given.is_some() && ui.small_button("x").on_hover_text("Back to the default").clicked() {
        values.remove(name);
    }
}

/// The number as it is written, not with the digits that 32 bits add to it.
fn rounded(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| f64::from(value))
}

/// What a parameter is called, and its unit, which its name ends with.
fn title_and_unit(name: &str) -> (String, &'static str) {
    const UNITS: [(&str, &str); 5] =
        [("_m", " m"), ("_km", " km"), ("_degrees", "°"), ("_percent", " %"), ("_s", " s")];
    let found = UNITS.into_iter().find_map(|(ending, unit)| Some((name.strip_suffix(ending)?, unit)));
    let (stem, unit) = found.unwrap_or((name, ""));
    (capitalised(&words(stem)), unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_stand_at_the_ends_of_names() {
        assert_eq!(title_and_unit("rubble_size_m"), ("Rubble size".to_owned(), " m"));
        assert_eq!(title_and_unit("steep_degrees"), ("Steep".to_owned(), "°"));
        assert_eq!(title_and_unit("bowl"), ("Bowl".to_owned(), ""));
        assert_eq!(rounded(0.55).to_string(), "0.55");
    }
}
