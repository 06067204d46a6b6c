//! Files: a terrain to open, heights to read or to write.

use std::path::{Path, PathBuf};

use egui::{Context, Ui};

use super::browse::{Browser, Sought};
use super::{Dialog, export, import};
use crate::editor::Editor;

/// What a file is for.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Purpose {
    Open,
    Import,
    Export,
    AddBrush,
    AddPreset,
    /// The one of this name.
    WritePreset(String),
}

/// What is chosen so far.
#[derive(Debug, Clone)]
pub(crate) struct FileDialog {
    purpose: Purpose,
    path: String,
    browser: Browser,
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

    /// Taking a preset of someone else's.
    pub(crate) fn add_preset(editor: &Editor) -> Self {
        Self::file(editor, Purpose::AddPreset, "")
    }

    /// Writing a preset for someone else.
    pub(super) fn write_preset(editor: &Editor, name: &str) -> Self {
        let purpose = Purpose::WritePreset(name.to_owned());
        Self::file(editor, purpose, &format!("{}.json", name.replace(['/', '\\'], "-")))
    }

    /// Writing heights.
    pub(crate) fn export(editor: &Editor) -> Self {
        let name =
            editor.open_file().and_then(Path::file_stem).unwrap_or_default().to_string_lossy().into_owned();
        Self::file(editor, Purpose::Export, &format!("{name}.png"))
    }

    fn file(editor: &Editor, purpose: Purpose, name: &str) -> Self {
        let path = folder(editor).join(name).display().to_string();
        let range_m = editor
            .document
            .as_ref()
            .map_or([0.0, 1.0], |document| document.pane.view.range_m().map(f64::from));
        let sought = match purpose {
            Purpose::Open => Sought::Terrain,
            Purpose::Import => Sought::Heights,
            Purpose::Export => Sought::Written,
            Purpose::AddBrush => Sought::Shader,
            Purpose::AddPreset | Purpose::WritePreset(_) => Sought::Preset,
        };
        Self::File(Box::new(FileDialog {
            purpose,
            path,
            browser: Browser::new(sought),
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
            Purpose::AddPreset => "Add a preset",
            Purpose::WritePreset(_) => "Write the preset",
        }
    }

    const fn button(&self) -> &'static str {
        match self.purpose {
            Purpose::Open => "Open",
            Purpose::Import => "Import",
            Purpose::Export => "Export",
            Purpose::AddBrush | Purpose::AddPreset => "Add",
            Purpose::WritePreset(_) => "Write",
        }
    }
}

pub(super) fn show(editor: &mut Editor, ctx: &Context, mut dialog: FileDialog) -> Option<FileDialog> {
    let mut is_done = false;
    let (title, purpose) = (dialog.title(), dialog.purpose.clone());
    let is_wide = matches!(purpose, Purpose::Import | Purpose::Export);
    let recent = editor.preferences.folders();
    let add = |ui: &mut Ui| {
        is_done = dialog.browser.field(ui, &mut dialog.path);
        if is_wide {
            ui.columns_const(|[left, right]| {
                is_done |= dialog.browser.list(left, &mut dialog.path, &recent);
                let FileDialog { export, import, path, .. } = &mut dialog;
                // Columns would stretch what stands in them.
                right.vertical(|right| match purpose {
                    Purpose::Export => export::show(editor, right, export, path),
                    _ => import::show(editor, right, import, path),
                });
            });
        } else {
            is_done |= dialog.browser.list(ui, &mut dialog.path, &recent);
        }
        is_done |= ui.button(dialog.button()).clicked();
    };
    let shown = if is_wide { super::wide_window(ctx, title, add) } else { super::window(ctx, title, add) };
    if is_done && !Path::new(dialog.path.trim()).is_dir() {
        editor.preferences.note_folder(Path::new(dialog.path.trim()));
        finish(editor, &dialog);
        return None;
    }
    shown.map(|()| dialog)
}

fn finish(editor: &mut Editor, dialog: &FileDialog) {
    let path = PathBuf::from(dialog.path.trim());
    let told = match &dialog.purpose {
        Purpose::Open => return editor.open(&path),
        Purpose::AddBrush => return editor.add_own_brush(&path),
        Purpose::AddPreset => return editor.add_preset(&path),
        Purpose::WritePreset(name) => {
            let presets = &editor.options.presets;
            let written = presets.get(name).and_then(|known| known.preset.with_thumbnail());
            written
                .and_then(|preset| preset.write(&path))
                .map(|()| Some(format!("the preset {name} is in `{}`", path.display())))
        }
        Purpose::Import if editor.may_change() => {
            import_heights(editor, dialog, &path);
            Ok(None)
        }
        Purpose::Import => Ok(None),
        Purpose::Export => Ok(export_heights(editor, dialog, &path)),
    };
    match told {
        Ok(Some(told)) => editor.tell(told, false),
        Ok(None) => {}
        Err(err) => editor.tell(err.to_string(), true),
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn import_heights(editor: &mut Editor, dialog: &FileDialog, path: &Path) {
    let Some(document) = &mut editor.document else { return };
    let layer = document.current_layer().map(|layer| layer.name.clone());
    let ticket = document.session.import(dialog.import.request(path, layer, document.status.grid));
    document.note(ticket, format!("import {}", name_of(path)));
}

/// Gives what is to be told of the file.
fn export_heights(editor: &mut Editor, dialog: &FileDialog, path: &Path) -> Option<String> {
    let document = editor.document.as_mut()?;
    let name = name_of(path);
    let request = dialog.export.request(&dialog.path, document.pane.view.range_m());
    let grid = document.status.grid;
    let planned = request.planned([grid.width(), grid.depth()], grid.spacing_m());
    let ticket = document.session.export(request);
    document.note(ticket, format!("export {name}"));
    dialog.export.told(&name, &planned)
}
