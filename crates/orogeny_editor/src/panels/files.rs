//! Files: a terrain to open, heights to read or to write.

use std::path::{Path, PathBuf};

use egui::{Context, Key, ScrollArea, TextEdit, Ui};
use orogeny_engine::{Direction, Format};

use super::{Dialog, export, import};
use crate::editor::Editor;

/// What a file is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    Open,
    Import,
    Export,
    AddBrush,
}

/// What is chosen so far.
#[derive(Debug, Clone)]
pub(crate) struct FileDialog {
    purpose: Purpose,
    path: String,
    /// Whether it was not drawn yet.
    is_new: bool,
    /// The folder that is listed, and what is in it.
    listed: Option<(PathBuf, Vec<(String, bool)>)>,
    export: export::Choice,
    import: import::Choice,
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
        match Self::file(editor, Purpose::Import, "") {
            Self::File(mut dialog) => {
                dialog.path = file.display().to_string();
                Self::File(dialog)
            }
            other => other,
        }
    }

    /// Adding a brush that the user wrote.
    pub(crate) fn add_brush(editor: &Editor) -> Self {
        Self::file(editor, Purpose::AddBrush, "")
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
        Self::File(Box::new(FileDialog {
            purpose,
            path,
            is_new: true,
            listed: None,
            export: export::Choice::new(range_m),
            import: import::Choice::default(),
        }))
    }
}

impl FileDialog {
    const fn title(&self) -> &'static str {
        match self.purpose {
            Purpose::Open => "Open terrain",
            Purpose::Import => "Import heights",
            Purpose::Export => "Export heights",
            Purpose::AddBrush => "Add a brush of your own",
        }
    }

    const fn button(&self) -> &'static str {
        match self.purpose {
            Purpose::Open => "Open",
            Purpose::Import => "Import",
            Purpose::Export => "Export",
            Purpose::AddBrush => "Add",
        }
    }

    /// Whether a file is one that is looked for.
    fn is_offered(&self, name: &str) -> bool {
        let ending = Path::new(name).extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match self.purpose {
            Purpose::Open => ending == "orogeny",
            Purpose::AddBrush => ending == "wgsl",
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
}

pub(super) fn show(editor: &mut Editor, ctx: &Context, mut dialog: FileDialog) -> Option<FileDialog> {
    let mut is_done = false;
    let (title, purpose) = (dialog.title(), dialog.purpose);
    let is_wide = matches!(purpose, Purpose::Import | Purpose::Export);
    let add = |ui: &mut Ui| {
        let label = ui.label("Path");
        let field = TextEdit::singleline(&mut dialog.path).desired_width(f32::INFINITY);
        let field = ui.add(field).labelled_by(label.id);
        if std::mem::take(&mut dialog.is_new) {
            field.request_focus();
        }
        is_done = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if is_wide {
            ui.columns_const(|[left, right]| {
                dialog.list(left);
                let FileDialog { export, import, path, .. } = &mut dialog;
                // Columns would stretch what stands in them.
                right.vertical(|right| match purpose {
                    Purpose::Export => export::show(editor, right, export, path),
                    _ => import::show(editor, right, import, path),
                });
            });
        } else {
            dialog.list(ui);
        }
        is_done |= ui.button(dialog.button()).clicked();
    };
    let shown = if is_wide { super::wide_window(ctx, title, add) } else { super::window(ctx, title, add) };
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
    if dialog.purpose == Purpose::AddBrush {
        return editor.add_own_brush(&path);
    }
    if dialog.purpose == Purpose::Import && !editor.may_change() {
        return;
    }
    let mut told = None;
    let Some(document) = &mut editor.document else { return };
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    match dialog.purpose {
        Purpose::Open | Purpose::AddBrush => {}
        Purpose::Import => {
            let layer = document.current_layer().map(|layer| layer.name.clone());
            let ticket = document.session.import(dialog.import.request(&path, layer, document.status.grid));
            document.note(ticket, format!("import {name}"));
        }
        Purpose::Export => {
            let request = dialog.export.request(&dialog.path, document.view.range_m());
            let grid = document.status.grid;
            told =
                dialog.export.told(&name, &request.planned([grid.width(), grid.depth()], grid.spacing_m()));
            let ticket = document.session.export(request);
            document.note(ticket, format!("export {name}"));
        }
    }
    if let Some(told) = told {
        editor.tell(told, false);
    }
}
