//! What stands around the ground: menus, brushes, layers, history, the status line, and dialogs over it.

mod browse;
mod brushes;
mod commands;
mod curve;
mod export;
mod files;
mod hands;
mod histogram;
mod history;
mod import;
mod layers;
mod light;
mod log;
mod map;
mod measurement;
mod menu;
mod new_terrain;
mod own_brushes;
mod parameters;
mod piece;
mod plot;
mod preferences;
mod selection;
mod status;
mod tutorial;

use egui::{Color32, Context, Panel, ScrollArea, Ui};

use crate::Hand;
use crate::editor::Editor;

pub(crate) use browse::Browse;
pub(crate) use files::FileDialog;
pub(crate) use log::LogView;
pub(crate) use map::MapView;
pub(crate) use new_terrain::NewTerrain;
pub(crate) use selection::Selecting;

/// What is open over the ground.
#[derive(Debug)]
pub(crate) enum Dialog {
    /// A flat terrain is made.
    New(NewTerrain),
    /// A file is opened, read or written.
    File(Box<FileDialog>),
    /// A file is chosen for a field.
    Browse(Browse),
    /// A command is looked for.
    Commands { search: String },
    /// Keys, theme, size.
    Preferences,
    /// The first steps.
    Tutorial { step: usize },
}

/// What panels remember while the window is open.
#[derive(Debug, Default)]
pub(crate) struct Panels {
    pub(crate) dialog: Option<Dialog>,
    /// What is looked for among the brushes.
    pub(crate) brush_search: String,
    /// The name of a layer while it is typed, with the layer's id.
    pub(crate) renaming: Option<(u32, String)>,
    /// The name that a preset is saved under.
    pub(crate) preset_name: String,
    /// Whether the list of all messages is open.
    pub(crate) shows_messages: bool,
    /// Whether the program's log is open, and what of it is seen.
    pub(crate) shows_log: bool,
    pub(crate) log: LogView,
    /// How the selection is changed by the panel for that.
    pub(crate) selecting: Selecting,
    /// Whether the map is open, and what of it is seen.
    pub(crate) shows_map: bool,
    pub(crate) map: MapView,
    /// Whether the histogram is open.
    pub(crate) shows_histogram: bool,
    /// The share of the width that the left pane has, where it is not half of it.
    pub(crate) left_share: Option<f32>,
}

/// Draws all of them but dialogs.
pub(crate) fn show(editor: &mut Editor, ui: &mut Ui) {
    Panel::top("menu").show(ui, |ui| menu::show(editor, ui));
    Panel::bottom("status").show(ui, |ui| status::show(editor, ui));
    if editor.panels.shows_messages {
        Panel::bottom("messages")
            .resizable(true)
            .default_size(140.0)
            .show(ui, |ui| status::messages(editor, ui));
    }
    if editor.panels.shows_log {
        Panel::bottom("log").resizable(true).default_size(200.0).show(ui, |ui| log::show(editor, ui));
    }
    // It is there before the tape is drawn out: the ground must not move under the hand.
    if editor.hand() == Hand::Tape || editor.viewport.tape_m.is_some() {
        Panel::bottom("measurement")
            .resizable(true)
            .default_size(170.0)
            .min_size(120.0)
            .show(ui, |ui| measurement::show(editor, ui));
    }
    Panel::left("tools").resizable(true).default_size(270.0).show(ui, |ui| {
        ScrollArea::vertical().id_salt("tools").show(ui, |ui| {
            hands::show(editor, ui);
            ui.separator();
            brushes::show(editor, ui);
            ui.separator();
            parameters::show(editor, ui);
        });
    });
    Panel::right("document").resizable(true).default_size(250.0).show(ui, |ui| {
        ScrollArea::vertical().id_salt("document").show(ui, |ui| {
            piece::show(editor, ui);
            if editor.panels.shows_map {
                map::show(editor, ui);
                ui.separator();
            }
            if editor.panels.shows_histogram {
                histogram::show(editor, ui);
                ui.separator();
            }
            layers::show(editor, ui);
            ui.separator();
            history::show(editor, ui);
            ui.separator();
            selection::show(editor, ui);
            light::show(editor, ui);
        });
    });
}

/// Draws what is open over the ground.
pub(crate) fn show_dialog(editor: &mut Editor, ctx: &Context) {
    let Some(dialog) = editor.panels.dialog.take() else { return editor.previews.forget() };
    let stays = match dialog {
        Dialog::New(new) => new_terrain::show(editor, ctx, new),
        Dialog::Browse(browse) => browse::show(editor, ctx, browse),
        Dialog::File(file) => files::show(editor, ctx, *file).map(|file| Dialog::File(Box::new(file))),
        Dialog::Commands { search } => {
            commands::show(editor, ctx, search).map(|search| Dialog::Commands { search })
        }
        Dialog::Preferences => preferences::show(editor, ctx).then_some(Dialog::Preferences),
        Dialog::Tutorial { step } => tutorial::show(editor, ctx, step).map(|step| Dialog::Tutorial { step }),
    };
    // What it did may have opened another one.
    if editor.panels.dialog.is_none() {
        editor.panels.dialog = stays;
    }
}

/// Of what is wrong, or would be refused.
const WARNING: Color32 = Color32::from_rgb(230, 120, 90);

/// Of where a file of heights begins.
const FIRST: Color32 = Color32::from_rgb(255, 190, 60);

/// Draws the quarters of the compass within the sides of a rectangle, and where a file of heights begins.
fn compass(ui: &Ui, rect: egui::Rect, first: egui::Pos2) {
    let (font, weak) = (egui::FontId::proportional(11.0), ui.visuals().weak_text_color());
    for (place, align, name) in [
        (rect.center_top(), egui::Align2::CENTER_TOP, "N"),
        (rect.center_bottom(), egui::Align2::CENTER_BOTTOM, "S"),
        (rect.left_center(), egui::Align2::LEFT_CENTER, "W"),
        (rect.right_center(), egui::Align2::RIGHT_CENTER, "E"),
    ] {
        ui.painter().text(place, align, name, font.clone(), weak);
    }
    ui.painter().circle_filled(first, 4.0, FIRST);
}

/// A window in the middle that is a dialog. `None` where its cross was clicked.
fn window<T>(ctx: &Context, title: &str, add: impl FnOnce(&mut Ui) -> T) -> Option<T> {
    window_of(ctx, title, 420.0, add)
}

/// A dialog of two columns.
fn wide_window<T>(ctx: &Context, title: &str, add: impl FnOnce(&mut Ui) -> T) -> Option<T> {
    window_of(ctx, title, 760.0, add)
}

fn window_of<T>(ctx: &Context, title: &str, width: f32, add: impl FnOnce(&mut Ui) -> T) -> Option<T> {
    let mut is_open = true;
    let shown = egui::Window::new(title)
        .open(&mut is_open)
        .collapsible(false)
        .default_width(width)
        .anchor(egui::Align2::CENTER_CENTER, [0.0, -40.0])
        .show(ctx, add);
    shown.and_then(|shown| shown.inner).filter(|_| is_open)
}
