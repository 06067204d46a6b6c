//! Files: a terrain to open, heights to read or to write.

use std::path::{Path, PathBuf};

use egui::{Context, DragValue, Key, ScrollArea, TextEdit, Ui};
use orogeny_engine::{Direction, ExportOptions, ExportRequest, Format, ImportRequest, SampleType};

use super::Dialog;
use crate::editor::Editor;

/// What a file is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    Open,
    Import,
    Export,
}

/// Types of samples that a file may hold.
const SAMPLES: [(Option<SampleType>, &str); 4] = [
    (None, "as the format has it"),
    (Some(SampleType::U16), "16 bits, whole"),
    (Some(SampleType::I16), "16 bits, signed"),
    (Some(SampleType::F32), "32 bits, floating"),
];

/// What is chosen so far.
#[derive(Debug, Clone)]
pub(crate) struct FileDialog {
    purpose: Purpose,
    path: String,
    /// Whether it was not drawn yet.
    is_new: bool,
    /// The folder that is listed, and what is in it.
    listed: Option<(PathBuf, Vec<(String, bool)>)>,
    sample_type: usize,
    scale: Scale,
    range_m: [f64; 2],
}

/// What whole samples stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    /// The first and the last for the terrain's lowest and highest height.
    Terrain,
    /// The same for a range that is typed.
    Own,
    /// Each for a metre.
    Metres,
}

impl Scale {
    const ALL: [(Self, &str); 3] = [
        (Self::Terrain, "from the lowest to the highest"),
        (Self::Own, "a range of your own"),
        (Self::Metres, "whole metres"),
    ];
}

/// Where files are looked for at first.
pub(super) fn folder(editor: &Editor) -> PathBuf {
    let of_open = editor.open_file().and_then(Path::parent).map(Path::to_owned);
    of_open.filter(|folder| folder.is_dir()).or_else(|| std::env::current_dir().ok()).unwrap_or_default()
}

impl Dialog {
    /// Opening a terrain.
    pub(crate) fn open(editor: &Editor) -> Self {
        Self::file(editor, Purpose::Open, "")
    }

    /// Reading heights.
    pub(crate) fn import(editor: &Editor) -> Self {
        Self::file(editor, Purpose::Import, "")
    }

    /// Reading heights of a file that is known.
    pub(crate) fn import_of(editor: &Editor, file: &Path) -> Self {
        let dialog = Self::file(editor, Purpose::Import, "");
        match dialog {
            Self::File(dialog) => Self::File(FileDialog { path: file.display().to_string(), ..dialog }),
            other => other,
        }
    }

    /// Writing heights.
    pub(crate) fn export(editor: &Editor) -> Self {
        let name =
            editor.open_file().and_then(Path::file_stem).unwrap_or_default().to_string_lossy().into_owned();
        Self::file(editor, Purpose::Export, &format!("{name}.png"))
    }

    fn file(editor: &Editor, purpose: Purpose, name: &str) -> Self {
        let path = folder(editor).join(name).display().to_string();
        let range_m =
            editor.document.as_ref().map_or([0.0, 1.0], |document| document.view.range_m().map(f64::from));
        Self::File(FileDialog {
            purpose,
            path,
            is_new: true,
            listed: None,
            sample_type: 0,
            scale: Scale::Terrain,
            range_m,
        })
    }
}

impl FileDialog {
    const fn title(&self) -> &'static str {
        match self.purpose {
            Purpose::Open => "Open terrain",
            Purpose::Import => "Import heights",
            Purpose::Export => "Export heights",
        }
    }

    const fn button(&self) -> &'static str {
        match self.purpose {
            Purpose::Open => "Open",
            Purpose::Import => "Import",
            Purpose::Export => "Export",
        }
    }

    /// Whether a file is one that is looked for.
    fn is_offered(&self, name: &str) -> bool {
        let ending = Path::new(name).extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match self.purpose {
            Purpose::Open => ending == "orogeny",
            Purpose::Import => Format::from_path(Path::new(name), Direction::Import).is_ok(),
            Purpose::Export => Format::from_path(Path::new(name), Direction::Export).is_ok(),
        }
    }

    /// The folder of the path that is typed.
    fn folder(&self) -> PathBuf {
        let path = Path::new(&self.path);
        if path.is_dir() { path.to_owned() } else { path.parent().unwrap_or(Path::new(".")).to_owned() }
    }

    fn list(&mut self, ui: &mut Ui) {
        let folder = self.folder();
        if self.listed.as_ref().is_none_or(|(listed, _)| *listed != folder) {
            let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
            let mut names: Vec<_> = entries
                .map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.path().is_dir()))
                .filter(|(name, is_folder)| !name.starts_with('.') && (*is_folder || self.is_offered(name)))
                .collect();
            names.sort_by(|(a, a_is_folder), (b, b_is_folder)| b_is_folder.cmp(a_is_folder).then(a.cmp(b)));
            self.listed = Some((folder.clone(), names));
        }
        let Some((_, names)) = &self.listed else { return };
        let mut chosen = None;
        ScrollArea::vertical().max_height(220.0).auto_shrink([false, true]).show(ui, |ui| {
            if folder.parent().is_some() && ui.selectable_label(false, "..").clicked() {
                chosen = folder.parent().map(Path::to_owned);
            }
            for (name, is_folder) in names {
                let end = if *is_folder { "/" } else { "" };
                let is_chosen = Path::new(&self.path) == folder.join(name);
                if ui.selectable_label(is_chosen, format!("{name}{end}")).clicked() {
                    chosen = Some(folder.join(name));
                }
            }
        });
        if let Some(path) = chosen {
            self.path = path.display().to_string();
        }
    }

    /// How an export is written.
    fn export_options(&mut self, ui: &mut Ui) {
        let (_, name) = SAMPLES.get(self.sample_type).copied().unwrap_or((None, ""));
        egui::ComboBox::from_label("Samples").selected_text(name).show_ui(ui, |ui| {
            for (index, (_, name)) in SAMPLES.iter().enumerate() {
                ui.selectable_value(&mut self.sample_type, index, *name);
            }
        });
        if !self.is_scaled() {
            return;
        }
        let title = Scale::ALL.iter().find(|(scale, _)| *scale == self.scale).map(|(_, title)| *title);
        egui::ComboBox::from_label("Heights")
            .selected_text(title.unwrap_or_default())
            .show_ui(ui, |ui| {
                for (scale, title) in Scale::ALL {
                    ui.selectable_value(&mut self.scale, scale, title);
                }
            })
            .response
            .on_hover_text("What whole samples stand for: the other program has to be told the same");
        if self.scale == Scale::Own {
            ui.horizontal(|ui| {
                for (end, name) in self.range_m.iter_mut().zip(["from", "to"]) {
                    let label = ui.label(name);
                    ui.add(DragValue::new(end).suffix(" m")).labelled_by(label.id);
                }
            });
        }
    }

    /// Whether samples are whole numbers that a range can be given for.
    fn is_scaled(&self) -> bool {
        let (sample, _) = SAMPLES.get(self.sample_type).copied().unwrap_or((None, ""));
        let format = Format::from_path(Path::new(self.path.trim()), Direction::Export);
        matches!(format, Ok(Format::Png | Format::R16 | Format::Raw))
            && matches!(sample, None | Some(SampleType::U16))
    }

    /// What the first and the last sample stand for, metres; `None`: samples are metres.
    fn chosen_range_m(&self, terrain_m: [f32; 2]) -> Option<[f64; 2]> {
        let [low_m, high_m] = terrain_m.map(f64::from);
        match self.scale {
            _ if !self.is_scaled() => None,
            // A flat terrain has a range as well.
            Scale::Terrain => Some([low_m, if high_m > low_m { high_m } else { low_m + 1.0 }]),
            Scale::Own => Some(self.range_m),
            Scale::Metres => None,
        }
    }

    /// How much of 65,536 steps a file uses, how high a step is, and what is lost.
    fn meter(&self, ui: &mut Ui, [low_m, high_m]: [f32; 2]) {
        if !self.is_scaled() {
            ui.label("Samples are metres");
            return;
        }
        let [from_m, to_m] = self.chosen_range_m([low_m, high_m]).unwrap_or([0.0, 65_535.0]);
        let span_m = to_m - from_m;
        let warn =
            |ui: &mut Ui, text: &str| _ = ui.colored_label(egui::Color32::from_rgb(230, 120, 90), text);
        if span_m <= 0.0 {
            return warn(ui, "The range is empty: its end has to lie above its start");
        }
        let share = (f64::from(high_m - low_m) / span_m).clamp(0.0, 1.0) as f32;
        ui.add(egui::ProgressBar::new(share).text(format!("{:.0} % of 16 bits used", 100.0 * share)));
        ui.label(format!(
            "Sample 0 is {from_m:.3} m, sample 65,535 is {to_m:.3} m; a step is {:.4} m",
            span_m / 65_535.0
        ));
        if f64::from(low_m) < from_m || f64::from(high_m) > to_m {
            warn(ui, "Heights beyond the range will be clipped");
        }
    }
}

/// Which corner a file begins in, and how it goes on.
fn orientation(ui: &mut Ui) {
    ui.horizontal(|ui| {
        let (rect, response) = ui.allocate_exact_size(egui::vec2(84.0, 84.0), egui::Sense::hover());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Image, true, "Rows of samples on the compass")
        });
        let (colour, weak) = (ui.visuals().text_color(), ui.visuals().weak_text_color());
        let (painter, font) = (ui.painter(), egui::FontId::proportional(11.0));
        let square = rect.shrink(14.0);
        let line = egui::Stroke::new(1.0, weak);
        painter.rect_stroke(square, 0.0, line, egui::StrokeKind::Middle);
        let sides = [
            (rect.center_top(), egui::Align2::CENTER_TOP, "N"),
            (rect.center_bottom(), egui::Align2::CENTER_BOTTOM, "S"),
            (rect.left_center(), egui::Align2::LEFT_CENTER, "W"),
            (rect.right_center(), egui::Align2::RIGHT_CENTER, "E"),
        ];
        for (place, align, name) in sides {
            painter.text(place, align, name, font.clone(), weak);
        }
        painter.circle_filled(square.left_top(), 4.0, egui::Color32::from_rgb(255, 190, 60));
        for row in 0..4_u8 {
            let start = square.left_top() + egui::vec2(8.0, 10.0 + 12.0 * f32::from(row));
            painter.arrow(start, egui::vec2(square.width() - 16.0, 0.0), egui::Stroke::new(1.0, colour));
        }
        ui.label(
            "The first sample is the north-west corner; rows run to the east, and follow each other to the south",
        );
    });
}

pub(super) fn show(editor: &mut Editor, ctx: &Context, mut dialog: FileDialog) -> Option<FileDialog> {
    let range_m = editor.document.as_ref().map_or([0.0, 1.0], |document| document.view.range_m());
    let mut is_done = false;
    let shown = super::window(ctx, dialog.title(), |ui| {
        let label = ui.label("Path");
        let field = TextEdit::singleline(&mut dialog.path).desired_width(f32::INFINITY);
        let field = ui.add(field).labelled_by(label.id);
        if std::mem::take(&mut dialog.is_new) {
            field.request_focus();
        }
        is_done = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        dialog.list(ui);
        if dialog.purpose == Purpose::Export {
            dialog.export_options(ui);
            dialog.meter(ui, range_m);
            orientation(ui);
        }
        is_done |= ui.button(dialog.button()).clicked();
    });
    if is_done && !Path::new(&dialog.path).is_dir() {
        finish(editor, &dialog);
        return None;
    }
    shown.map(|()| dialog)
}

fn finish(editor: &mut Editor, dialog: &FileDialog) {
    let path = PathBuf::from(dialog.path.trim());
    if dialog.purpose == Purpose::Open {
        return editor.open(&path);
    }
    if dialog.purpose == Purpose::Import && !editor.may_change() {
        return;
    }
    let mut told = None;
    let Some(document) = &mut editor.document else { return };
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    match dialog.purpose {
        Purpose::Open => {}
        Purpose::Import => {
            let layer = document.current_layer().map(|layer| layer.name.clone());
            let ticket = document.session.import(ImportRequest { layer, ..ImportRequest::new(path) });
            document.note(ticket, format!("import {name}"));
        }
        Purpose::Export => {
            let (sample, _) = SAMPLES.get(dialog.sample_type).copied().unwrap_or((None, ""));
            let range_m = dialog.chosen_range_m(document.view.range_m());
            told = range_m.map(|[from_m, to_m]| {
                format!("{name}: sample 0 is {from_m:.3} m, sample 65,535 is {to_m:.3} m")
            });
            let options =
                ExportOptions { sample, range_m: range_m.map(Into::into), ..ExportOptions::default() };
            let ticket = document.session.export(ExportRequest { options, ..ExportRequest::new(path) });
            document.note(ticket, format!("export {name}"));
        }
    }
    if let Some(told) = told {
        editor.tell(told, false);
    }
}
