//! What was done, the last first; a click goes there.

use egui::{RichText, Ui};
use orogeny_engine::session::Travel;
use orogeny_engine::{EntryId, EntryState};

use crate::command::{Command, capitalised, words};
use crate::comparing::COMPARING;
use crate::editor::Editor;

/// Entries that are listed at most: more cannot be told apart by eye.
const MAX_LISTED: usize = 500;

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    ui.heading("History");
    comparing(editor, ui);
    let Some(document) = &editor.document else { return };
    let compared = document.past.map(|past| past.entry);
    let current = document.status.current_entry();
    let (mut target, mut to_compare) = (None, None);
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
        let text = if compared == Some(item.id) { text.color(COMPARING) } else { text };
        let hint = format!(
            "{state}, {} pages, by {}",
            item.num_pages,
            if item.author.is_empty() { "no one" } else { &item.author }
        );
        let moment = document.overview.moment(item.id);
        let label = ui.selectable_label(item.id == current, text).on_hover_ui(|ui| {
            ui.label(hint);
            if let Some(moment) = moment {
                ui.image((moment.id(), moment.size_vec2()));
            }
        });
        if label.clicked() {
            target = Some(item.id);
        }
        label.context_menu(|ui| {
            if ui.button("Compare with now").clicked() {
                to_compare = Some(item.id);
                ui.close();
            }
        });
    }
    if ui.selectable_label(current == EntryId::CREATION, "0 The terrain as it was made").clicked() {
        target = Some(EntryId::CREATION);
    }
    if let Some(entry) = to_compare.or(target.filter(|_| compared.is_some())) {
        editor.compare_with(entry);
    } else if let Some(target) = target.filter(|target| *target != current) {
        editor.travel("go in the history", Travel::Jump(target));
    }
}

/// Whether the terrain is seen as it is, or as it was.
fn comparing(editor: &mut Editor, ui: &mut Ui) {
    let mut is_comparing = editor.is_comparing();
    ui.horizontal_wrapped(|ui| {
        let is_possible = super::menu::is_possible(editor, Command::Compare);
        let compare = ui.add_enabled(is_possible, egui::Checkbox::new(&mut is_comparing, "Compare"));
        let compare = compare.on_hover_text(
            "Shows by how much the terrain differs from how it was before the last entry, or after any that is clicked meanwhile; hold V to see it as it was",
        );
        if compare.changed() {
            editor.run(Command::Compare, &ui.ctx().clone());
        }
        if editor.is_comparing() && !editor.panels.shows_map {
            let button = ui.button("Difference on the map");
            if button.on_hover_text("By how much the ground is higher now, or lower").clicked() {
                editor.run(Command::ShowMap, &ui.ctx().clone());
            }
        }
    });
    let mut panes = editor.document.iter().flat_map(crate::document::Document::panes);
    if let Some((text, _)) = panes.find_map(|pane| editor.comparison(pane)) {
        ui.colored_label(COMPARING, text);
    }
}
