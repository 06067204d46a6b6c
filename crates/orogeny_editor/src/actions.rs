//! What commands do.

use orogeny_engine::BrushType;
use orogeny_engine::session::Travel;
use serde_json::json;

use crate::Hand;
use crate::camera::CameraControl;
use crate::command::{Command, capitalised, words};
use crate::document::Document;
use crate::editor::Editor;
use crate::panels::Dialog;
use crate::piece::Piece;
use crate::tool::Twist;

impl Editor {
    /// Does what a command says.
    pub fn run(&mut self, command: Command, ctx: &egui::Context) {
        match command {
            Command::New => self.panels.dialog = Some(Dialog::new_terrain(self)),
            Command::Open => self.panels.dialog = Some(Dialog::open(self)),
            Command::Import => self.panels.dialog = Some(Dialog::import(self)),
            Command::Export => self.panels.dialog = Some(Dialog::export(self)),
            Command::AddBrush => self.panels.dialog = Some(Dialog::add_brush(self)),
            Command::AddPreset => self.panels.dialog = Some(Dialog::add_preset(self)),
            Command::Quit => self.request_close(),
            Command::Undo => self.travel("undo", Travel::Undo(1)),
            Command::Redo => self.travel("redo", Travel::Redo(1)),
            Command::Cancel => self.cancel(),
            Command::FrameAll => {
                let size = self.viewport.size;
                if let Some(document) = &mut self.document {
                    document.frame_all([size.x, size.y]);
                }
            }
            Command::LookDown => self.look_down(),
            Command::SplitView => self.split_view(),
            Command::SwitchView => self.switch_view(),
            Command::KeepPlace(number) => self.keep_place(number),
            Command::GoToPlace(number) => match (self.place(number), &mut self.document) {
                (Some(place), Some(document)) => document.pane.camera = place,
                _ => self.tell(format!("no place was kept as {number} yet"), false),
            },
            Command::Compare => self.toggle_comparing(),
            Command::SeeEarlier => self.toggle_earlier(),
            Command::ShowMap => self.panels.shows_map = !self.panels.shows_map,
            Command::ShowHistogram => self.panels.shows_histogram = !self.panels.shows_histogram,
            Command::Larger => self.tool.resize(1),
            Command::Smaller => self.tool.resize(-1),
            Command::Stronger => self.tool.strengthen(1),
            Command::Weaker => self.tool.strengthen(-1),
            Command::CopyFromHere => match self.viewport.hovered {
                Some(place) => self.tool.copy_from([place.x, place.z]),
                None => self.tell("hold the pointer over the ground that is to be copied", false),
            },
            Command::TakeHeight => match self.viewport.hovered {
                Some(place) => {
                    self.tool.brush_type = BrushType::SetHeight;
                    self.tool.set("height", Some(place.y.into()));
                }
                None => self.tell("hold the pointer over the ground whose height is to be taken", false),
            },
            Command::Brush(brush_type) => self.take_brush(brush_type),
            Command::Hand(hand) => self.take_in_hand(hand),
            Command::Mode(mode) => self.show_mode(mode),
            Command::AddLayer
            | Command::AddProcedure
            | Command::AddEffect
            | Command::TuneLayer
            | Command::CollapseLayer
            | Command::DuplicateLayer
            | Command::RemoveLayer
            | Command::RaiseLayer
            | Command::LowerLayer
            | Command::ToggleLayer => self.change_layer(command),
            Command::Copy => {
                let told = self.document.as_mut().and_then(Document::copy);
                self.messages.extend(told);
                // With nothing in the system's clipboard no key for pasting would come.
                ctx.copy_text("Ground of a terrain in Orogeny".to_owned());
            }
            Command::Paste => self.paste(),
            Command::PutDown => self.put_down(),
            Command::SelectAll
            | Command::SelectNothing
            | Command::InvertSelection
            | Command::GrowSelection
            | Command::ShrinkSelection
            | Command::FeatherSelection => self.change_selection(command),
            Command::ShowSelection => self.panels.selecting.is_shown = !self.panels.selecting.is_shown,
            Command::CommandPalette => self.panels.dialog = Some(Dialog::Commands { search: String::new() }),
            Command::ToggleTheme => {
                self.preferences.is_light = !self.preferences.is_light;
                self.remember();
            }
            Command::LargerInterface => self.scale_interface(ctx, 1.1),
            Command::SmallerInterface => self.scale_interface(ctx, 1.0 / 1.1),
            Command::ShowMessages => self.panels.shows_messages = !self.panels.shows_messages,
            Command::ShowLog => self.panels.shows_log = !self.panels.shows_log,
            Command::ShowPreferences => self.panels.dialog = Some(Dialog::Preferences),
            Command::ShowTutorial => self.panels.dialog = Some(Dialog::Tutorial { step: 0 }),
        }
        ctx.request_repaint();
    }

    fn scale_interface(&mut self, ctx: &egui::Context, factor: f32) {
        self.preferences.interface_scale = (ctx.zoom_factor() * factor).clamp(0.5, 3.0);
        self.remember();
    }

    fn cancel(&mut self) {
        if let Some(dialog) = self.panels.dialog.take() {
            self.panels.dialog = dialog.given_up();
            return;
        }
        self.end_comparing();
        if self.viewport.is_busy() {
            self.viewport.let_go();
        } else if self.viewport.piece.take().is_some() {
            return;
        } else if self.viewport.hand == Hand::Tape {
            self.viewport.tape_m = None;
        }
        if let Some(document) = &mut self.document {
            document.end_stroke();
            document.session.cancel_all();
        }
    }

    /// Where the eye was when it was kept under a number.
    pub(crate) fn place(&self, number: u8) -> Option<CameraControl> {
        let path = &self.document.as_ref()?.path;
        let index = usize::from(number).checked_sub(1)?;
        *self.preferences.places.get(path)?.get(index)?
    }

    fn keep_place(&mut self, number: u8) {
        let Some(document) = &self.document else { return };
        let places = self.preferences.places.entry(document.path.clone()).or_default();
        let index = usize::from(number).checked_sub(1);
        if let Some(place) = index.and_then(|index| places.get_mut(index)) {
            *place = Some(document.pane.camera);
            self.remember();
            self.tell(format!("this place is kept as {number}"), false);
        }
    }

    /// A second pane beside the one that is worked in, or that one alone again.
    fn split_view(&mut self) {
        let Some(document) = &mut self.document else { return };
        if let Some(closed) = document.other.take() {
            self.left_pictures.extend(closed.picture());
            document.pane.is_right = false;
            // What only the other one was compared with is no longer open.
            if !document.is_compared() && document.past.is_some_and(|past| !past.is_seen) {
                self.end_comparing();
            }
        } else if let Err(err) = document.split(&self.gpu) {
            self.tell(err.to_string(), true);
        }
    }

    /// What a hand is doing ends where it began.
    pub(crate) fn switch_view(&mut self) {
        if !self.viewport.is_busy()
            && let Some(document) = &mut self.document
        {
            document.switch_panes();
        }
    }

    fn look_down(&mut self) {
        let size = self.viewport.size;
        let Some(document) = &mut self.document else { return };
        document.frame_all([size.x, size.y]);
        let [width_m, depth_m] = document.size_m();
        let middle = glam::DVec3::new(width_m / 2.0, 0.0, depth_m / 2.0);
        let high_m = f64::from(document.pane.view.range_m()[1]);
        let up_m = (document.pane.camera.eye() - middle).length();
        let above = glam::DVec3::new(middle.x, high_m.max(0.0) + up_m, middle.z);
        document.pane.camera = CameraControl::looking_down(above);
    }

    /// Takes up a brush, to draw with it.
    pub(crate) fn take_brush(&mut self, brush_type: BrushType) {
        self.tool.brush_type = brush_type;
        self.take_in_hand(Hand::Brush);
    }

    /// What is being drawn ends before something else is taken into the hand.
    fn take_in_hand(&mut self, hand: Hand) {
        if self.viewport.hand != hand && !self.viewport.is_busy() {
            self.viewport.hand = hand;
        }
    }

    /// What was copied floats under the pointer, or where it was copied.
    fn paste(&mut self) {
        let Some(document) = &self.document else { return };
        let Some(copied) = &document.copied else {
            return self.tell("nothing was copied yet: select some ground and press Ctrl+C", false);
        };
        let [x_m, z_m, width_m, depth_m] = copied.region_m;
        let to_m = match self.viewport.hovered {
            Some(place) => [place.x, place.z],
            None => [x_m + width_m / 2.0, z_m + depth_m / 2.0],
        };
        self.viewport.piece = Some(Piece::new(copied, &document.path, to_m));
    }

    /// Blends what floats into the ground; it floats on where that cannot be.
    fn put_down(&mut self) {
        if self.viewport.piece.is_none() || !self.may_change() {
            return;
        }
        let Some(layer) = self.document.as_ref().map(|document| document.layer) else { return };
        if let Some(piece) = self.viewport.piece.take() {
            self.apply("put a piece down", vec![piece.put_down_json(layer)]);
        }
    }

    fn change_selection(&mut self, command: Command) {
        let length_m = self.panels.selecting.length_m;
        let keep = json!({"keep": true});
        let operation = match command {
            Command::SelectAll => json!({"op": "select", "shape": {"all": true}}),
            Command::SelectNothing => json!({"op": "select", "shape": {"nothing": true}}),
            Command::GrowSelection => json!({"op": "select", "shape": keep, "grow": length_m}),
            Command::ShrinkSelection => json!({"op": "select", "shape": keep, "shrink": length_m}),
            Command::FeatherSelection => json!({"op": "select", "shape": keep, "feather": length_m}),
            _ => json!({"op": "select", "shape": keep, "invert": true}),
        };
        self.apply(&command.title(), vec![operation]);
    }

    fn change_layer(&mut self, command: Command) {
        let Some(document) = &self.document else { return };
        let Some(layer) = document.current_layer() else { return };
        let id = layer.id;
        let is_made = layer.content.procedure().is_some();
        if matches!(command, Command::TuneLayer | Command::CollapseLayer) && !is_made {
            return;
        }
        let layers = &document.status.layers;
        let place = layers.iter().position(|other| other.id == id).unwrap_or_default();
        let id_at = |place: usize| layers.get(place).map(|layer| layer.id);
        let is_taken = |name: &str| layers.iter().any(|layer| layer.name == name);
        let new_name = |stem: &str| {
            (1..).map(|k| format!("{stem} {k}")).find(|name| !is_taken(name)).unwrap_or_default()
        };
        // What a layer is made by covers all of the terrain: it has no radius.
        let brush = || {
            let mut brush = self.tool.painted_json(Twist::None);
            brush.remove("radius");
            brush
        };
        let stem = || capitalised(&words(self.tool.brush_type.name()));
        let operation = match command {
            Command::AddLayer => json!({"op": "add_layer", "name": new_name("Layer"), "above": id}),
            Command::AddProcedure | Command::AddEffect => {
                let content_type = if command == Command::AddEffect { "effect" } else { "procedural" };
                let content = json!({"type": content_type, "brush": brush()});
                json!({"op": "add_layer", "name": new_name(&stem()), "above": id, "content": content})
            }
            Command::TuneLayer => {
                let content = json!({"type": layer.content.name(), "brush": brush()});
                json!({"op": "set_layer", "layer": id, "content": content})
            }
            Command::CollapseLayer => json!({"op": "collapse_layer", "layer": id}),
            Command::DuplicateLayer => json!({"op": "duplicate_layer", "layer": id}),
            Command::RemoveLayer => json!({"op": "remove_layer", "layer": id}),
            Command::RaiseLayer => match id_at(place + 1) {
                Some(above) => json!({"op": "move_layer", "layer": id, "above": above}),
                None => return,
            },
            Command::LowerLayer if place == 0 => return,
            // Above none it is the lowest.
            Command::LowerLayer => {
                json!({"op": "move_layer", "layer": id, "above": place.checked_sub(2).and_then(id_at)})
            }
            _ => json!({"op": "set_layer", "layer": id, "visible": !layer.visible}),
        };
        self.apply(&command.title(), vec![operation]);
    }
}
