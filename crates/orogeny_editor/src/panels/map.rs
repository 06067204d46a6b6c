//! The terrain from above: where the eye is, what it sees, and places to come back to.

use egui::{Color32, Pos2, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};
use glam::DVec3;

use crate::command::Command;
use crate::document::Document;
use crate::editor::Editor;
use crate::outline::place_on_ground;
use crate::preferences::NUM_PLACES;

/// The highest that the map is, in points.
const MAX_HEIGHT: f32 = 320.0;
/// The furthest that the map comes near.
const MAX_ZOOM: f32 = 64.0;
/// How much nearer a step of the wheel comes.
const ZOOM_STEP: f32 = 1.2;
/// Points of the wheel that are a step.
const WHEEL_STEP: f32 = 50.0;
/// What is seen is drawn as far as so many times the terrain's longer side.
const FAR: f64 = 2.0;

/// What of the map is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MapView {
    /// How near it is: 1 for all of the terrain.
    zoom: f32,
    /// Its middle, shares of the terrain's width and depth.
    middle: Pos2,
    shows_difference: bool,
}

impl Default for MapView {
    fn default() -> Self {
        Self { zoom: 1.0, middle: pos2(0.5, 0.5), shows_difference: true }
    }
}

impl MapView {
    /// The part of the map that is seen, in shares of all of it.
    fn seen(&self) -> Rect {
        Rect::from_center_size(self.middle, vec2(1.0, 1.0) / self.zoom)
    }

    /// Comes nearer by steps, so that a place of the map stays where it is on the screen.
    fn zoom_to(&mut self, place: Pos2, steps: f32) {
        let before = self.zoom;
        self.zoom = (before * ZOOM_STEP.powf(steps)).clamp(1.0, MAX_ZOOM);
        let middle = place + (self.middle - place) * (before / self.zoom);
        let reach = 0.5 / self.zoom;
        self.middle = pos2(middle.x.clamp(reach, 1.0 - reach), middle.y.clamp(reach, 1.0 - reach));
    }
}

pub(super) fn show(editor: &mut Editor, ui: &mut Ui) {
    ui.heading("Map");
    let Some(document) = &mut editor.document else { return };
    document.overview.want(&document.session);
    let entry = document.status.current_entry();
    let map = document.overview.map(ui.ctx(), entry);
    let difference = document.past.and_then(|_| document.overview.difference(ui.ctx()));
    let view = &mut editor.panels.map;
    if let Some(difference) = &difference {
        ui.checkbox(&mut view.shows_difference, "Difference").on_hover_text(
            "By how much the ground is higher now, red, or lower, blue, than what is compared with it",
        );
        if view.shows_difference {
            let most_m = difference.most_m;
            ui.label(format!("red {most_m:.2} m higher now, blue {most_m:.2} m lower"));
        }
    }
    let [width_m, depth_m] = document.size_m().map(|side_m| side_m.max(1.0e-3));
    let width = ui.available_width();
    let height = (width * (depth_m / width_m) as f32).clamp(20.0, MAX_HEIGHT);
    let width = (height * (width_m / depth_m) as f32).clamp(20.0, width);
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::click_and_drag());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Image, true, "The terrain from above: a click goes there")
    });
    let shares = |at: Pos2, seen: Rect| {
        let share = (at - rect.min) / rect.size();
        seen.min + share * seen.size()
    };
    if let Some(pointer) = response.hover_pos().filter(|_| response.contains_pointer()) {
        // What it stands in does not scroll with it.
        let points = ui.input_mut(|input| std::mem::take(&mut input.smooth_scroll_delta)).y;
        if points != 0.0 {
            view.zoom_to(shares(pointer, view.seen()), points / WHEEL_STEP);
        }
    }
    let seen = view.seen();
    let is_pressed = response.is_pointer_button_down_on() || response.clicked();
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| is_pressed) {
        let place = shares(pointer, seen);
        go_to(document, [f64::from(place.x) * width_m, f64::from(place.y) * depth_m]);
    }
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let picture = match difference {
        Some(difference) if view.shows_difference => Some(difference.map),
        _ => map,
    };
    if let (Some(picture), Some(survey)) = (picture, document.overview.survey()) {
        // The last pixels may reach beyond the terrain.
        let [covered_m, covered_depth_m] = survey.size_m;
        let scale = vec2((width_m / covered_m) as f32, (depth_m / covered_depth_m) as f32);
        let of_picture = Rect::from_min_max(
            (seen.min.to_vec2() * scale).to_pos2(),
            (seen.max.to_vec2() * scale).to_pos2(),
        );
        painter.image(picture.id(), rect, of_picture, Color32::WHITE);
    }
    let on_map = |[x_m, z_m]: [f64; 2]| {
        let share = pos2((x_m / width_m) as f32, (z_m / depth_m) as f32);
        rect.min + (share - seen.min) / seen.size() * rect.size()
    };
    draw_eye(&painter, document, editor.viewport.size, rect, on_map);
    places(editor, ui);
}

/// Where the eye is and what it sees.
fn draw_eye(
    painter: &egui::Painter,
    document: &Document,
    size: egui::Vec2,
    rect: Rect,
    on_map: impl Fn([f64; 2]) -> Pos2,
) {
    let corners = footprint_m(document, size).map(&on_map);
    let line = Stroke::new(1.5, Color32::from_rgb(255, 220, 90));
    painter.add(Shape::convex_polygon(
        corners.to_vec(),
        Color32::from_rgba_unmultiplied(255, 220, 90, 28),
        line,
    ));
    let eye = document.pane.camera.eye();
    // From beyond the map it is drawn at its edge.
    let at = rect.shrink(8.0).clamp(on_map([eye.x, eye.z]));
    let (sin, cos) = (document.pane.camera.heading as f32).sin_cos();
    let turned = |right: f32, ahead: f32| at + vec2(right * cos + ahead * sin, right * sin - ahead * cos);
    let arrow = vec![turned(0.0, 9.0), turned(5.0, -6.0), turned(-5.0, -6.0)];
    painter.add(Shape::convex_polygon(arrow, line.color, Stroke::new(1.5, Color32::BLACK)));
}

/// The corners of what is seen of the level that the middle of the terrain's heights has, `[x, z]` in metres.
fn footprint_m(document: &Document, size: egui::Vec2) -> [[f64; 2]; 4] {
    let size_px = [size.x, size.y].map(|side| (side as u32).max(1));
    let camera = document.pane.camera.camera(size_px);
    let eye = camera.eye_m();
    let [low_m, high_m] = document.pane.view.range_m().map(f64::from);
    let [width_m, depth_m] = document.size_m();
    let furthest_m = FAR * width_m.max(depth_m);
    let fall_m = f64::midpoint(low_m, high_m).min(eye.y - 1.0e-3) - eye.y;
    let [right, below] = size_px.map(f64::from);
    [[0.0, 0.0], [right, 0.0], [right, below], [0.0, below]].map(|pixel| {
        let direction = camera.direction_of_pixel(pixel);
        let level = direction.x.hypot(direction.z).max(1.0e-9);
        let way = if direction.y < 0.0 { fall_m / direction.y } else { f64::INFINITY };
        let way = way.min(furthest_m / level);
        [eye.x + way * direction.x, eye.z + way * direction.z]
    })
}

/// Moves the eye so that it looks at a place as it looked at the ground before.
fn go_to(document: &mut Document, place_m: [f64; 2]) {
    let eye = document.pane.camera.eye();
    let looked_at = document
        .pane
        .view
        .pick(eye, document.pane.camera.ahead())
        .unwrap_or_else(|| place_on_ground(&document.pane.view, [eye.x, eye.z]));
    let by: DVec3 = place_on_ground(&document.pane.view, place_m) - looked_at;
    document.pane.camera.eye_m = (eye + by).to_array();
}

/// Places that are kept.
fn places(editor: &mut Editor, ui: &mut Ui) {
    let mut chosen = None;
    for (title, is_kept) in [("Go to", false), ("Keep as", true)] {
        ui.horizontal(|ui| {
            ui.label(title);
            for number in 1..=NUM_PLACES {
                let command = if is_kept { Command::KeepPlace(number) } else { Command::GoToPlace(number) };
                let is_possible = super::menu::is_possible(editor, command);
                let key = editor.keymap.shortcut(command);
                let key = key.map(|key| format!(" ({})", ui.ctx().format_shortcut(&key)));
                let hint = format!("{}{}", command.title(), key.unwrap_or_default());
                let button = ui.add_enabled(is_possible, egui::Button::new(number.to_string()));
                let button = button.on_hover_text(hint);
                button.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, is_possible, command.title())
                });
                if button.clicked() {
                    chosen = Some(command);
                }
            }
        });
    }
    if let Some(command) = chosen {
        editor.run(command, &ui.ctx().clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_under_the_pointer_stays_and_the_map_never_leaves_its_frame() {
        let mut view = MapView::default();
        let place = pos2(0.3, 0.6);
        let on_screen = |view: &MapView| (place - view.seen().min) / view.seen().size();
        let before = on_screen(&view);
        view.zoom_to(place, 5.0);
        assert!((on_screen(&view) - before).length() < 1.0e-5 && view.zoom > 2.0);
        view.zoom_to(pos2(1.0, 1.0), 500.0);
        assert_eq!(view.zoom, MAX_ZOOM);
        view.zoom_to(pos2(0.9, 0.2), -500.0);
        assert_eq!(view.seen(), Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)));
    }
}
