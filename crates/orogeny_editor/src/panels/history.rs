//! What was done, the last first; a click goes there.

use egui::{RichText, Ui};
use orogeny_engine::session::Travel;
use orogeny_engine::{EntryId, EntryState};

use crate::command::{capitalised, words};
use crate::editor::Editor;

/// Entries that are listed at most: more cannot be told apart by eye.
const MAX_LISTED: usize = 500;

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    ui.heading("History");
    let Some(document) = &editor.document else { return };
    let current = document.status.current_entry();
    let mut target = None;
    for item in document.status.history.iter().rev().take(MAX_LISTED) {
        let text = RichText::new(format!("{} {}", item.id, capitalised(&words(&item.label))));
        let text = match item.state {
            EntryState::Applied => text,
            EntryState::Undone => text.weak(),
            EntryState::Branch => text.weak().italics(),
        };
        let state = match item.state {
            EntryState::Applied => "done",
            EntryState::Undone => "undone",
            EntryState::Branch => "on another branch",
        };
        let hint = format!(
            "{state}, {} pages, by {}",
            item.num_pages,
            if item.author.is_empty() { "no one" } else { &item.author }
        );
        if ui.selectable_label(item.id == current, text).on_hover_text(hint).clicked() {
            target = Some(item.id);
        }
    }
    if ui.selectable_label(current == EntryId::CREATION, "0 The terrain as it was made").clicked() {
        target = Some(EntryId::CREATION);
    }
    if let Some(target) = target.filter(|target| *target != current) {
        editor.travel("go in the history", Travel::Jump(target));
    }
}
