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
    has_range: bool,
    range_m: [f64; 2],
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
            has_range: false,
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
        ui.checkbox(&mut self.has_range, "A range of heights of your own").on_hover_text(
            "Of whole samples: what their least and their largest value stand for; otherwise the terrain's own",
        );
        if self.has_range {
            ui.horizontal(|ui| {
                for end in &mut self.range_m {
                    ui.add(DragValue::new(end).suffix(" m"));
                }
            });
        }
    }

    /// How much of 65,536 steps a file uses, and how high a step is.
    fn meter(&self, ui: &mut Ui, [low_m, high_m]: [f32; 2]) {
        let [from_m, to_m] = if self.has_range { self.range_m } else { [low_m, high_m].map(f64::from) };
        let span_m = to_m - from_m;
        if span_m <= 0.0 {
            ui.colored_label(
                egui::Color32::from_rgb(230, 120, 90),
                "The range is empty: its end has to lie above its start",
            );
            return;
        }
        let share = (f64::from(high_m - low_m) / span_m).clamp(0.0, 1.0) as f32;
        ui.add(egui::ProgressBar::new(share).text(format!("{:.0} % of 16 bits used", 100.0 * share)));
        ui.label(format!("a step of 16 bits is {:.4} m", span_m / 65_535.0));
        if f64::from(low_m) < from_m || f64::from(high_m) > to_m {
            ui.colored_label(
                egui::Color32::from_rgb(230, 120, 90),
                "Heights beyond the range will be clipped",
            );
        }
    }
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
            let options = ExportOptions {
                sample,
                range_m: dialog.has_range.then(|| dialog.range_m.into()),
                ..ExportOptions::default()
            };
            let ticket = document.session.export(ExportRequest { options, ..ExportRequest::new(path) });
            document.note(ticket, format!("export {name}"));
        }
    }
}
