//! The program's log: by how much lines matter, searched, copied.

use egui::{ComboBox, RichText, ScrollArea, TextEdit, Ui};
use tracing::Level;

use crate::editor::Editor;
use crate::log::{LogLine, MAX_LINES};

const LEVELS: [(Level, &str); 5] = [
    (Level::ERROR, "Errors"),
    (Level::WARN, "Warnings"),
    (Level::INFO, "Notes"),
    (Level::DEBUG, "Details"),
    (Level::TRACE, "Everything"),
];

/// What of it is seen.
#[derive(Debug)]
pub(crate) struct LogView {
    level: Level,
    search: String,
}

impl Default for LogView {
    fn default() -> Self {
        Self { level: Level::INFO, search: String::new() }
    }
}

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    let log = editor.options.log.clone();
    let view = &mut editor.panels.log;
    let (mut is_closed, mut is_copied) = (false, false);
    ui.horizontal(|ui| {
        ui.heading("Log");
        let title = LEVELS.iter().find(|(level, _)| *level == view.level).map(|(_, title)| *title);
        ComboBox::from_label("and worse").selected_text(title.unwrap_or_default()).show_ui(ui, |ui| {
            for (level, title) in LEVELS {
                ui.selectable_value(&mut view.level, level, title);
            }
        });
        let field = TextEdit::singleline(&mut view.search).hint_text("Words of a line").desired_width(180.0);
        let field = ui.add(field);
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search the log"));
        is_copied = ui.button("Copy lines").on_hover_text("Those that are shown, as text").clicked();
        if ui.button("Clear log").clicked() {
            log.clear();
        }
        let (num_kept, num_noted) = log.count();
        ui.label(
            RichText::new(format!("{num_kept} of {num_noted} lines; the last {MAX_LINES} are kept")).weak(),
        );
        is_closed = ui.small_button("Close log").clicked();
    });
    let lines = log.found(view.level, &view.search);
    if is_copied {
        let text: Vec<_> = lines.iter().map(LogLine::to_text).collect();
        ui.ctx().copy_text(text.join("\n"));
        editor.tell(format!("{} lines of the log were copied", lines.len()), false);
    }
    let height = ui.text_style_height(&egui::TextStyle::Monospace);
    let area = ScrollArea::both().id_salt("log").stick_to_bottom(true).auto_shrink(false);
    // Of many lines only those in sight are laid out.
    area.show_rows(ui, height, lines.len(), |ui, rows| {
        for line in lines.get(rows).unwrap_or_default() {
            // A line of the window for each, whatever is in it.
            let text = RichText::new(line.to_text().replace('\n', "  ")).monospace();
            let text = match line.level {
                Level::ERROR | Level::WARN => text.color(super::WARNING),
                Level::INFO => text,
                _ => text.weak(),
            };
            ui.add(egui::Label::new(text).extend());
        }
    });
    if is_closed {
        editor.panels.shows_log = false;
    }
}
