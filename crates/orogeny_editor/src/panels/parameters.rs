//! The brush's parameters: size and strength first, then all that its type has, each with its unit, range and default.

use egui::{CollapsingHeader, ComboBox, DragValue, Slider, TextEdit, Ui};
use orogeny_engine::{BrushType, Parameter, ParameterKind};
use serde_json::{Map, Value, json};

use super::Dialog;
use crate::command::{capitalised, words};
use crate::editor::Editor;
use crate::tool::{Twist, limits};

/// Sizes and strengths have sliders of their own.
const SHOWN_BEFORE: [&str; 2] = ["radius", "strength"];

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    let brush_type = editor.tool.brush_type;
    let own = super::own_brushes::title(editor);
    ui.heading(own.unwrap_or_else(|| capitalised(&words(brush_type.name()))));
    ui.label(egui::RichText::new(capitalised(brush_type.summary())).weak());
    let brush = editor.tool.brush_json(Twist::None);
    // Thumbnails are made by native code, of which a brush that the user wrote has none.
    let is_native = brush_type != BrushType::Custom;
    if is_native && let Some(picture) = editor.thumbnails.of(ui.ctx(), &brush) {
        ui.image((picture.id(), picture.size_vec2())).on_hover_text("One stroke of the brush as it is set");
    }
    size_and_strength(editor, ui);
    ui.horizontal(|ui| {
        ui.checkbox(&mut editor.tool.is_on_mask, "On mask")
            .on_hover_text("Paints on the layer's mask: where the layer counts");
        ui.checkbox(&mut editor.tool.is_on_selection, "On selection")
            .on_hover_text("Paints on the selection, which gates look at");
        if ui.button("Fill").on_hover_text("Applies the brush to all of the layer at once").clicked() {
            editor.fill();
        }
    });
    let mut object = editor.tool.object();
    let before = object.clone();
    // What the user's file declares is better than an object of numbers under any names.
    let is_declared = super::own_brushes::parameters(editor, ui, &mut object);
    let parameters: Vec<_> = Parameter::of(brush_type)
        .filter(|parameter| !SHOWN_BEFORE.contains(&parameter.name))
        .filter(|parameter| !(is_declared && parameter.kind == ParameterKind::Values))
        .collect();
    let mut browsed = None;
    of_object(ui, &parameters, &mut object, &mut browsed);
    keep_in_step(&mut object, &before);
    if object != before {
        for name in before.keys().chain(object.keys()) {
            editor.tool.set(name, object.get(name).cloned());
        }
    }
    if let Some((mut names, given)) = browsed {
        names.reverse();
        editor.panels.dialog = Some(Dialog::browse_for_parameter(editor, names, &given));
    }
}

fn size_and_strength(editor: &mut Editor, ui: &mut Ui) {
    let tool = &mut editor.tool;
    let longest_m = editor.document.as_ref().map_or(1.0e4, |document| {
        let [width_m, depth_m] = document.size_m();
        width_m.max(depth_m)
    });
    let spacing_m = editor.document.as_ref().map_or(1.0, |document| document.status.grid.spacing_m());
    let mut radius_m = tool.radius_m();
    let sizes = (0.5 * spacing_m).min(radius_m)..=(longest_m / 2.0).max(radius_m);
    let size = Slider::new(&mut radius_m, sizes).logarithmic(true).suffix(" m").text("Radius");
    if ui.add(size).on_hover_text("Half of the brush's width; keys [ and ]").changed() {
        tool.set_radius_m(radius_m);
    }
    if !Parameter::of(tool.brush_type).any(|parameter| parameter.name == "strength") {
        return;
    }
    let mut percent = tool.share() * 100.0;
    let most = percent.max(100.0);
    let strength = Slider::new(&mut percent, 0.0..=most).suffix(" %").text("Strength");
    let hint = if tool.is_in_metres() {
        format!("{:.3} m for each pass; keys - and =", tool.strength())
    } else {
        "The share of the way that one pass goes; keys - and =".to_owned()
    };
    if ui.add(strength).on_hover_text(hint).changed() {
        let (_, most) = limits(tool.brush_type, "strength");
        tool.set_share((percent / 100.0).min(most.max(1.0)));
    }
}

/// A choice that needs a curve, and the curve, which is refused without the choice.
const CURVES: [(&str, &str); 2] = [("profile", "profile_curve"), ("mapping", "map_curve")];

/// Gives a choice the curve that it needs, takes away the curve of what is chosen no more, and chooses what a curve was drawn for.
fn keep_in_step(object: &mut Map<String, Value>, before: &Map<String, Value>) {
    for (choice, curve) in CURVES {
        let is_chosen = object.get(choice).is_some_and(|word| word == "curve");
        let has_curve = object.contains_key(curve);
        let was_chosen = object.get(choice) != before.get(choice);
        match (is_chosen, has_curve) {
            (true, false) if was_chosen => {
                _ = object.insert(curve.to_owned(), json!([[0.0, 0.0], [1.0, 1.0]]))
            }
            (true, false) => _ = object.remove(choice),
            (false, true) if was_chosen => _ = object.remove(curve),
            (false, true) => _ = object.insert(choice.to_owned(), "curve".into()),
            (true, true) | (false, false) => {}
        }
    }
}

/// A parameter that a file is to be chosen for, by the names that lead to it, its own first; with what it is now.
type Browsed = Option<(Vec<&'static str>, String)>;

/// The parameters of an object, or of one within it.
fn of_object(ui: &mut Ui, parameters: &[&Parameter], object: &mut Map<String, Value>, browsed: &mut Browsed) {
    for parameter in parameters {
        if let ParameterKind::Object { parameters } = parameter.kind {
            let is_given = object.contains_key(parameter.name);
            let title = capitalised(&words(parameter.name));
            let title = if is_given { format!("{title} *") } else { title };
            let header = CollapsingHeader::new(title).id_salt(parameter.name).show(ui, |ui| {
                let mut inner =
                    object.get(parameter.name).and_then(Value::as_object).cloned().unwrap_or_default();
                let before = inner.clone();
                let parameters: Vec<_> = parameters.iter().collect();
                let mut browsed_inside = None;
                of_object(ui, &parameters, &mut inner, &mut browsed_inside);
                if let Some((mut names, given)) = browsed_inside {
                    names.push(parameter.name);
                    *browsed = Some((names, given));
                }
                if inner.is_empty() {
                    object.remove(parameter.name);
                } else if inner != before {
                    object.insert(parameter.name.to_owned(), inner.into());
                }
            });
            header.header_response.on_hover_text(capitalised(parameter.meaning));
            continue;
        }
        if let ParameterKind::Curve { x, y } = parameter.kind {
            let given = object.get(parameter.name).cloned();
            match super::curve::show(ui, parameter, (x, y), given.as_ref()) {
                Some(Some(value)) => _ = object.insert(parameter.name.to_owned(), value),
                Some(None) => _ = object.remove(parameter.name),
                None => {}
            }
            continue;
        }
        ui.horizontal(|ui| {
            let given = object.get(parameter.name).cloned();
            let changed = one(ui, parameter, given.as_ref());
            if let Some(value) = changed {
                object.insert(parameter.name.to_owned(), value);
            }
            if is_file(parameter) && ui.small_button("Browse…").clicked() {
                let given = given.as_ref().and_then(Value::as_str).unwrap_or_default();
                *browsed = Some((vec![parameter.name], given.to_owned()));
            }
            if given.is_some() && ui.small_button("x").on_hover_text("Back to the default").clicked() {
                object.remove(parameter.name);
            }
        });
    }
}

/// Whether it names a file.
fn is_file(parameter: &Parameter) -> bool {
    parameter.kind == ParameterKind::Text && parameter.name == "file"
}

/// One parameter; its new value where it was changed.
fn one(ui: &mut Ui, parameter: &Parameter, given: Option<&Value>) -> Option<Value> {
    let title = capitalised(&words(parameter.name));
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    let number = given.and_then(Value::as_f64);
    let (response, value) = match parameter.kind {
        ParameterKind::Number { min, max, default } => {
            let mut value = number.or(default).unwrap_or(min.clamp(0.0, max));
            let is_wide = max - min > 1000.0;
            let response = if is_wide {
                let speed = (value.abs() * 0.01).max(0.01);
                ui.add(DragValue::new(&mut value).range(min..=max).speed(speed).suffix(unit))
            } else {
                ui.add(Slider::new(&mut value, min..=max).suffix(unit))
            };
            (response, Value::from(value))
        }
        ParameterKind::Integer { min, max, default } => {
            let mut value = number.map_or(default, |number| number as u32);
            (ui.add(DragValue::new(&mut value).range(min..=max).suffix(unit)), value.into())
        }
        ParameterKind::Flag { default } => {
            let mut value = given.and_then(Value::as_bool).unwrap_or(default);
            (ui.checkbox(&mut value, ""), value.into())
        }
        ParameterKind::Choice { words } => {
            let mut value =
                given.and_then(Value::as_str).or(words.first().copied()).unwrap_or_default().to_owned();
            let before = value.clone();
            let mut response = ComboBox::from_id_salt(parameter.name)
                .selected_text(&value)
                .show_ui(ui, |ui| {
                    for word in words {
                        ui.selectable_value(&mut value, (*word).to_owned(), *word);
                    }
                })
                .response;
            if value != before {
                response.mark_changed();
            }
            (response, value.into())
        }
        ParameterKind::Numbers { min, max, default } => {
            let given = given.and_then(Value::as_array);
            let mut values: Vec<f64> = default
                .iter()
                .enumerate()
                .map(|(index, default)| {
                    given.and_then(|given| given.get(index)).and_then(Value::as_f64).unwrap_or(*default)
                })
                .collect();
            let add = |value: &mut f64| ui.add(DragValue::new(value).range(min..=max).speed(0.1));
            let response = values.iter_mut().map(add).reduce(|all, one| all | one)?;
            (response, values.into())
        }
        // What has a form of its own is typed as recipes have it.
        _ => return text(ui, parameter, &title, given),
    };
    let response = response.on_hover_text(capitalised(parameter.meaning));
    let label = ui.label(title).on_hover_text(capitalised(parameter.meaning));
    let response = response.labelled_by(label.id);
    response.changed().then_some(value)
}

/// A parameter that is typed: text as it is, all else as JSON.
fn text(ui: &mut Ui, parameter: &Parameter, title: &str, given: Option<&Value>) -> Option<Value> {
    let is_text = matches!(parameter.kind, ParameterKind::Text | ParameterKind::Layer);
    let id = ui.scope_id().with(parameter.name);
    let written = match given {
        Some(Value::String(text)) if is_text => text.clone(),
        Some(value) => value.to_string(),
        None => String::new(),
    };
    // What is half typed is no value yet.
    let mut typed = ui.data_mut(|data| data.get_temp::<String>(id)).unwrap_or_else(|| written.clone());
    let response = ui.add(TextEdit::singleline(&mut typed).desired_width(110.0).hint_text("default"));
    let response = response.on_hover_text(capitalised(parameter.meaning));
    let label = ui.label(title).on_hover_text(capitalised(parameter.meaning));
    let response = response.labelled_by(label.id);
    if !response.lost_focus() {
        let half = response.has_focus().then_some(typed);
        ui.data_mut(|data| match half {
            Some(typed) => _ = data.insert_temp(id, typed),
            None => data.remove::<String>(id),
        });
        return None;
    }
    ui.data_mut(|data| data.remove::<String>(id));
    if typed == written || typed.is_empty() {
        return None;
    }
    let parsed = serde_json::from_str(&typed);
    if is_text { Some(parsed.ok().filter(Value::is_number).unwrap_or(typed.into())) } else { parsed.ok() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_and_the_choice_of_it_come_and_go_together() {
        let object = |value: Value| value.as_object().cloned().unwrap();
        let curve = json!([[0, 1], [1, 0]]);
        let (none, both) = (Map::new(), object(json!({"profile": "curve", "profile_curve": curve})));
        // (before, changed to, what is kept)
        let line = json!([[0.0, 0.0], [1.0, 1.0]]);
        for (before, mut changed, kept) in [
            (&none, object(json!({"profile": "curve"})), json!({"profile": "curve", "profile_curve": line})),
            (&none, object(json!({"profile_curve": curve})), Value::from(both.clone())),
            (&both, object(json!({"profile": "tip", "profile_curve": curve})), json!({"profile": "tip"})),
            (&both, object(json!({"profile_curve": curve})), json!({})),
            (&both, object(json!({"profile": "curve"})), json!({})),
            (&both, both.clone(), Value::from(both.clone())),
        ] {
            keep_in_step(&mut changed, before);
            assert_eq!(Value::from(changed), kept);
        }
    }
}
