//! The editor without its window: what is open, what is shown, what commands do.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{TextureId, Ui};
use orogeny_engine::presets::ExportPresets;
use orogeny_engine::session::{Event, HistoryItem, Session, Travel};
use orogeny_engine::{
    BrushType, Direction, Format, Gpu, Layer, Mode, Operation, Preset, Presets, Settings, TerrainGrid,
    ViewRequest,
};
use serde_json::Value;

use crate::Hand;
use crate::Result;
use crate::camera::CameraControl;
use crate::command::Command;
use crate::document::{Document, Message};
use crate::keymap::Keymap;
use crate::log::Log;
use crate::measure::Measurement;
use crate::own_brushes::OwnBrushes;
use crate::pane::Pane;
use crate::panels::{Dialog, Panels};
use crate::piece::Piece;
use crate::preferences::Preferences;
use crate::previews::Previews;
use crate::quality::Quality;
use crate::thumbnails::Thumbnails;
use crate::tool::{Tool, Twist};
use crate::viewport::Viewport;

/// Messages that are kept at most.
const MAX_MESSAGES: usize = 200;
/// How often it is noted where one is.
const REMEMBER_EVERY: Duration = Duration::from_secs(3);

/// Has the next frame drawn.
pub(crate) type Wake = Arc<dyn Fn() + Send + Sync>;

/// What an editor is started with.
pub struct EditorOptions {
    /// How terrains are worked on.
    pub settings: Settings,
    /// What there is to paint with beside the brushes.
    pub presets: Presets,
    /// The folder of the brushes that the user wrote, which need not be there; `None`: there is none.
    pub own_brushes: Option<PathBuf>,
    /// What the program notes, to be looked at.
    pub log: Log,
    /// Where preferences are kept; `None`: nowhere.
    pub preferences: Option<PathBuf>,
    /// Makes the terrain that comes along, where it is not there yet, and tells its file.
    pub bundled: Box<dyn Fn() -> orogeny_engine::Result<PathBuf>>,
}

impl std::fmt::Debug for EditorOptions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EditorOptions").field("settings", &self.settings).finish_non_exhaustive()
    }
}

/// A terrain that is being opened.
#[derive(Debug)]
struct Opening {
    path: PathBuf,
    session: Session,
}

/// All of the editor but its window.
pub struct Editor {
    pub(crate) options: EditorOptions,
    wake: Wake,
    pub(crate) preferences: Preferences,
    /// As they are in their file.
    written: Preferences,
    pub(crate) keymap: Keymap,
    pub(crate) gpu: Gpu,
    opening: Option<Opening>,
    pub(crate) document: Option<Document>,
    pub(crate) tool: Tool,
    pub(crate) request: ViewRequest,
    pub(crate) viewport: Viewport,
    pub(crate) quality: Quality,
    pub(crate) thumbnails: Thumbnails,
    pub(crate) own_brushes: OwnBrushes,
    pub(crate) export_presets: ExportPresets,
    pub(crate) previews: Previews,
    pub(crate) panels: Panels,
    pub(crate) messages: Vec<Message>,
    is_closing: bool,
    /// When preferences were last looked at.
    remembered: Instant,
    /// What was typed after the key that opened a dialog, until that is there.
    late: Vec<egui::Event>,
    /// Pictures that egui knows and that are shown no more.
    pub(crate) left_pictures: Vec<TextureId>,
}

impl std::fmt::Debug for Editor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Editor").field("options", &self.options).finish_non_exhaustive()
    }
}

impl Editor {
    /// An editor with nothing open, that draws on a device. `wake` has the next frame drawn, and is called from other threads.
    #[must_use]
    pub fn new(options: EditorOptions, gpu: Gpu, wake: impl Fn() + Send + Sync + 'static) -> Self {
        let wake: Wake = Arc::new(wake);
        let read = options.preferences.as_deref().map_or(Ok(Preferences::default()), Preferences::read);
        let (preferences, wrong) = match read {
            Ok(preferences) => (preferences, None),
            Err(err) => (Preferences::default(), Some(Message { text: err.to_string(), is_error: true })),
        };
        // What cannot be read is not written over either.
        let preferences_file = options.preferences.clone().filter(|_| wrong.is_none());
        let first_mode = if gpu.description().is_software { Mode::Shaded } else { Mode::Textured };
        // What was compared with what is not remembered.
        let is_last = |mode: &Mode| mode.name() == preferences.mode && *mode != Mode::Difference;
        let mode = Mode::ALL.into_iter().find(is_last).unwrap_or(first_mode);
        let thumbnails = Thumbnails::new(Arc::clone(&wake));
        let previews = Previews::new(Arc::clone(&wake));
        let export_presets = ExportPresets::of(&options.presets);
        let own_brushes = OwnBrushes::new(options.own_brushes.clone());
        let mut panels = Panels::default();
        if !preferences.has_seen_tutorial {
            panels.dialog = Some(Dialog::Tutorial { step: 0 });
        }
        Self {
            tool: Tool::new(&preferences.brush, preferences.brushes.clone()),
            keymap: preferences.keymap(),
            options: EditorOptions { preferences: preferences_file, ..options },
            wake,
            written: preferences.clone(),
            preferences,
            gpu,
            opening: None,
            document: None,
            request: ViewRequest { mode, ..ViewRequest::default() },
            viewport: Viewport::default(),
            quality: Quality::default(),
            thumbnails,
            own_brushes,
            export_presets,
            previews,
            panels,
            messages: wrong.into_iter().collect(),
            is_closing: false,
            remembered: Instant::now(),
            late: Vec::new(),
            left_pictures: Vec::new(),
        }
    }

    /// Opens what was open last, or the terrain that comes along.
    pub fn open_last(&mut self) {
        let last = self.preferences.recent.iter().find(|path| path.is_file()).cloned();
        match last.map_or_else(|| (self.options.bundled)(), Ok) {
            Ok(path) => self.open(&path),
            Err(err) => self.tell(err.to_string(), true),
        }
    }

    /// Opens a terrain in the place of the one that is open.
    pub fn open(&mut self, path: &Path) {
        let wake = Arc::clone(&self.wake);
        // The next start may be in another folder.
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let path = path.as_path();
        // The file is no one else's while it is open, not even this editor's.
        if self.document.as_ref().is_some_and(|document| document.path == path) {
            return;
        }
        if let Some(job) = self.document.as_ref().and_then(|document| document.jobs.first()) {
            let text = format!(
                "{} is still under way: wait for it, or press Esc, then open another terrain",
                job.what
            );
            return self.tell(text, true);
        }
        self.end_comparing();
        match Session::open(path, self.options.settings.sharing(&self.gpu), move || wake()) {
            Ok(session) => self.opening = Some(Opening { path: path.to_owned(), session }),
            Err(err) => self.tell(format!("`{}` cannot be opened: {err}", path.display()), true),
        }
    }

    /// Makes a flat terrain and opens it.
    pub fn create(&mut self, path: &Path, grid: TerrainGrid, height_m: f32) {
        let made = orogeny_engine::Terrain::create(path, grid, height_m, self.options.settings.clone());
        match made.and_then(orogeny_engine::Terrain::close) {
            Ok(()) => self.open(path),
            Err(err) => self.tell(format!("`{}` cannot be made: {err}", path.display()), true),
        }
    }

    /// How terrains are worked on.
    #[must_use]
    pub const fn settings(&self) -> &Settings {
        &self.options.settings
    }

    /// Draws on another device from now on: the old one was lost.
    pub fn set_gpu(&mut self, gpu: Gpu) {
        self.gpu = gpu;
        self.left_pictures.clear();
        self.thumbnails.forget();
        let Some(document) = &mut self.document else { return };
        if let Err(err) = document.draw_on(&self.gpu) {
            self.tell(err.to_string(), true);
        }
    }

    /// Takes what happened since the last frame.
    pub fn update(&mut self) {
        self.finish_opening();
        if self.remembered.elapsed() >= REMEMBER_EVERY && !self.viewport.is_busy() {
            self.remember();
        }
        let Some(document) = &mut self.document else { return };
        match document.take_events() {
            Ok(messages) => {
                messages.into_iter().for_each(|message| self.tell(message.text, message.is_error))
            }
            Err(err) => self.tell(err.to_string(), true),
        }
    }

    fn finish_opening(&mut self) {
        let Some(opening) = self.opening.take() else { return };
        let mut status = None;
        for event in opening.session.events() {
            match event {
                Event::Status(told) => status = Some(*told),
                Event::Failed { message, .. } => return self.tell(message, true),
                _ => {}
            }
        }
        let Some(status) = status else {
            self.opening = Some(opening);
            return;
        };
        self.remember();
        let Opening { path, session } = opening;
        let camera = self.preferences.cameras.get(&path).copied();
        match Document::new(&path, session, status, &self.gpu, camera, self.request.mode) {
            Ok(mut document) => {
                self.tool.set_terrain(&document.status);
                self.panels.selecting.set_terrain(&document.status);
                (self.viewport.tape_m, self.viewport.piece) = (None, None);
                if let Some(before) = self.document.take() {
                    self.left_pictures.extend(before.panes().filter_map(Pane::picture));
                    // It is read from its file when it is put down.
                    document.copied = before.copied;
                }
                self.document = Some(document);
                self.preferences.note_opened(&path);
                self.remember();
            }
            Err(err) => self.tell(err.to_string(), true),
        }
    }

    /// Writes preferences where they have changed, with where the eye is: should the program end at once, the next start is there.
    pub fn remember(&mut self) {
        self.remembered = Instant::now();
        if let Some(document) = &self.document {
            self.preferences.cameras.insert(document.path.clone(), document.pane.camera);
        }
        self.preferences.brush = self.tool.brush_type.name().to_owned();
        self.preferences.brushes.clone_from(&self.tool.objects);
        self.preferences.mode = self.request.mode.name().to_owned();
        let Some(path) = self.options.preferences.clone() else { return };
        if self.preferences == self.written {
            return;
        }
        self.written = self.preferences.clone();
        if let Err(err) = self.preferences.write(&path) {
            self.tell(err.to_string(), true);
        }
    }

    /// Tells people something.
    pub fn tell(&mut self, text: impl Into<String>, is_error: bool) {
        let text = text.into();
        if is_error {
            tracing::warn!("{text}");
        } else {
            tracing::info!("{text}");
        }
        self.messages.push(Message { text, is_error });
        let num_over = self.messages.len().saturating_sub(MAX_MESSAGES);
        self.messages.drain(..num_over);
    }

    /// The last message.
    #[must_use]
    pub fn last_message(&self) -> Option<&str> {
        self.messages.last().map(|message| message.text.as_str())
    }

    /// Everything that went wrong and was told, oldest first.
    pub fn errors(&self) -> impl Iterator<Item = &str> {
        self.messages.iter().filter(|message| message.is_error).map(|message| message.text.as_str())
    }

    /// The history of what is open, oldest first.
    #[must_use]
    pub fn history(&self) -> &[HistoryItem] {
        self.document.as_ref().map_or(&[], |document| &document.status.history)
    }

    /// The layers of what is open, from the bottom.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        self.document.as_ref().map_or(&[], |document| &document.status.layers)
    }

    /// Where the eye is.
    #[must_use]
    pub fn camera(&self) -> Option<CameraControl> {
        self.document.as_ref().map(|document| document.pane.camera)
    }

    /// How the ground is shown.
    #[must_use]
    pub fn mode(&self) -> Mode {
        match self.document.as_ref().map(|document| &document.pane) {
            Some(pane) if pane.is_compared => Mode::Difference,
            Some(pane) => pane.mode,
            None => self.request.mode,
        }
    }

    /// The brush in the hand.
    #[must_use]
    pub const fn brush_type(&self) -> BrushType {
        self.tool.brush_type
    }

    /// What the left button does.
    #[must_use]
    pub const fn hand(&self) -> Hand {
        self.viewport.hand
    }

    /// What floats over the ground.
    #[must_use]
    pub const fn piece(&self) -> Option<&Piece> {
        self.viewport.piece.as_ref()
    }

    /// What the tape measures, where one lies on the ground: as finely as that has been drawn so far.
    #[must_use]
    pub fn measured(&self) -> Option<Measurement> {
        let (document, tape_m) = (self.document.as_ref()?, self.viewport.tape_m?);
        let spacing_m = document.status.grid.spacing_m();
        Some(Measurement::between(tape_m, spacing_m, |place_m| {
            f64::from(document.pane.view.ground(place_m).0)
        }))
    }

    /// The radius of the brush in the hand, metres.
    #[must_use]
    pub fn brush_radius_m(&self) -> f64 {
        self.tool.radius_m()
    }

    /// The brush in the hand as a recipe has it.
    #[must_use]
    pub fn brush_json(&self) -> serde_json::Map<String, Value> {
        self.tool.brush_json(Twist::None)
    }

    /// The file that it paints with, where the user wrote it: while that does not compile a copy of the last good one.
    #[must_use]
    pub fn painted_file(&self) -> Option<String> {
        self.tool.stand_in.clone().or_else(|| self.tool.file())
    }

    /// How strong it is, 0..1.
    #[must_use]
    pub fn brush_share(&self) -> f64 {
        self.tool.share()
    }

    /// Closes the window, once what is under way is done.
    pub fn request_close(&mut self) {
        self.is_closing = true;
        self.end_comparing();
        if let Some(document) = &mut self.document
            && let Some(stroke) = document.stroke
        {
            // The hand is off the ground.
            document.session.lift(stroke);
            document.end_stroke();
            self.viewport.let_go();
        }
        if let Some(job) = self.document.as_ref().and_then(|document| document.jobs.first()) {
            let text =
                format!("{} is still under way: the window closes after it; Esc gives it up", job.what);
            self.tell(text, false);
        }
    }

    /// Whether the window is to close now.
    #[must_use]
    pub fn is_closing(&self) -> bool {
        self.is_closing && self.document.as_ref().is_none_or(|document| document.jobs.is_empty())
    }

    /// The file that is open.
    #[must_use]
    pub fn open_file(&self) -> Option<&Path> {
        self.document.as_ref().map(|document| document.path.as_path())
    }

    /// Whether nothing is under way, and what is seen is all there is to see.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        let is_settled = |document: &Document| {
            document.jobs.is_empty()
                && document.panes().all(|pane| pane.view.is_complete())
                && !document.overview.is_waiting()
        };
        self.opening.is_none()
            && !self.thumbnails.is_waiting()
            && !self.previews.is_waiting()
            && self.document.as_ref().is_none_or(is_settled)
    }

    /// Whether another frame is wanted without anything happening.
    #[must_use]
    pub fn wants_frame(&self) -> bool {
        let is_waiting = |document: &Document| document.panes().any(|pane| pane.view.is_waiting());
        self.viewport.is_busy() || self.document.as_ref().is_some_and(is_waiting)
    }

    /// How long the last frame took, so that the next ones are drawn as finely as there is time for.
    /// Tells whether another one would show more.
    pub fn note_frame(&mut self, elapsed: Duration) -> bool {
        self.quality.note_frame(elapsed) && self.document.is_some()
    }

    /// Draws everything, and takes input.
    pub fn ui(&mut self, ui: &mut Ui) {
        let late = std::mem::take(&mut self.late);
        ui.input_mut(|input| drop(input.events.splice(0..0, late)));
        let typing = ui.ctx().egui_wants_keyboard_input();
        if !typing {
            self.late = ui.input_mut(|input| self.keymap.take_late(&mut input.events));
            if !self.late.is_empty() {
                ui.ctx().request_repaint();
            }
            let pressed = ui.input_mut(|input| self.keymap.take_pressed(input));
            for command in pressed {
                match command {
                    Command::SeeEarlier => self.see_earlier(true),
                    command => self.run(command, ui.ctx()),
                }
            }
        }
        self.let_go_of_earlier(ui.ctx());
        let dropped = ui.input(|input| input.raw.dropped_files.clone());
        for file in dropped {
            self.take_dropped(file.path());
        }
        self.set_look(ui.ctx());
        crate::panels::show(self, ui);
        self.look(ui);
        crate::panels::show_dialog(self, ui.ctx());
    }

    /// A file that was dropped on the window: a terrain is opened, heights are offered to be imported, a preset is kept, a brush is
    /// taken into the hand.
    fn take_dropped(&mut self, file: &Path) {
        if file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("wgsl")) {
            return self.add_own_brush(file);
        }
        if file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("orogeny")) {
            return self.open(file);
        }
        if file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json")) {
            return self.add_preset(file);
        }
        match Format::from_path(file, Direction::Import) {
            Ok(_) if self.document.is_some() => {
                self.panels.dialog = Some(Dialog::import_of(self, file));
            }
            Ok(_) => self.tell("open a terrain, or make one: then drop the heights on it again", true),
            Err(err) => self.tell(format!("`{}`: {err}", file.display()), true),
        }
    }

    /// Keeps a preset that someone gave; one of its name stays as it is.
    pub(crate) fn add_preset(&mut self, file: &Path) {
        match Preset::read(file).and_then(|preset| self.options.presets.save(&preset, false)) {
            Ok(path) => self.tell(format!("the preset was kept as `{}`", path.display()), false),
            Err(err) => self.tell(err.to_string(), true),
        }
    }

    fn set_look(&self, ctx: &egui::Context) {
        let theme = if self.preferences.is_light { egui::Theme::Light } else { egui::Theme::Dark };
        ctx.set_theme(theme);
        if self.preferences.interface_scale > 0.0 {
            ctx.set_zoom_factor(self.preferences.interface_scale);
        }
    }

    /// Runs operations on what is open.
    pub(crate) fn apply(&mut self, what: &str, operations: Vec<Value>) {
        if !self.may_change() {
            return;
        }
        let Some(document) = &mut self.document else { return };
        let read = |value| Operation::from_json_with(value, &self.options.presets);
        match operations.into_iter().map(read).collect::<Result<Vec<_>, _>>() {
            Ok(operations) => {
                let ticket = document.session.apply(operations);
                document.note(ticket, what);
            }
            Err(err) => self.tell(err.to_string(), true),
        }
    }

    /// Fills the current layer with the brush.
    pub(crate) fn fill(&mut self) {
        if !self.may_change() {
            return;
        }
        let Some(document) = &mut self.document else { return };
        match self.tool.fill(document.layer, document.has_only_mask(), &self.options.presets) {
            Ok(operation) => {
                let what = format!("fill {}", self.tool.brush_type.name());
                let ticket = document.session.apply(vec![operation]);
                document.note(ticket, what);
            }
            Err(err) => self.tell(err.to_string(), true),
        }
    }

    /// Goes through the history.
    pub(crate) fn travel(&mut self, what: &str, travel: Travel) {
        if !self.may_change() {
            return;
        }
        let Some(document) = &mut self.document else { return };
        let ticket = document.session.travel(travel);
        document.note(ticket, what);
    }

    /// Closes what is open: what was done is on disk then.
    ///
    /// # Errors
    /// When the terrain's file could not be closed well; nothing is lost then.
    pub fn close(&mut self) -> Result<()> {
        self.end_comparing();
        self.remember();
        if let Some(document) = self.document.take() {
            document.session.close()?;
        }
        Ok(())
    }
}
