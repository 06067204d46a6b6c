//! Lines over the picture of the ground, that lie on the ground.

use egui::{Color32, Painter, Pos2, Rect, Stroke};
use glam::DVec3;
use orogeny_engine::{Camera, LiveView};

/// Pieces that a straight line is bent into, to lie on the ground.
const PIECES: u32 = 32;
/// What a line is drawn with, over what is around it.
const LINE: Stroke = Stroke { width: 2.0, color: Color32::from_rgb(255, 220, 90) };
const AROUND: Stroke = Stroke { width: 4.0, color: Color32::from_black_alpha(150) };

/// Where the ground is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Sketch {
    camera: Camera,
    rect: Rect,
}

impl Sketch {
    /// For what a camera sees, shown in a rectangle of the window.
    #[must_use]
    pub const fn new(camera: Camera, rect: Rect) -> Self {
        Self { camera, rect }
    }

    /// Where a place is seen; `None` behind the eye.
    #[must_use]
    pub fn seen_at(&self, place: DVec3) -> Option<Pos2> {
        let relative = (place - self.camera.eye_m()).as_vec3();
        let clip = self.camera.clip_from_relative() * relative.extend(1.0);
        let (x, y) = (clip.x / clip.w, clip.y / clip.w);
        let share = [0.5 + 0.5 * x, 0.5 - 0.5 * y];
        let at = self.rect.min + self.rect.size() * egui::vec2(share[0], share[1]);
        // What lies nearly beside the eye would be seen infinitely far away.
        (clip.w > 0.0 && at.to_vec2().length() < 1.0e5).then_some(at)
    }

    /// Draws lines between places, one after another; where one of them is not seen, the line has a gap.
    pub fn line(&self, painter: &Painter, places: impl IntoIterator<Item = DVec3>) {
        let mut runs = vec![Vec::new()];
        for place in places {
            match (self.seen_at(place), runs.last_mut()) {
                (Some(at), Some(run)) => run.push(at),
                _ => runs.push(Vec::new()),
            }
        }
        for run in runs.into_iter().filter(|run| run.len() > 1) {
            painter.line(run.clone(), AROUND);
            painter.line(run, LINE);
        }
    }

    /// The same, so fine that many of them can be told apart.
    pub fn fine_line(&self, painter: &Painter, places: impl IntoIterator<Item = DVec3>) {
        let seen: Option<Vec<_>> = places.into_iter().map(|place| self.seen_at(place)).collect();
        if let Some(seen) = seen {
            painter.line(seen, Stroke::new(1.0, Color32::from_rgb(255, 150, 60)));
        }
    }

    /// A point that can be taken hold of.
    pub fn handle(&self, painter: &Painter, place: DVec3) {
        if let Some(at) = self.seen_at(place) {
            painter.circle(at, 5.0, LINE.color, AROUND);
        }
    }
}

/// Places on the ground along straight lines between corners.
pub fn on_ground(view: &LiveView, corners_m: &[[f64; 2]], is_closed: bool) -> Vec<DVec3> {
    let num = if is_closed { corners_m.len() } else { corners_m.len().saturating_sub(1) };
    let next = corners_m.iter().cycle().skip(1);
    let mut places = Vec::new();
    for ([x0, z0], [x1, z1]) in corners_m.iter().zip(next).take(num) {
        for piece in 0..=PIECES {
            let share = f64::from(piece) / f64::from(PIECES);
            places.push(place_on_ground(view, [x0 + share * (x1 - x0), z0 + share * (z1 - z0)]));
        }
    }
    places
}

/// A place on the ground.
pub fn place_on_ground(view: &LiveView, [x_m, z_m]: [f64; 2]) -> DVec3 {
    let (height_m, _) = view.ground([x_m, z_m]);
    DVec3::new(x_m, f64::from(height_m), z_m)
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;
    use crate::CameraControl;

    #[test]
    fn a_place_is_seen_where_the_pointer_would_meet_it() {
        let control = CameraControl::from_to(DVec3::new(100.0, 80.0, 300.0), DVec3::new(180.0, 10.0, 120.0));
        let rect = Rect::from_min_size(pos2(200.0, 50.0), egui::vec2(800.0, 600.0));
        let camera = control.camera([400, 300]);
        let sketch = Sketch::new(camera, rect);
        let place = camera.eye_m() + camera.direction_of_pixel([100.0, 200.0]) * 70.0;
        let at = sketch.seen_at(place).unwrap();
        assert!((at - pos2(400.0, 450.0)).length() < 0.01, "{at:?}");
        assert_eq!(sketch.seen_at(camera.eye_m() - control.ahead() * 10.0), None);
    }
}
