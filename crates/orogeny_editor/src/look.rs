//! The viewport in the window: its picture, what lies over that, and what hands wish there.

use egui::{TextureId, Ui};
use orogeny_engine::{Cursor, Mode, PointerSample, ViewRequest};
use serde_json::Value;

use crate::comparing::{COMPARING, legend};
use crate::editor::Editor;
use crate::hand::select_json;
use crate::tool::Twist;
use crate::viewport::{Point, Wish};

impl Editor {
    /// The viewport: what is left of the window.
    pub(crate) fn look(&mut self, ui: &mut Ui) {
        let Some(document) = &mut self.document else {
            ui.centered_and_justified(|ui| ui.label("No terrain is open: File, Open or New"));
            return;
        };
        let pixels_per_point = ui.ctx().pixels_per_point();
        let before = (document.camera, self.viewport.hovered);
        let (rect, room_px, wishes) = self.viewport.show(ui, document, &mut self.request, pixels_per_point);
        if before != (document.camera, self.viewport.hovered) || self.viewport.is_busy() {
            self.quality.note_motion();
        }
        if let Some(wait) = self.quality.until_still() {
            ui.ctx().request_repaint_after(wait);
        }
        let size_px = self.quality.size_px(room_px);
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
        let camera = document.camera.camera(size_px);
        let shows_selection = self.viewport.hand.selects() || self.panels.selecting.is_shown;
        self.request.mask = match (self.tool.is_on_selection || shows_selection, document.current_layer()) {
            (false, Some(layer)) => layer.name.clone(),
            _ => "selection".to_owned(),
        };
        let mode = match document.past {
            _ if shows_selection => Mode::Overlay,
            Some(past) if !past.is_glance && !past.is_seen => Mode::Difference,
            _ => self.request.mode,
        };
        let has_shadows =
            self.request.has_shadows && (!self.gpu.description().is_software || self.quality.is_still());
        let request = ViewRequest { has_shadows, mode, ..self.request.clone() };
        document.show_masks(&request);
        let drawn = document.view.draw(&camera, size_px, &request);
        let wanted = document.view.wanted();
        if !wanted.is_empty() {
            document.session.look(wanted);
        }
        match self.picture {
            Some(picture) => {
                let whole = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
                ui.painter().image(picture, rect, whole, egui::Color32::WHITE);
            }
            None => _ = ui.painter().rect_filled(rect, 0.0, egui::Color32::DARK_GRAY),
        }
        self.viewport.sketch(ui, rect, camera, document);
        if let Some((text, most_m)) = self.comparison() {
            let painter = ui.painter().with_clip_rect(rect);
            match most_m.filter(|_| mode == Mode::Difference) {
                Some(most_m) => legend(&painter, rect, most_m),
                None => {
                    let place = rect.center_top() + egui::vec2(0.0, 8.0);
                    let (font, colour) = (egui::FontId::proportional(16.0), COMPARING);
                    painter.text(place, egui::Align2::CENTER_TOP, text, font, colour);
                }
            }
        }
        if let Err(err) = drawn {
            self.tell(err.to_string(), true);
        }
        for wish in wishes {
            self.grant(wish);
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
                let has_time = self.tool.object().get("airbrush").and_then(Value::as_bool) == Some(true);
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

    /// What draws the picture, where its texture is another than when this was last asked: to be made known to egui.
    pub fn take_picture_view(&mut self) -> Option<wgpu::TextureView> {
        let document = self.document.as_mut()?;
        let is_new = std::mem::take(&mut self.is_picture_new) | document.view.take_is_resized();
        is_new.then(|| document.view.picture_view())
    }

    /// Has [`Self::take_picture_view`] give the picture again, though its texture is the same.
    pub const fn renew_picture(&mut self) {
        self.is_picture_new = true;
    }

    /// How egui knows the picture from now on.
    pub const fn set_picture(&mut self, picture: TextureId) {
        self.picture = Some(picture);
    }
}
