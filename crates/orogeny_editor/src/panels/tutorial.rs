//! The five first steps.

use egui::Context;

use crate::editor::Editor;

/// A heading and what to do.
const STEPS: [(&str, &str); 5] = [
    (
        "Draw",
        "Choose Raise on the left, hold the left mouse button and draw on the ground. Ctrl does the opposite, Shift smooths. Esc takes a stroke back while you draw it.",
    ),
    (
        "Size and strength",
        "[ and ] make the brush smaller and larger, - and = weaker and stronger. Each brush remembers its own.",
    ),
    (
        "Look around",
        "The wheel comes nearer to what is under the pointer. The middle button drags the ground along. Hold the right button to look, and fly with W A S D. Alt and the left button go around a place. F shows everything.",
    ),
    (
        "Back and forth",
        "Ctrl+Z takes back, Ctrl+Shift+Z does again; the history on the right goes to any moment. There is nothing to save: the file is always current.",
    ),
    (
        "Layers",
        "Put a layer on top by + on the right and draw on it: hide it, fade it or move it later. File, Export writes heights for your engine.",
    ),
];

/// Gives the step while it stays open.
pub(super) fn show(editor: &mut Editor, ctx: &Context, step: usize) -> Option<usize> {
    let (heading, text) = STEPS.get(step).copied()?;
    let mut next = Some(step);
    let shown =
        super::window(ctx, &format!("First steps: {heading} ({} of {})", step + 1, STEPS.len()), |ui| {
            ui.label(text);
            ui.horizontal(|ui| {
                if step > 0 && ui.button("Back").clicked() {
                    next = Some(step - 1);
                }
                let title = if step + 1 < STEPS.len() { "Next" } else { "Done" };
                if ui.button(title).clicked() {
                    next = Some(step + 1);
                }
            });
        });
    let stays = next.filter(|step| *step < STEPS.len() && shown.is_some());
    if stays.is_none() {
        editor.preferences.has_seen_tutorial = true;
        editor.remember();
    }
    stays
}
