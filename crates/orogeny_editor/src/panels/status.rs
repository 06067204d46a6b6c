//! The line at the bottom: where the pointer is, what is under way, what was told.

use egui::{ProgressBar, RichText, ScrollArea, Ui};

use crate::command::Command;
use crate::editor::Editor;

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    let mut is_cancelled = false;
    ui.horizontal(|ui| {
        let Some(document) = &editor.document else {
            ui.label("Nothing is open");
            return;
        };
        match editor.viewport.hovered {
            Some(place) => {
                let (height_m, slope_degrees) = document.pane.view.ground([place.x, place.z]);
                ui.monospace(format!(
                    "x {:>9.1} m   z {:>9.1} m   height {height_m:>8.2} m   slope {slope_degrees:>4.1}°",
                    place.x, place.z
                ));
            }
            None => _ = ui.monospace(format!("{:>66}", "")),
        }
        ui.separator();
        let memory = document.status.memory;
        ui.label(format!("{} of {} MiB", memory.total_in_bytes() >> 20, memory.budget_in_bytes >> 20))
            .on_hover_text("Pages in memory, of what they may take");
        ui.separator();
        if let Some(job) = document.jobs.first() {
            let share = job.progress.filter(|progress| progress.total > 0);
            let share = share.map(|progress| progress.done as f32 / progress.total as f32);
            let waiting = document.jobs.len() - 1;
            let text = if waiting > 0 { format!("{} (+{waiting})", job.what) } else { job.what.clone() };
            match share {
                Some(share) => _ = ui.add(ProgressBar::new(share).desired_width(160.0).text(text)),
                None => {
                    ui.spinner();
                    ui.label(text);
                }
            }
            is_cancelled =
                ui.small_button("Cancel").on_hover_text("Cancel: nothing of it stays (Esc)").clicked();
        }
        if let Some(message) = editor.messages.last() {
            let text = RichText::new(message.text.lines().next().unwrap_or_default());
            let text = if message.is_error { text.color(super::WARNING) } else { text.weak() };
            let label = ui.add(egui::Label::new(text).truncate().sense(egui::Sense::click()));
            if label.on_hover_text(&message.text).clicked() {
                editor.panels.shows_messages = true;
            }
        }
    });
    if is_cancelled {
        editor.run(Command::Cancel, &ui.ctx().clone());
    }
}

/// All that was told.
pub(super) fn messages(editor: &mut Editor, ui: &mut Ui) {
    ui.horizontal(|ui| {
        ui.heading("Messages");
        if ui.small_button("Close").clicked() {
            editor.panels.shows_messages = false;
        }
    });
    ScrollArea::vertical().stick_to_bottom(true).auto_shrink(false).show(ui, |ui| {
        for message in &editor.messages {
            let text = RichText::new(&message.text);
            ui.label(if message.is_error { text.color(super::WARNING) } else { text });
        }
    });
}
