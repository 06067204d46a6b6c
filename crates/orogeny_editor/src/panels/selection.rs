//! The selection: all, none, its edge, and by what the ground is like.

use egui::{CollapsingHeader, ComboBox, DragValue, Ui};
use orogeny_engine::SelectCombine;
use orogeny_engine::session::Status;
use serde_json::{Value, json};

use crate::command::Command;
use crate::editor::Editor;

/// How shapes join what was selected before.
const COMBINES: [(SelectCombine, &str); 4] = [
    (SelectCombine::Replace, "Instead of what is selected"),
    (SelectCombine::Add, "Added to it"),
    (SelectCombine::Subtract, "Taken from it"),
    (SelectCombine::Intersect, "Only within it"),
];

/// How the selection is changed next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Selecting {
    /// How far it grows, shrinks or fades, metres.
    pub(crate) length_m: f64,
    /// Whether it is shown whatever is in the hand.
    pub(crate) is_shown: bool,
    combine: SelectCombine,
    /// Least and largest slope, and how wide the edge of that is.
    slope_degrees: [f64; 3],
    /// The same of heights.
    height_m: [f64; 3],
}

impl Default for Selecting {
    fn default() -> Self {
        Self {
            length_m: 10.0,
            is_shown: false,
            combine: SelectCombine::Replace,
            slope_degrees: [30.0, 90.0, 5.0],
            height_m: [0.0, 100.0, 10.0],
        }
    }
}

impl Selecting {
    /// What befits a terrain: a few samples, and the upper half of its heights.
    pub(crate) fn set_terrain(&mut self, status: &Status) {
        let bounds = status.root.1.bounds;
        let [low_m, high_m] = [bounds.min_m, bounds.max_m].map(f64::from);
        self.length_m = 4.0 * status.grid.spacing_m();
        self.height_m =
            [f64::midpoint(low_m, high_m).round(), high_m.ceil(), ((high_m - low_m) / 20.0).ceil()];
    }

    /// Selects where a gate lets something through.
    fn by(&self, part: &str, [min, max, feather]: [f64; 3]) -> Value {
        let range = json!({"min": min, "max": max, "feather": feather});
        json!({"op": "select", "shape": {"gate": {part: range}}, "combine": self.combine})
    }
}

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    if editor.document.is_none() {
        return;
    }
    CollapsingHeader::new("Select").show(ui, |ui| {
        let mut give = |ui: &mut Ui, title: &str, command: Command| {
            if ui.button(title).on_hover_text(command.title()).clicked() {
                editor.run(command, &ui.ctx().clone());
            }
        };
        ui.horizontal_wrapped(|ui| {
            give(ui, "All", Command::SelectAll);
            give(ui, "None", Command::SelectNothing);
            give(ui, "Invert", Command::InvertSelection);
        });
        ui.horizontal_wrapped(|ui| {
            give(ui, "Grow", Command::GrowSelection);
            give(ui, "Shrink", Command::ShrinkSelection);
            give(ui, "Feather", Command::FeatherSelection);
        });
        let mut selecting = editor.panels.selecting;
        ui.horizontal(|ui| {
            let label = ui.label("by");
            let length = DragValue::new(&mut selecting.length_m).range(0.0..=1.0e5).suffix(" m");
            ui.add(length).on_hover_text("How far it grows, shrinks or fades").labelled_by(label.id);
            ui.checkbox(&mut selecting.is_shown, "Show")
                .on_hover_text("Shows what is selected, red, whatever is in the hand");
        });
        let combine = COMBINES.iter().find(|(combine, _)| *combine == selecting.combine);
        ComboBox::from_label("Joined")
            .selected_text(combine.map(|(_, title)| *title).unwrap_or_default())
            .width(150.0)
            .show_ui(ui, |ui| {
                for (combine, title) in COMBINES {
                    ui.selectable_value(&mut selecting.combine, combine, title);
                }
            });
        let mut operation = None;
        let by_slope = range(ui, "By slope", "°", &mut selecting.slope_degrees, 0.0..=90.0);
        if by_slope {
            operation = Some(selecting.by("slope", selecting.slope_degrees));
        }
        if range(ui, "By height", " m", &mut selecting.height_m, -1.0e5..=1.0e5) {
            operation = Some(selecting.by("height", selecting.height_m));
        }
        editor.panels.selecting = selecting;
        if let Some(operation) = operation {
            editor.apply("select", vec![operation]);
        }
    });
}

/// From, to and edge of a range, with the button that selects by it; tells whether that was clicked.
fn range(
    ui: &mut Ui,
    title: &str,
    unit: &str,
    [min, max, feather]: &mut [f64; 3],
    within: std::ops::RangeInclusive<f64>,
) -> bool {
    let mut is_clicked = false;
    is_clicked |= ui.button(title).clicked();
    ui.horizontal(|ui| {
        for (value, hint) in [(&mut *min, "from"), (&mut *max, "to")] {
            let label = ui.label(hint);
            ui.add(DragValue::new(value).range(within.clone()).suffix(unit)).labelled_by(label.id);
        }
        let label = ui.label("edge");
        ui.add(DragValue::new(feather).range(0.0..=1.0e5).suffix(unit))
            .on_hover_text("How wide the soft edge outside the range is")
            .labelled_by(label.id);
    });
    // A range is never empty.
    *max = max.max(*min);
    is_clicked
}
