//! The menu bar.

use egui::{Button, ComboBox, MenuBar, Ui};
use orogeny_engine::Mode;

use crate::command::{Command, Menu, capitalised, words};
use crate::editor::Editor;

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    let mut chosen = None;
    MenuBar::new().ui(ui, |ui| {
        for menu in Menu::ALL {
            ui.menu_button(menu.title(), |ui| {
                for command in Command::all().filter(|command| command.menu() == menu) {
                    let mut button = Button::new(command.title());
                    if let Some(shortcut) = editor.keymap.shortcut(command) {
                        button = button.shortcut_text(ui.ctx().format_shortcut(&shortcut));
                    }
                    if ui.add_enabled(is_possible(editor, command), button).clicked() {
                        chosen = Some(command);
                        ui.close();
                    }
                }
                if menu == Menu::File && !editor.preferences.recent.is_empty() {
                    ui.separator();
                    ui.label("Recent");
                    let recent = editor.preferences.recent.clone();
                    for path in recent {
                        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                        if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                            editor.open(&path);
                            ui.close();
                        }
                    }
                }
            });
        }
        ui.separator();
        let mode = editor.mode();
        let label = ui.label("Show");
        let shown = ComboBox::from_id_salt("mode").selected_text(capitalised(&words(mode.name())));
        let shown = shown.show_ui(ui, |ui| {
            for other in Mode::ALL {
                if ui.selectable_label(other == mode, capitalised(&words(other.name()))).clicked() {
                    chosen = Some(Command::Mode(other));
                }
            }
        });
        shown.response.labelled_by(label.id);
        let name = editor.open_file().and_then(|path| path.file_name());
        if let Some(name) = name.map(|name| name.to_string_lossy().into_owned()) {
            ui.separator();
            ui.label(name).on_hover_text("The file is always current: there is nothing to save");
        }
    });
    if let Some(command) = chosen {
        editor.run(command, &ui.ctx().clone());
    }
}

/// Whether a command would do anything now.
pub(super) fn is_possible(editor: &Editor, command: Command) -> bool {
    let Some(document) = &editor.document else {
        return matches!(command.menu(), Menu::File | Menu::Help | Menu::View | Menu::Brush)
            && !matches!(command, Command::Export | Command::Import);
    };
    let [can_undo, can_redo] = document.status.can_undo_redo();
    match command {
        Command::Undo => can_undo,
        Command::Redo => can_redo,
        Command::TuneLayer | Command::CollapseLayer => {
            document.current_layer().is_some_and(|layer| layer.content.procedure().is_some())
        }
        Command::GoToPlace(number) => editor.place(number).is_some(),
        Command::Compare | Command::SeeEarlier | Command::Mode(Mode::Difference) => {
            document.past.is_some() || can_undo
        }
        Command::SwitchView => document.other.is_some(),
        Command::Paste => document.copied.is_some(),
        Command::PutDown => editor.viewport.piece.is_some(),
        Command::RemoveLayer => document.status.layers.len() > 1,
        _ => true,
    }
}
