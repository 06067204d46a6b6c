//! The viewport in the window: its pictures, what lies over that, and what hands wish there.

use egui::{
    Align2, Color32, CursorIcon, Event, FontId, Rect, Response, Sense, Stroke, StrokeKind, TextureId, Ui,
    Vec2, pos2, vec2,
};
use orogeny_engine::{Cursor, Mode, PointerSample, ViewRequest};

use crate::comparing::{COMPARING, legend};
use crate::document::Document;
use crate::editor::Editor;
use crate::hand::select_json;
use crate::pane::{self, Pane};
use crate::tool::Twist;
use crate::viewport::{Point, Wish};

impl Editor {
    /// The viewport: what is left of the window, for one pane or for two.
    pub(crate) fn look(&mut self, ui: &mut Ui) {
        if self.document.is_none() {
            ui.centered_and_justified(|ui| ui.label("No terrain is open: File, Open or New"));
            return;
        }
        let rooms = self.rooms(ui);
        let Some(document) = &mut self.document else { return };
        let before = (document.pane.camera, self.viewport.hovered);
        let mut wishes = Vec::new();
        self.viewport.is_airbrush = self.tool.is_airbrush();
        if let Some(mine) = rooms.first() {
            wishes = self.viewport.show(ui, mine, document, &mut self.request);
        }
        if let (Some(room), Some(pane)) = (rooms.get(1), &document.other) {
            self.viewport.hover(ui, room, pane);
        }
        if before != (document.pane.camera, self.viewport.hovered) || self.viewport.is_busy() {
            self.quality.note_motion();
        }
        if let Some(wait) = self.quality.until_still() {
            ui.ctx().request_repaint_after(wait);
        }
        let requests = self.requests();
        self.draw(&rooms, &requests, ui.ctx().pixels_per_point());
        if let Some(document) = &self.document {
            for ((pane, room), request) in document.panes().zip(&rooms).zip(&requests) {
                self.paint(ui, room.rect, document, pane, request.mode);
            }
        }
        if let [mine, _] = rooms.as_slice() {
            let stroke = Stroke::new(1.0, ui.visuals().selection.bg_fill);
            ui.painter().rect_stroke(mine.rect, 0.0, stroke, StrokeKind::Inside);
        }
        for wish in wishes {
            self.grant(wish);
        }
    }

    /// The room of the pane that is worked in, and that of the other one. A press in that makes it the one that is worked in.
    fn rooms(&mut self, ui: &mut Ui) -> Vec<Response> {
        let size = ui.available_size().max(Vec2::splat(16.0));
        let (room, _) = ui.allocate_exact_size(size, Sense::hover());
        let interact = |rect, name| ui.interact(rect, ui.scope_id().with(name), Sense::click_and_drag());
        let panes = self.document.as_ref().map(|document| (document.pane.is_right, document.other.is_some()));
        let Some((is_right, true)) = panes else { return vec![interact(room, "left pane")] };
        let share = self.panels.left_share.unwrap_or(0.5);
        let [left, right, between] = pane::split(room, share);
        let mut rooms = vec![interact(left, "left pane"), interact(right, "right pane")];
        let between =
            interact(between, "between panes").on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
        if let Some(at) = between.interact_pointer_pos() {
            self.panels.left_share = Some(pane::share_at(room, at.x));
        }
        if is_right {
            rooms.reverse();
        }
        let is_pressed = ui.input(|input| {
            input.pointer.any_pressed()
                || input.events.iter().any(|event| matches!(event, Event::MouseWheel { .. }))
        });
        let is_other = rooms.get(1).is_some_and(Response::contains_pointer);
        if is_pressed && is_other && !self.viewport.is_busy() {
            self.switch_view();
            rooms.reverse();
        }
        rooms
    }

    /// What is asked of each pane: the brush's ring, and how the ground is shown there.
    fn requests(&mut self) -> Vec<ViewRequest> {
        let Some(document) = &mut self.document else { return Vec::new() };
        // The ring is that of a stroke that could be drawn; a brush that lacks something has none.
        let is_on_mask = document.has_only_mask();
        let ring = self.tool.stroke(document.layer, is_on_mask, Twist::None, &self.options.presets);
        self.request.cursors =
            ring.map(|stroke| self.viewport.cursors(&stroke, document)).unwrap_or_default();
        let source = self.tool.source_m().map(|centre_m| Cursor {
            centre_m,
            radius_m: (self.tool.radius_m() / 4.0) as f32,
            hardness: 1.0,
        });
        self.request.cursors.extend(source);
        let (selects, is_shown) = (self.viewport.hand.selects(), self.panels.selecting.is_shown);
        let is_of_selection = self.tool.is_on_selection || selects || is_shown;
        self.request.mask = match (is_of_selection, document.current_layer()) {
            (false, Some(layer)) => layer.name.clone(),
            _ => "selection".to_owned(),
        };
        let has_shadows =
            self.request.has_shadows && (!self.gpu.description().is_software || self.quality.is_still());
        let is_seen = document.past.is_some_and(|past| past.is_seen);
        let request = |(index, pane): (usize, &Pane)| {
            let mode = match pane.mode {
                // What is selected by hand is seen where the hand is.
                _ if is_shown || selects && index == 0 => Mode::Overlay,
                _ if pane.is_compared && !is_seen => Mode::Difference,
                mode => mode,
            };
            ViewRequest { has_shadows, mode, ..self.request.clone() }
        };
        let requests: Vec<_> = document.panes().enumerate().map(request).collect();
        let masks = document.panes().zip(&requests).map(|(pane, request)| pane.view.masks(request));
        let masks: Vec<_> = masks.filter(|names| !names.is_empty()).collect();
        document.show_masks(masks.into_iter().next().unwrap_or_default());
        requests
    }

    fn draw(&mut self, rooms: &[Response], requests: &[ViewRequest], pixels_per_point: f32) {
        let Some(Document { pane, other, session, asked, .. }) = &mut self.document else { return };
        let panes = std::iter::once(pane).chain(other);
        let mut wrong = Vec::new();
        for ((pane, room), request) in panes.zip(rooms).zip(requests) {
            let size_px = self.quality.size_px(pane::size_px(room.rect.size(), pixels_per_point));
            let camera = pane.camera.camera(size_px);
            wrong.extend(pane.draw(&camera, size_px, request, session, asked).err());
        }
        wrong.iter().for_each(|err| self.tell(err.to_string(), true));
    }

    /// Shows what was drawn, and over it what hands have drawn out and what is compared.
    fn paint(&self, ui: &Ui, rect: Rect, document: &Document, pane: &Pane, mode: Mode) {
        match pane.picture() {
            Some(picture) => {
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                ui.painter().image(picture, rect, whole, Color32::WHITE);
            }
            None => _ = ui.painter().rect_filled(rect, 0.0, Color32::DARK_GRAY),
        }
        let size_px = pane::size_px(rect.size(), ui.ctx().pixels_per_point());
        self.viewport.sketch(ui, rect, pane.camera.camera(size_px), document);
        let Some((text, most_m)) = self.comparison(pane) else { return };
        let painter = ui.painter().with_clip_rect(rect);
        match most_m.filter(|_| mode == Mode::Difference) {
            Some(most_m) => legend(&painter, rect, most_m),
            None => {
                let (font, colour) = (FontId::proportional(16.0), COMPARING);
                painter.text(rect.center_top() + vec2(0.0, 8.0), Align2::CENTER_TOP, text, font, colour);
            }
        }
    }

    fn grant(&mut self, wish: Wish) {
        if matches!(wish, Wish::Begin(_)) && !self.may_change() {
            if let Some(document) = &mut self.document {
                document.end_stroke();
            }
            return self.viewport.let_go();
        }
        let Some(document) = &mut self.document else { return };
        match wish {
            Wish::Begin(twist) => {
                let is_on_mask = document.has_only_mask();
                let stroke = self.tool.begin(document.layer, is_on_mask, twist, &self.options.presets);
                match stroke {
                    Ok(stroke) => {
                        let what = format!("stroke {}", stroke.brush().brush_type.name());
                        let ticket = document.session.begin_stroke(stroke);
                        document.stroke = Some(ticket);
                        document.note(ticket, what);
                    }
                    Err(err) => {
                        document.end_stroke();
                        self.viewport.let_go();
                        self.tell(err.to_string(), true);
                    }
                }
            }
            Wish::Points(points) => {
                let Some(stroke) = document.stroke else { return };
                let has_time = self.tool.is_airbrush();
                let sample = |point: Point| {
                    let [x_m, z_m] = point.place_m;
                    let sample = PointerSample::at(x_m, z_m).with_pressure(point.pressure);
                    PointerSample { time_s: has_time.then_some(point.time_s), ..sample }
                };
                document.session.push_points(stroke, points.into_iter().map(sample).collect());
            }
            Wish::Lift => {
                let Some(stroke) = document.stroke else { return };
                document.session.lift(stroke);
                document.end_stroke();
            }
            Wish::Select { path_m, combine } => {
                let least_m = document.status.grid.spacing_m();
                if let Some(operation) = select_json(self.viewport.hand, &path_m, combine, least_m) {
                    self.apply("select", vec![operation]);
                }
            }
        }
    }

    /// Has `show` make pictures of the ground known to egui where their textures are others than when this was last asked; it is given the
    /// name that egui has for the picture already. Tells whether one is known for the first time.
    pub fn take_pictures(
        &mut self,
        mut show: impl FnMut(&wgpu::TextureView, Option<TextureId>) -> TextureId,
    ) -> bool {
        let Some(document) = &mut self.document else { return false };
        document.panes_mut().fold(false, |is_first, pane| pane.take_picture(&mut show) | is_first)
    }

    /// Pictures that [`Self::take_pictures`] made known and that nothing shows any more.
    pub fn take_left_pictures(&mut self) -> Vec<TextureId> {
        std::mem::take(&mut self.left_pictures)
    }

    /// Has [`Self::take_pictures`] give all pictures again, though their textures are the same.
    pub fn renew_pictures(&mut self) {
        if let Some(document) = &mut self.document {
            document.panes_mut().for_each(Pane::renew_picture);
        }
    }
}
