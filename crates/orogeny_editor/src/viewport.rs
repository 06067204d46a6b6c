//! The ground in the window: what mouse and keys do over it.

use egui::{Event, Key, PointerButton, Pos2, Rect, Response, Ui, Vec2};
use glam::DVec3;
use orogeny_engine::{BrushOperation, Camera, Cursor, SelectCombine, ViewRequest};

use crate::document::Document;
use crate::hand::{Hand, combine_of, corners_m};
use crate::outline::{Sketch, on_ground, place_on_ground};
use crate::pane::{Pane, size_px};
use crate::piece::{Handle, NUM_LINES, Piece};
use crate::tool::Twist;

/// Of the distance to what is looked at, what is flown in a second.
const FLY_SHARE: f64 = 0.8;
/// The slowest flight, metres a second.
const MIN_FLY_M: f64 = 2.0;
/// How long a hand rests before an airbrush is told, seconds.
const REST_S: f64 = 1.0 / 30.0;
/// Points of the wheel that are a step.
const WHEEL_STEP: f32 = 50.0;
/// How near to a handle the pointer takes hold of it, in points.
const HANDLE_REACH: f32 = 12.0;
/// How far above its middle the handle that lifts it is, in halves of its width.
const LIFT_AT: f64 = 0.5;
/// Points on the screen that the pointer moves at least from one corner of a lasso to the next.
const LASSO_STEP: f32 = 4.0;
/// Degrees of the sun for each point that the pointer moves.
const SUN_TURN: f32 = 0.4;

/// What a hand is doing over the ground.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
enum Grip {
    /// Nothing.
    #[default]
    None,
    /// Drawing with the brush.
    Drawing,
    /// Drawing a line around what is to be selected.
    Outlining(SelectCombine),
    /// Drawing out the tape.
    Measuring,
    /// Holding the floating piece.
    Placing(Handle),
    /// Looking around, and flying.
    Looking,
    /// Dragging the ground that was picked.
    Dragging(DVec3),
    /// Going around a place.
    Orbiting(DVec3),
    /// Moving the sun.
    Sunning,
}

/// The viewport's own state.
#[derive(Debug, Default)]
pub struct Viewport {
    grip: Grip,
    /// What the left button does.
    pub hand: Hand,
    /// Where the outline that is being drawn goes, `[x, z]` in metres; of a rectangle, two corners.
    path_m: Vec<[f64; 2]>,
    /// Where its last corner lies on the screen.
    path_end: Pos2,
    /// What is measured between, `[x, z]` in metres.
    pub tape_m: Option<[[f64; 2]; 2]>,
    /// What floats over the ground.
    pub piece: Option<Piece>,
    /// The ground under the pointer, metres.
    pub hovered: Option<DVec3>,
    /// The last ground that was met, for where there is none.
    last: Option<DVec3>,
    /// When the stroke began, by the clock of the window, seconds.
    stroke_start_s: f64,
    /// When its last point was given.
    last_point_s: f64,
    /// Whether the brush goes on where it rests.
    pub is_airbrush: bool,
    /// How hard the pen is pressed, where it tells.
    pressure: Option<f32>,
    /// How large the picture is, in points.
    pub size: Vec2,
}

/// What the viewport asks of the editor.
#[derive(Debug, Clone, PartialEq)]
pub enum Wish {
    /// Begin a stroke.
    Begin(Twist),
    /// Points of it.
    Points(Vec<Point>),
    /// End it.
    Lift,
    /// Select what is outlined.
    Select {
        /// Corners of the outline, `[x, z]` in metres; of a rectangle, two opposite ones.
        path_m: Vec<[f64; 2]>,
        /// How it joins what was selected before.
        combine: SelectCombine,
    },
}

/// A point of a stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Where, metres.
    pub place_m: [f64; 2],
    /// How hard a pen is pressed, 0..1; 1 for a mouse.
    pub pressure: f32,
    /// Seconds since the stroke began.
    pub time_s: f64,
}

/// A pointer's place in the picture, in pixels.
struct Sight {
    camera: Camera,
    rect: Rect,
    size_px: [u32; 2],
}

impl Sight {
    fn direction(&self, at: Pos2) -> DVec3 {
        let share = (at - self.rect.min) / self.rect.size();
        let [width, height] = self.size_px.map(f64::from);
        self.camera.direction_of_pixel([f64::from(share.x) * width, f64::from(share.y) * height])
    }
}

impl Viewport {
    /// Whether a hand is at work, so that the next frame is wanted soon.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.grip != Grip::None
    }

    /// Gives up what the hand was doing.
    pub fn let_go(&mut self) {
        self.grip = Grip::None;
    }

    /// Takes what mouse and keys do in the pane that is worked in, over a room. Gives what is wished.
    pub fn show(
        &mut self,
        ui: &Ui,
        response: &Response,
        document: &mut Document,
        request: &mut ViewRequest,
    ) -> Vec<Wish> {
        response.widget_info(|| {
            egui::WidgetInfo::labeled(
                egui::Role::Image,
                true,
                "The terrain: draw on it with the left mouse button",
            )
        });
        let rect = response.rect;
        self.size = rect.size();
        let size_px = size_px(self.size, ui.ctx().pixels_per_point());
        let sight = Sight { camera: document.pane.camera.camera(size_px), rect, size_px };
        let wishes = self.handle(ui, response, &sight, document, request);
        self.fly(ui, response, document);
        wishes
    }

    /// Takes where the pointer is over the ground in the other pane: there too it is seen what a press would do.
    pub fn hover(&mut self, ui: &Ui, response: &Response, pane: &Pane) {
        let told = "The terrain from elsewhere: a press works on it here";
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, told));
        if self.grip != Grip::None || !response.contains_pointer() {
            return;
        }
        let Some(at) = ui.input(|input| input.pointer.latest_pos()) else { return };
        let (rect, size_px) = (response.rect, size_px(response.rect.size(), ui.ctx().pixels_per_point()));
        let sight = Sight { camera: pane.camera.camera(size_px), rect, size_px };
        self.hovered = pane.view.pick(sight.camera.eye_m(), sight.direction(at));
    }

    fn handle(
        &mut self,
        ui: &Ui,
        response: &Response,
        sight: &Sight,
        document: &mut Document,
        request: &mut ViewRequest,
    ) -> Vec<Wish> {
        let mut wishes = Vec::new();
        let (events, now_s) = ui.input(|input| (input.events.clone(), input.time));
        let is_over = response.contains_pointer() || self.grip != Grip::None;
        let mut at = ui.input(|input| input.pointer.latest_pos());
        let mut points = Vec::new();
        for event in events {
            match event {
                Event::PointerMoved(to) => {
                    let by = at.map_or(Vec2::ZERO, |at| to - at);
                    at = Some(to);
                    self.moved(ui, to, by, sight, document, request);
                    match self.grip {
                        Grip::Drawing => points.extend(self.point(to, now_s, sight, document)),
                        Grip::Outlining(_) | Grip::Measuring => self.outline(to, sight, document),
                        Grip::Placing(handle) => self.place(handle, to, by, sight, document),
                        _ => {}
                    }
                }
                Event::Touch { phase, force, .. } => {
                    let is_over = matches!(phase, egui::TouchPhase::End | egui::TouchPhase::Cancel);
                    self.pressure = force.filter(|_| !is_over);
                }
                Event::PointerButton { pos, button, pressed: true, modifiers }
                    if is_over && self.grip == Grip::None =>
                {
                    let Some(place) = self.meet(pos, sight, document) else { continue };
                    self.grip = match button {
                        PointerButton::Primary if modifiers.alt => Grip::Orbiting(place),
                        PointerButton::Primary if ui.input(|input| input.key_down(Key::L)) => Grip::Sunning,
                        // While something floats, nothing else is done by hand.
                        PointerButton::Primary if self.piece.is_some() => {
                            self.handle_at(pos, place, sight, document).map_or(Grip::None, Grip::Placing)
                        }
                        PointerButton::Primary if self.hand != Hand::Brush => {
                            let place_m = [place.x, place.z];
                            (self.path_m, self.path_end) = (vec![place_m], pos);
                            if self.hand == Hand::Tape {
                                self.tape_m = Some([place_m; 2]);
                                Grip::Measuring
                            } else {
                                Grip::Outlining(combine_of(modifiers))
                            }
                        }
                        PointerButton::Primary => {
                            wishes.push(Wish::Begin(match modifiers {
                                _ if modifiers.shift => Twist::Smooth,
                                _ if modifiers.command => Twist::Inverted,
                                _ => Twist::None,
                            }));
                            self.stroke_start_s = now_s;
                            document.pane.view.hold_still(true);
                            points.extend(self.point(pos, now_s, sight, document));
                            Grip::Drawing
                        }
                        PointerButton::Secondary => Grip::Looking,
                        PointerButton::Middle => Grip::Dragging(place),
                        PointerButton::Extra1 | PointerButton::Extra2 => Grip::None,
                    };
                }
                Event::PointerButton { button, pressed: false, .. } => {
                    let is_mine = match self.grip {
                        Grip::Drawing
                        | Grip::Outlining(_)
                        | Grip::Measuring
                        | Grip::Placing(_)
                        | Grip::Orbiting(_)
                        | Grip::Sunning => button == PointerButton::Primary,
                        Grip::Looking => button == PointerButton::Secondary,
                        Grip::Dragging(_) => button == PointerButton::Middle,
                        Grip::None => false,
                    };
                    if is_mine && self.grip == Grip::Drawing {
                        if points.is_empty() {
                            points.extend(self.rest(at, now_s, 0.0, sight, document));
                        }
                        wishes
                            .extend((!points.is_empty()).then(|| Wish::Points(std::mem::take(&mut points))));
                        wishes.push(Wish::Lift);
                    }
                    if let (true, Grip::Outlining(combine)) = (is_mine, self.grip) {
                        wishes.push(Wish::Select { path_m: std::mem::take(&mut self.path_m), combine });
                    }
                    if is_mine {
                        self.grip = Grip::None;
                    }
                }
                Event::MouseWheel { delta, unit, .. } if response.contains_pointer() => {
                    let steps = match unit {
                        egui::MouseWheelUnit::Point => delta.y / WHEEL_STEP,
                        egui::MouseWheelUnit::Line | egui::MouseWheelUnit::Page => delta.y,
                    };
                    let place = at.and_then(|at| self.meet(at, sight, document));
                    if let Some(place) = place {
                        document.pane.camera.dolly(place, f64::from(steps));
                    }
                }
                _ => {}
            }
        }
        if self.grip == Grip::Drawing && points.is_empty() {
            points.extend(self.rest(at, now_s, REST_S, sight, document));
        }
        if !points.is_empty() {
            self.last_point_s = now_s;
            wishes.push(Wish::Points(points));
        }
        self.hovered = at
            .filter(|_| is_over && self.grip != Grip::Looking)
            .and_then(|at| document.pane.view.pick(sight.camera.eye_m(), sight.direction(at)));
        self.last = self.hovered.or(self.last);
        wishes
    }

    fn moved(
        &self,
        ui: &Ui,
        to: Pos2,
        by: Vec2,
        sight: &Sight,
        document: &mut Document,
        request: &mut ViewRequest,
    ) {
        match self.grip {
            Grip::Looking => document.pane.camera.look([by.x, by.y]),
            Grip::Orbiting(place) => document.pane.camera.orbit(place, [by.x, by.y]),
            Grip::Dragging(place) => document.pane.camera.drag(place, sight.direction(to)),
            Grip::Sunning => {
                let azimuth = request.sun_azimuth_degrees + f64::from(by.x * SUN_TURN);
                request.sun_azimuth_degrees = azimuth.rem_euclid(360.0);
                let altitude = request.sun_altitude_degrees - f64::from(by.y * SUN_TURN);
                request.sun_altitude_degrees = altitude.clamp(-5.0, 90.0);
            }
            Grip::None | Grip::Drawing | Grip::Outlining(_) | Grip::Measuring | Grip::Placing(_) => return,
        }
        ui.ctx().request_repaint();
    }

    /// Takes an outline or a tape along.
    fn outline(&mut self, to: Pos2, sight: &Sight, document: &Document) {
        let Some(place) = self.meet(to, sight, document) else { return };
        let place_m = [place.x, place.z];
        match (self.hand, &mut self.tape_m) {
            (Hand::Tape, Some([_, end_m])) => *end_m = place_m,
            (Hand::Lasso, _) if (to - self.path_end).length() >= LASSO_STEP => {
                self.path_m.push(place_m);
                self.path_end = to;
            }
            (Hand::Rectangle, _) => {
                self.path_m.truncate(1);
                self.path_m.push(place_m);
            }
            _ => {}
        }
    }

    /// What of the floating piece is at a point of the window that meets the ground at a place.
    fn handle_at(&self, at: Pos2, place: DVec3, sight: &Sight, document: &Document) -> Option<Handle> {
        let piece = self.piece.as_ref()?;
        let sketch = Sketch::new(sight.camera, sight.rect);
        let is_at =
            |place: DVec3| sketch.seen_at(place).is_some_and(|seen| (seen - at).length() <= HANDLE_REACH);
        let view = &document.pane.view;
        if is_at(lift_place(piece)) {
            return Some(Handle::Lift);
        }
        if is_at(place_on_ground(view, piece.turn_m())) {
            return Some(Handle::Turn);
        }
        if piece.corners_m().into_iter().any(|corner_m| is_at(place_on_ground(view, corner_m))) {
            return Some(Handle::Corner);
        }
        let place_m = [place.x, place.z];
        let from_middle_m = [place_m[0] - piece.to_m[0], place_m[1] - piece.to_m[1]];
        piece.contains(place_m).then_some(Handle::Inside(from_middle_m))
    }

    /// Takes the floating piece along.
    fn place(&mut self, handle: Handle, to: Pos2, by: Vec2, sight: &Sight, document: &Document) {
        let place = self.meet(to, sight, document);
        let Some(piece) = &mut self.piece else { return };
        if handle == Handle::Lift {
            // As far as the pointer goes where the handle is.
            let away = (lift_place(piece) - sight.camera.eye_m()).length();
            let [_, half_height] = sight.camera.half_extent();
            let metres_a_point = 2.0 * half_height * away / f64::from(sight.rect.height().max(1.0));
            piece.offset_m -= f64::from(by.y) * metres_a_point;
        } else if let Some(place) = place {
            piece.drag(handle, [place.x, place.z]);
        }
    }

    /// Draws over the picture what hands have drawn out.
    pub fn sketch(&self, ui: &Ui, rect: Rect, camera: Camera, document: &Document) {
        let painter = ui.painter().with_clip_rect(rect);
        let sketch = Sketch::new(camera, rect);
        let view = &document.pane.view;
        match (self.grip, self.hand, self.path_m.as_slice()) {
            (Grip::Outlining(_), Hand::Rectangle, [from_m, to_m]) => {
                sketch.line(&painter, on_ground(view, &corners_m(*from_m, *to_m), true));
            }
            (Grip::Outlining(_), Hand::Lasso, path_m) => {
                let corner = |[x, z]: &[f64; 2]| DVec3::new(*x, f64::from(view.ground([*x, *z]).0), *z);
                sketch.line(&painter, path_m.iter().chain(path_m.first()).map(corner));
            }
            _ => {}
        }
        if let Some(piece) = &self.piece {
            sketch_piece(piece, &sketch, &painter, document);
        }
        if let Some(tape_m) = &self.tape_m {
            let places = on_ground(view, tape_m, false);
            [places.first(), places.last()]
                .into_iter()
                .flatten()
                .for_each(|end| sketch.handle(&painter, *end));
            sketch.line(&painter, places);
        }
    }

    /// Where a stroke goes under the pointer: the ground, or the height of the last ground where there is none.
    fn point(&self, at: Pos2, now_s: f64, sight: &Sight, document: &Document) -> Option<Point> {
        let place = self.meet(at, sight, document)?;
        Some(Point {
            place_m: [place.x, place.z],
            pressure: self.pressure.unwrap_or(1.0).clamp(0.0, 1.0),
            time_s: now_s - self.stroke_start_s,
        })
    }

    /// What a hand that rests adds to a stroke: where the brush goes on by itself, where it is, once it has been there for so long.
    fn rest(
        &self,
        at: Option<Pos2>,
        now_s: f64,
        for_s: f64,
        sight: &Sight,
        document: &Document,
    ) -> Option<Point> {
        let has_rested = self.is_airbrush && now_s - self.last_point_s > for_s;
        self.point(at.filter(|_| has_rested)?, now_s, sight, document)
    }

    fn meet(&self, at: Pos2, sight: &Sight, document: &Document) -> Option<DVec3> {
        let (eye, direction) = (sight.camera.eye_m(), sight.direction(at));
        document.pane.view.pick(eye, direction).or_else(|| {
            let [low_m, high_m] = document.pane.view.range_m().map(f64::from);
            let height_m = self.last.map_or(f64::midpoint(low_m, high_m), |last| last.y);
            let distance = (height_m - eye.y) / direction.y;
            // Towards the sky, and further off than one can point, there is nothing.
            (distance.is_finite() && distance > 0.0 && distance < 1.0e8).then(|| eye + direction * distance)
        })
    }

    fn fly(&self, ui: &Ui, response: &Response, document: &mut Document) {
        if self.grip != Grip::Looking || !(response.contains_pointer() || response.dragged()) {
            return;
        }
        let (held, dt_s, is_fast) = ui.input(|input| {
            let axis =
                |plus, minus| f64::from(i8::from(input.key_down(plus)) - i8::from(input.key_down(minus)));
            let held = [axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S)];
            (held, f64::from(input.stable_dt.min(0.1)), input.modifiers.shift)
        });
        if held == [0.0; 3] {
            return;
        }
        let away = self.last.map_or(100.0, |last| (last - document.pane.camera.eye()).length());
        let speed = (FLY_SHARE * away).max(MIN_FLY_M) * if is_fast { 4.0 } else { 1.0 } * dt_s;
        document.pane.camera.fly(held.map(|along| along * speed));
        ui.ctx().request_repaint();
    }

    /// The brush's ring, and those of its copies; `stroke` is one of the brush, without points.
    #[must_use]
    pub fn cursors(&self, stroke: &BrushOperation, document: &Document) -> Vec<Cursor> {
        let is_drawing = self.hand == Hand::Brush && self.piece.is_none();
        let Some(place) = self.hovered.filter(|_| is_drawing) else { return Vec::new() };
        let brush = stroke.brush();
        let (radius_m, plateau) = (brush.radius_m, 1.0 - brush.profile().falloff_ratio);
        let ring = |centre_m| Cursor { centre_m, radius_m: radius_m as f32, hardness: plateau as f32 };
        stroke.copies_m(&document.status.grid, [place.x, place.z]).into_iter().map(ring).collect()
    }
}

/// Where the handle is that lifts a piece.
fn lift_place(piece: &Piece) -> DVec3 {
    let [.., width_m, _] = piece.region_m;
    piece_place(piece, [NUM_LINES / 2; 2]) + DVec3::Y * (LIFT_AT * width_m * piece.scale)
}

/// Where lines of a piece cross where it floats: as high as it was copied, and lifted.
fn piece_place(piece: &Piece, crossing: [u32; 2]) -> DVec3 {
    let share = crossing.map(|line| 2.0 * f64::from(line) / f64::from(NUM_LINES) - 1.0);
    let (_, [x_m, z_m]) = piece.place_m(share);
    DVec3::new(x_m, f64::from(piece.net_m(crossing)) + piece.offset_m, z_m)
}

/// Draws a piece as a net where it floats, its edge on the ground, and its handles.
fn sketch_piece(piece: &Piece, sketch: &Sketch, painter: &egui::Painter, document: &Document) {
    let view = &document.pane.view;
    for line in 0..=NUM_LINES {
        sketch.fine_line(painter, (0..=NUM_LINES).map(|step| piece_place(piece, [step, line])));
        sketch.fine_line(painter, (0..=NUM_LINES).map(|step| piece_place(piece, [line, step])));
    }
    let corners_m = piece.corners_m();
    sketch.line(painter, on_ground(view, &corners_m, true));
    for corner_m in corners_m.into_iter().chain([piece.turn_m()]) {
        sketch.handle(painter, place_on_ground(view, corner_m));
    }
    sketch.handle(painter, lift_place(piece));
}
