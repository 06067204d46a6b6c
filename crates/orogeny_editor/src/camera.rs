//! The camera as a hand moves it: looking, flying, orbiting, dragging the ground, coming nearer.

use glam::DVec3;
use orogeny_engine::Camera;

/// The steepest look up and down, radians: short of straight, so that there is always a direction ahead.
const MAX_PITCH: f64 = 1.553;
/// Vertical field of view, radians.
const FOV: f64 = 0.785;
/// Radians for each point that the pointer moves.
const TURN: f64 = 0.004;
/// The share of the way to the picked point that a step of the wheel goes.
const DOLLY: f64 = 0.12;
/// Nearer than this no step of the wheel comes, metres.
const MIN_DISTANCE_M: f64 = 0.5;

/// Where the eye is and where it looks.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CameraControl {
    /// The eye: metres to the east, up, to the south.
    pub eye_m: [f64; 3],
    /// Radians clockwise from north.
    pub heading: f64,
    /// Radians above the horizon.
    pub pitch: f64,
}

impl CameraControl {
    /// So far off that all of a box is seen, from the south-west and above, as terrains are drawn.
    #[must_use]
    pub fn framing(low_m: DVec3, high_m: DVec3, [width, height]: [f32; 2]) -> Self {
        let middle = (low_m + high_m) / 2.0;
        let radius_m = ((high_m - low_m).length() / 2.0).max(1.0);
        let aspect = f64::from(width.max(1.0)) / f64::from(height.max(1.0));
        let half = (FOV / 2.0).tan() * aspect.min(1.0);
        let away = DVec3::new(-0.45, 0.62, 0.89).normalize();
        Self::from_to(middle + away * (0.8 * radius_m / half.atan().sin()), middle)
    }

    /// At a place, looking at another.
    #[must_use]
    pub fn from_to(eye: DVec3, target: DVec3) -> Self {
        let ahead = (target - eye).normalize_or(DVec3::NEG_Z);
        let control = Self { eye_m: eye.to_array(), heading: ahead.x.atan2(-ahead.z), pitch: ahead.y.asin() };
        Self { pitch: control.pitch.clamp(-MAX_PITCH, MAX_PITCH), ..control }
    }

    /// At a place, looking straight down; north is up.
    #[must_use]
    pub const fn looking_down(eye: DVec3) -> Self {
        Self { eye_m: eye.to_array(), heading: 0.0, pitch: -MAX_PITCH }
    }

    /// The eye.
    #[must_use]
    pub const fn eye(&self) -> DVec3 {
        DVec3::from_array(self.eye_m)
    }

    /// The direction of sight.
    #[must_use]
    pub fn ahead(&self) -> DVec3 {
        let (sin, cos) = self.heading.sin_cos();
        DVec3::new(sin * self.pitch.cos(), self.pitch.sin(), -cos * self.pitch.cos())
    }

    /// For a picture of so many pixels.
    #[must_use]
    pub fn camera(&self, size_px: [u32; 2]) -> Camera {
        Camera::looking_at(self.eye(), self.eye() + self.ahead(), FOV, size_px)
    }

    /// Looks elsewhere, from the same place: by points on the screen.
    pub fn look(&mut self, [x, y]: [f32; 2]) {
        self.heading += f64::from(x) * TURN;
        self.pitch = (self.pitch - f64::from(y) * TURN).clamp(-MAX_PITCH, MAX_PITCH);
    }

    /// Goes around a place that stays where it is in the picture.
    pub fn orbit(&mut self, around: DVec3, by: [f32; 2]) {
        let before = *self;
        self.look(by);
        // What lay before the old sight lies before the new one.
        let offset = around - before.eye();
        let (right, up, ahead) = before.axes();
        let [x, y, z] = [right, up, ahead].map(|axis| axis.dot(offset));
        let (right, up, ahead) = self.axes();
        self.eye_m = (around - (right * x + up * y + ahead * z)).to_array();
    }

    /// Moves so that a place that was picked comes to lie in a direction, at its height: the ground under the pointer goes along with it.
    pub fn drag(&mut self, picked: DVec3, direction: DVec3) {
        let fall = picked.y - self.eye().y;
        // Towards the horizon or above, the ground does not go along.
        if fall * direction.y <= 0.0 || direction.y.abs() < 0.02 {
            return;
        }
        let below = self.eye() + direction * (fall / direction.y);
        let shift = picked - below;
        self.eye_m = (self.eye() + DVec3::new(shift.x, 0.0, shift.z)).to_array();
    }

    /// Comes nearer to a place that was picked, or goes away from it: by steps of the wheel.
    pub fn dolly(&mut self, picked: DVec3, steps: f64) {
        let way = picked - self.eye();
        let share = 1.0 - (1.0 - DOLLY).powf(steps);
        let distance = way.length();
        let share = share.min(1.0 - MIN_DISTANCE_M.min(distance) / distance.max(1.0e-9));
        self.eye_m = (self.eye() + way * share).to_array();
    }

    /// Flies: right, up and ahead, metres.
    pub fn fly(&mut self, [right_m, up_m, ahead_m]: [f64; 3]) {
        let (right, _, ahead) = self.axes();
        self.eye_m = (self.eye() + right * right_m + DVec3::Y * up_m + ahead * ahead_m).to_array();
    }

    /// Right, up and ahead, each of length 1.
    fn axes(&self) -> (DVec3, DVec3, DVec3) {
        let ahead = self.ahead();
        let right = ahead.cross(DVec3::Y).normalize_or(DVec3::X);
        (right, right.cross(ahead), ahead)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [800, 600];

    fn camera() -> CameraControl {
        CameraControl::from_to(DVec3::new(100.0, 80.0, 300.0), DVec3::new(180.0, 10.0, 120.0))
    }

    /// The pixel that a place is drawn at.
    fn pixel(control: &CameraControl, place: DVec3) -> [f64; 2] {
        let clip = control.camera(SIZE).clip_from_relative() * (place - control.eye()).as_vec3().extend(1.0);
        [f64::from(clip.x / clip.w), f64::from(clip.y / clip.w)]
    }

    #[test]
    fn it_looks_at_its_target() {
        let control = camera();
        let [x, y] = pixel(&control, DVec3::new(180.0, 10.0, 120.0));
        assert!(x.abs() < 1.0e-4 && y.abs() < 1.0e-4, "{x} {y}");
    }

    #[test]
    fn what_is_orbited_stays_in_its_place() {
        let mut control = camera();
        let around = DVec3::new(150.0, 12.0, 160.0);
        let (before, distance) = (pixel(&control, around), (around - control.eye()).length());
        control.orbit(around, [70.0, -30.0]);
        let after = pixel(&control, around);
        assert!((before[0] - after[0]).abs() < 1.0e-3 && (before[1] - after[1]).abs() < 1.0e-3);
        assert!(((around - control.eye()).length() - distance).abs() < 1.0e-6);
    }

    #[test]
    fn the_dragged_ground_stays_under_the_pointer() {
        let mut control = camera();
        let picked = DVec3::new(150.0, 12.0, 160.0);
        let direction = control.camera(SIZE).direction_of_pixel([300.0, 420.0]);
        control.drag(picked, direction);
        let found = control.eye() + direction * ((picked.y - control.eye().y) / direction.y);
        assert!((found - picked).length() < 1.0e-9, "{found}");
        assert_eq!(control.eye().y, camera().eye().y);
        // Towards the sky nothing happens.
        let before = control;
        control.drag(picked, DVec3::new(0.0, 0.5, -0.8));
        assert_eq!(control, before);
    }

    #[test]
    fn the_wheel_comes_nearer_and_goes_back_and_never_through() {
        let mut control = camera();
        let picked = DVec3::new(150.0, 12.0, 160.0);
        control.dolly(picked, 3.0);
        let near = (picked - control.eye()).length();
        assert!(near < (picked - camera().eye()).length());
        control.dolly(picked, -3.0);
        assert!((control.eye() - camera().eye()).length() < 1.0e-6);
        control.dolly(picked, 500.0);
        assert!(((picked - control.eye()).length() - MIN_DISTANCE_M).abs() < 1.0e-6);
    }

    #[test]
    fn it_never_turns_over() {
        let mut control = camera();
        for _ in 0..200 {
            control.look([3.0, 50.0]);
        }
        assert!(control.pitch >= -MAX_PITCH && control.ahead().is_finite());
    }
}
