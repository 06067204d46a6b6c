//! The command palette: a command by its name, or what begins like it.

use egui::{Context, Key, TextEdit};

use crate::command::Command;
use crate::editor::Editor;

/// Commands that are offered at most.
const MAX_OFFERED: usize = 12;

/// Gives what is searched for while it stays open.
pub(super) fn show(editor: &mut Editor, ctx: &Context, mut search: String) -> Option<String> {
    let mut chosen = None;
    let shown = super::window(ctx, "Find a command", |ui| {
        let field = ui.add(TextEdit::singleline(&mut search).hint_text("Name").desired_width(f32::INFINITY));
        field.request_focus();
        let mut offered = Command::all()
            .filter(|command| is_found(&command.title(), &search))
            .filter(|command| super::menu::is_possible(editor, *command))
            .take(MAX_OFFERED)
            .peekable();
        if ui.input(|input| input.key_pressed(Key::Enter)) {
            chosen = offered.peek().copied();
        }
        for command in offered {
            let key =
                editor.keymap.shortcut(command).map(|key| ctx.format_shortcut(&key)).unwrap_or_default();
            if ui.add(egui::Button::new(command.title()).shortcut_text(key).frame(false)).clicked() {
                chosen = Some(command);
            }
        }
    });
    if let Some(command) = chosen {
        editor.run(command, ctx);
        return None;
    }
    let is_given_up = ctx.input(|input| input.key_pressed(Key::Escape));
    shown.filter(|()| !is_given_up).map(|()| search)
}

/// Whether all words that are searched for are in a title.
fn is_found(title: &str, search: &str) -> bool {
    let title = title.to_lowercase();
    search.to_lowercase().split_whitespace().all(|word| title.contains(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_found_in_any_order() {
        assert!(is_found("Show height bands", "bands sho"));
        assert!(is_found("Undo", ""));
        assert!(!is_found("Undo", "undo layer"));
    }
}
