//! What the left button does.

use egui::Ui;

use crate::Hand;
use crate::command::{Command, capitalised};
use crate::editor::Editor;

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        for hand in Hand::ALL {
            let command = Command::Hand(hand);
            let key = editor.keymap.shortcut(command);
            let key = key.map(|key| format!(" ({})", ui.ctx().format_shortcut(&key))).unwrap_or_default();
            let button = ui.selectable_label(editor.hand() == hand, capitalised(hand.name()));
            if button.on_hover_text(format!("{}{key}", hand.title())).clicked() {
                editor.run(command, &ui.ctx().clone());
            }
        }
    });
}
