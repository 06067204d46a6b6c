//! How heights are written: for which program, in which samples, how many, over which range; and what comes of it.

use std::path::Path;

use egui::{ComboBox, DragValue, ProgressBar, RichText, TextEdit, Ui};
use orogeny_engine::presets::{ExportPreset, ExportProgram, ExportRange, ExportSizes, PlannedExport};
use orogeny_engine::{
    ByteOrder, Direction, ExportOptions, ExportRequest, ExportSize, Fit, Format, SampleType, TerrainGrid,
};

use super::{WARNING, compass};
use crate::editor::Editor;

/// Types of samples that a file may hold.
const SAMPLES: [(Option<SampleType>, &str); 5] = [
    (None, "as the format has it"),
    (Some(SampleType::U8), "8 bits, whole"),
    (Some(SampleType::U16), "16 bits, whole"),
    (Some(SampleType::I16), "16 bits, signed"),
    (Some(SampleType::F32), "32 bits, floating"),
];

const FITS: [(Fit, &str, &str); 2] = [
    (Fit::Resample, "resampled", "Corners stay corners, and the spacing differs"),
    (Fit::Middle, "the middle", "Samples stay as they are; where there are too few the edge goes on"),
];

/// What is chosen so far.
#[derive(Debug, Clone)]
pub(super) struct Choice {
    /// All of it but the size, as a preset has it; its name is that of the preset which it was last.
    preset: ExportPreset,
    /// The size of the file; `None`: as many samples as there are.
    size: Option<[u32; 2]>,
    /// A range of one's own, while another is chosen too.
    range_m: [f64; 2],
    /// The name that it is to be kept under.
    name: String,
}

/// What is wished of presets.
enum Wish {
    Take(ExportPreset),
    Save,
    Remove,
}

impl Choice {
    pub(super) fn new(range_m: [f64; 2]) -> Self {
        let preset = ExportPreset::plain("", "png");
        Self { preset, size: None, range_m, name: String::new() }
    }

    /// What is asked of the engine.
    pub(super) fn request(&self, path: &str, terrain_m: [f32; 2]) -> ExportRequest {
        let format = Format::from_path(Path::new(path.trim()), Direction::Export).ok();
        let has_order = matches!(format, Some(Format::Raw | Format::R16 | Format::R32));
        let options = ExportOptions {
            sample: self.preset.sample,
            byte_order: self.preset.byte_order.filter(|_| has_order),
            range_m: self.preset.range_m(terrain_m.map(f64::from)).map(Into::into),
            ..ExportOptions::default()
        };
        let size = self.size.map(|[width, depth]| ExportSize { width, depth, fit: self.preset.fit });
        let is_south_first = self.preset.is_south_first;
        ExportRequest { options, size, is_south_first, ..ExportRequest::new(path.trim()) }
    }

    /// What stands in the line at the bottom when it is written.
    pub(super) fn told(&self, name: &str, planned: &PlannedExport) -> Option<String> {
        let [low_m, high_m] = planned.range_m?;
        Some(format!("{name}: sample 0 is {low_m:.3} m, the last is {high_m:.3} m"))
    }

    fn take(&mut self, preset: ExportPreset, grid: TerrainGrid, path: &mut String) {
        self.size = preset.sizes.nearest_size([grid.width(), grid.depth()]);
        if let ExportRange::Own(range_m) = preset.range {
            self.range_m = range_m;
        }
        *path = Path::new(path.trim()).with_extension(&preset.ending).display().to_string();
        self.preset = preset;
    }
}

/// Everything that is chosen but the file.
pub(super) fn show(editor: &mut Editor, ui: &mut Ui, choice: &mut Choice, path: &mut String) {
    let Some(document) = &editor.document else { return };
    let (grid, terrain_m) = (document.status.grid, document.pane.view.range_m());
    if let Some(ending) = Path::new(path.trim()).extension().and_then(|ending| ending.to_str()) {
        choice.preset.ending = ending.to_lowercase();
    }
    let wish = presets(editor, ui, choice);
    samples(ui, choice, path);
    sizes(ui, choice, grid);
    let planned = choice.request(path, terrain_m).planned([grid.width(), grid.depth()], grid.spacing_m());
    ui.separator();
    meter(ui, choice, &planned, terrain_m);
    summary(ui, choice, &planned, path);
    match wish {
        Some(Wish::Take(preset)) => choice.take(preset, grid, path),
        Some(Wish::Save) => {
            let preset = ExportPreset { name: choice.name.trim().to_owned(), ..choice.preset.clone() };
            let sides = choice.size.map(|[width, _]| vec![width]);
            // A preset for one size stays one; else any is right.
            let sizes = if choice.preset.sizes == ExportSizes::Any {
                sides.map_or(ExportSizes::Any, ExportSizes::Square)
            } else {
                preset.sizes.clone()
            };
            let preset = ExportPreset { sizes, ..preset };
            match editor.export_presets.save(&preset) {
                Ok(file) => {
                    (choice.preset.name, choice.name) = (preset.name, String::new());
                    editor.tell(format!("the export was kept in `{}`", file.display()), false);
                }
                Err(err) => editor.tell(err.to_string(), true),
            }
        }
        Some(Wish::Remove) => match editor.export_presets.remove(&choice.preset.name) {
            Ok(file) => editor.tell(format!("`{}` was deleted", file.display()), false),
            Err(err) => editor.tell(err.to_string(), true),
        },
        None => {}
    }
}

fn presets(editor: &Editor, ui: &mut Ui, choice: &mut Choice) -> Option<Wish> {
    let mut wish = None;
    let name = &choice.preset.name;
    let selected = if name.is_empty() { "choose one" } else { name.as_str() };
    ComboBox::from_label("Preset").selected_text(selected).width(180.0).show_ui(ui, |ui| {
        for preset in editor.export_presets.iter() {
            if ui.selectable_label(preset.name == *name, &preset.name).clicked() {
                wish = Some(Wish::Take(preset.clone()));
            }
        }
    });
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(&mut choice.name).hint_text("Name").desired_width(120.0);
        let field = ui.add(field);
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Name of the export"));
        let save = ui.add_enabled(!choice.name.trim().is_empty(), egui::Button::new("Save export"));
        if save.on_hover_text("Keeps what is chosen here as a preset of your own, in a file").clicked() {
            wish = Some(Wish::Save);
        }
        let remove =
            ui.add_enabled(editor.export_presets.is_own(&choice.preset.name), egui::Button::new("Delete"));
        if remove.on_hover_text("Deletes the preset that is chosen, where it is your own").clicked() {
            wish = Some(Wish::Remove);
        }
    });
    for err in editor.export_presets.unusable() {
        ui.colored_label(WARNING, err.to_string());
    }
    wish
}

fn samples(ui: &mut Ui, choice: &mut Choice, path: &str) {
    let preset = &mut choice.preset;
    ComboBox::from_label("For").selected_text(preset.program.title()).show_ui(ui, |ui| {
        for program in ExportProgram::ALL {
            ui.selectable_value(&mut preset.program, program, program.title());
        }
    });
    let name = SAMPLES.iter().find(|(sample, _)| *sample == preset.sample).map(|(_, name)| *name);
    ComboBox::from_label("Samples").selected_text(name.unwrap_or_default()).show_ui(ui, |ui| {
        for (sample, name) in SAMPLES {
            ui.selectable_value(&mut preset.sample, sample, name);
        }
    });
    let format = Format::from_path(Path::new(path.trim()), Direction::Export);
    if matches!(format, Ok(Format::Raw | Format::R16 | Format::R32)) {
        let mut is_big = preset.byte_order == Some(ByteOrder::Big);
        let order = ui.checkbox(&mut is_big, "Big endian");
        if order.on_hover_text("The most significant byte first; programs on PCs want it off").changed() {
            preset.byte_order = is_big.then_some(ByteOrder::Big);
        }
    }
    ui.checkbox(&mut preset.is_south_first, "Southern row first")
        .on_hover_text("For programs whose depth grows to the north, as Unity");
    if !preset.is_scaled() {
        return;
    }
    let own = ExportRange::Own(choice.range_m);
    let ranges = [
        (ExportRange::Terrain, "from the lowest to the highest"),
        (own, "a range of your own"),
        (ExportRange::Metres, "whole metres"),
    ];
    let is_same = |one: ExportRange, other| std::mem::discriminant(&one) == std::mem::discriminant(&other);
    let title = ranges.iter().find(|(range, _)| is_same(*range, preset.range)).map(|(_, title)| *title);
    ComboBox::from_label("Heights")
        .selected_text(title.unwrap_or_default())
        .show_ui(ui, |ui| {
            for (range, title) in ranges {
                if ui.selectable_label(is_same(range, preset.range), title).clicked() {
                    preset.range = range;
                }
            }
        })
        .response
        .on_hover_text("What whole samples stand for: the other program has to be told the same");
    if let ExportRange::Own(range_m) = &mut preset.range {
        ui.horizontal(|ui| {
            for (end, name) in range_m.iter_mut().zip(["from", "to"]) {
                let label = ui.label(name);
                ui.add(DragValue::new(end).suffix(" m")).labelled_by(label.id);
            }
        });
        choice.range_m = *range_m;
    }
}

fn sizes(ui: &mut Ui, choice: &mut Choice, grid: TerrainGrid) {
    let as_it_is = format!("as it is, {} x {}", grid.width(), grid.depth());
    let of = |[width, depth]: [u32; 2]| format!("{width} x {depth}");
    let selected = choice.size.map_or_else(|| as_it_is.clone(), of);
    ComboBox::from_label("Size").selected_text(selected).show_ui(ui, |ui| {
        ui.selectable_value(&mut choice.size, None, &as_it_is);
        if let ExportSizes::Square(sides) = &choice.preset.sizes {
            for side in sides {
                ui.selectable_value(&mut choice.size, Some([*side; 2]), of([*side; 2]));
            }
        } else if ui.selectable_label(choice.size.is_some(), "a size of your own").clicked() {
            choice.size = choice.size.or(Some([grid.width(), grid.depth()]));
        }
    });
    let Some(size) = &mut choice.size else { return };
    ui.horizontal(|ui| {
        if choice.preset.sizes == ExportSizes::Any {
            for (side, name) in size.iter_mut().zip(["wide", "deep"]) {
                let number = DragValue::new(side).range(1..=orogeny_engine::MAX_SAMPLES_PER_SIDE);
                let label = ui.label(name);
                ui.add(number).labelled_by(label.id);
            }
        }
        for (fit, title, told) in FITS {
            ui.radio_value(&mut choice.preset.fit, fit, title).on_hover_text(told);
        }
    });
}

/// How much of the steps a file uses, how high a step is, and what does not fit.
fn meter(ui: &mut Ui, choice: &Choice, planned: &PlannedExport, terrain_m: [f32; 2]) {
    if !choice.preset.is_scaled() {
        ui.label("Samples are metres");
        return;
    }
    let (bits, last) = if choice.preset.sample == Some(SampleType::U8) { (8, 255.0) } else { (16, 65_535.0) };
    let [from_m, to_m] = planned.range_m.unwrap_or([0.0, last]);
    let span_m = to_m - from_m;
    if span_m <= 0.0 {
        ui.colored_label(WARNING, "The range is empty: its end has to lie above its start");
        return;
    }
    let [low_m, high_m] = terrain_m.map(f64::from);
    let share = ((high_m.min(to_m) - low_m.max(from_m)) / span_m).clamp(0.0, 1.0) as f32;
    ui.add(ProgressBar::new(share).text(format!("{:.0} % of {bits} bits used", 100.0 * share)));
    ui.label(format!("Heights go from {low_m:.2} to {high_m:.2} m; a step is {:.4} m", span_m / last));
    let beyond_m = [from_m - low_m, high_m - to_m].into_iter().fold(0.0, f64::max);
    if beyond_m > 0.0 {
        let text = format!(
            "Heights lie up to {beyond_m:.2} m beyond the range: it would be refused. Widen the range"
        );
        ui.colored_label(WARNING, text);
    }
}

/// What it is going to be, and what is to be typed elsewhere.
fn summary(ui: &mut Ui, choice: &Choice, planned: &PlannedExport, path: &str) {
    match Format::from_path(Path::new(path.trim()), Direction::Export) {
        Ok(format) => {
            let PlannedExport { size: [width, depth], spacing_m: [x_m, z_m], num_bytes, .. } = planned;
            let apart = if (x_m - z_m).abs() < 1.0e-9 {
                format!("{x_m:.4} m")
            } else {
                format!("{x_m:.4} m along x and {z_m:.4} m along z")
            };
            let megabytes = *num_bytes as f64 / 1.0e6;
            ui.label(format!(
                "{format}, {width} x {depth} samples, {apart} apart, {megabytes:.1} MB before packing"
            ));
        }
        Err(err) => _ = ui.colored_label(WARNING, err.to_string()),
    }
    let advice = choice.preset.program.advice(planned);
    ui.label(RichText::new(format!("In {}:", choice.preset.program.title())).strong());
    for line in &advice {
        ui.monospace(line);
    }
    if ui.small_button("Copy these lines").clicked() {
        ui.ctx().copy_text(advice.join("\n"));
    }
    orientation(ui, choice.preset.is_south_first);
}

/// Which corner a file begins in, and how it goes on.
fn orientation(ui: &mut Ui, is_south_first: bool) {
    ui.horizontal(|ui| {
        let (rect, response) = ui.allocate_exact_size(egui::vec2(84.0, 84.0), egui::Sense::hover());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Image, true, "Rows of samples on the compass")
        });
        let (colour, weak) = (ui.visuals().text_color(), ui.visuals().weak_text_color());
        let painter = ui.painter();
        let square = rect.shrink(14.0);
        let line = egui::Stroke::new(1.0, weak);
        painter.rect_stroke(square, 0.0, line, egui::StrokeKind::Middle);
        compass(ui, rect, if is_south_first { square.left_bottom() } else { square.left_top() });
        for row in 0..4_u8 {
            let start = square.left_top() + egui::vec2(8.0, 10.0 + 12.0 * f32::from(row));
            let end = start + egui::vec2(square.width() - 16.0, 0.0);
            let stroke = egui::Stroke::new(1.0, colour);
            painter.line_segment([start, end], stroke);
            for side in [-3.0, 3.0] {
                painter.line_segment([end, end + egui::vec2(-4.0, side)], stroke);
            }
        }
        let [corner, next] = if is_south_first { ["south", "north"] } else { ["north", "south"] };
        let text = format!(
            "The first sample is the {corner}-west corner; rows run to the east, and follow each other to the {next}"
        );
        ui.add(egui::Label::new(text).wrap());
    });
}
