//! A camera that looks at a terrain from a place in 64 bits.
//!
//! What is drawn is drawn relative to the eye, so that a metre is a metre 10^6 m from the origin too; depth is reversed (1 at the near plane, 0
//! infinitely far), which keeps the precision of 32-bit floats even over all distances.

use glam::{DMat3, DVec3, Mat4, Vec4};

/// The nearest near plane, metres: reversed depth needs none further out.
pub const MIN_NEAR_M: f64 = 0.05;

const MIN_FOV_RADIANS: f64 = 0.001;
const MAX_FOV_RADIANS: f64 = 3.0;

/// Looking straight down or up there is no horizontal direction left: north is then up in the picture.
const MIN_HORIZONTAL: f64 = 1.0e-9;

/// Where from, where to, and onto how many pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    eye_m: DVec3,
    /// Columns: right, up, backward.
    world_from_view: DMat3,
    half_height: f64,
    viewport: [u32; 2],
}

impl Camera {
    /// At `eye_m`, looking at `target_m` (towards the north where they are one), upright, with a vertical field of view (0.001 to 3 radians; beyond
    /// these it is the nearer of them), onto a picture of at least one pixel. Places are finite.
    #[must_use]
    pub fn looking_at(eye_m: DVec3, target_m: DVec3, fov_y_radians: f64, [width, height]: [u32; 2]) -> Self {
        let forward = (target_m - eye_m).try_normalize().unwrap_or(DVec3::NEG_Z);
        let horizontal = forward.cross(DVec3::Y);
        let right = if horizontal.length() > MIN_HORIZONTAL {
            horizontal.normalize()
        } else {
            DVec3::X * -forward.y.signum()
        };
        let up = right.cross(forward);
        Self {
            eye_m,
            world_from_view: DMat3::from_cols(right, up, -forward),
            half_height: (fov_y_radians.clamp(MIN_FOV_RADIANS, MAX_FOV_RADIANS) / 2.0).tan(),
            viewport: [width.max(1), height.max(1)],
        }
    }

    /// Where it is, metres.
    #[must_use]
    pub const fn eye_m(&self) -> DVec3 {
        self.eye_m
    }

    /// Right, up and backward, each of length 1.
    #[must_use]
    pub const fn axes(&self) -> [DVec3; 3] {
        [self.world_from_view.x_axis, self.world_from_view.y_axis, self.world_from_view.z_axis]
    }

    /// Half the width and half the height of the picture one metre before the eye, metres.
    #[must_use]
    pub fn half_extent(&self) -> [f64; 2] {
        let [width, height] = self.viewport.map(f64::from);
        [self.half_height * width / height, self.half_height]
    }

    /// How many pixels a metre across the line of sight is high, one metre before the eye.
    #[must_use]
    pub fn pixels_at_one_metre(&self) -> f64 {
        f64::from(self.viewport[1]) / (2.0 * self.half_height)
    }

    /// A place in the axes of the picture: right, up, backward, metres from the eye.
    #[must_use]
    pub fn view_from_world(&self, place_m: DVec3) -> DVec3 {
        self.world_from_view.transpose() * (place_m - self.eye_m)
    }

    /// Clip space of reversed depth from metres relative to the eye, in the world's axes.
    #[must_use]
    pub fn clip_from_relative(&self) -> Mat4 {
        let [half_width, half_height] = self.half_extent();
        let projection = Mat4::from_cols(
            Vec4::new((1.0 / half_width) as f32, 0.0, 0.0, 0.0),
            Vec4::new(0.0, (1.0 / half_height) as f32, 0.0, 0.0),
            Vec4::new(0.0, 0.0, 0.0, -1.0),
            Vec4::new(0.0, 0.0, MIN_NEAR_M as f32, 0.0),
        );
        projection * Mat4::from_mat3(self.world_from_view.transpose().as_mat3())
    }

    /// The direction, of length 1, in which a point of the picture lies; `(0, 0)` is the upper left corner of the upper left
    /// pixel.
    #[must_use]
    pub fn direction_of_pixel(&self, [x, y]: [f64; 2]) -> DVec3 {
        let [half_width, half_height] = self.half_extent();
        let [width, height] = self.viewport.map(f64::from);
        let view =
            DVec3::new((2.0 * x / width - 1.0) * half_width, (1.0 - 2.0 * y / height) * half_height, -1.0);
        (self.world_from_view * view).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place() -> impl Strategy<Value = DVec3> {
        (-1.0e6..1.0e6_f64, -5.0e3..9.0e3_f64, -1.0e6..1.0e6_f64).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn a_pixel_s_direction_is_drawn_onto_that_pixel(
            eye in place(), target in place(), x in 0.0..640.0_f64, y in 0.0..480.0_f64, distance in 1.0..1.0e5_f64,
        ) {
            let camera = Camera::looking_at(eye, target, 1.0, [640, 480]);
            let relative = camera.direction_of_pixel([x, y]) * distance;
            let clip = camera.clip_from_relative() * relative.as_vec3().extend(1.0);
            let drawn = [(clip.x / clip.w + 1.0) * 320.0, (1.0 - clip.y / clip.w) * 240.0];
            prop_assert!((f64::from(drawn[0]) - x).abs() < 0.01 && (f64::from(drawn[1]) - y).abs() < 0.01, "{drawn:?}");
            let depth = clip.z / clip.w;
            prop_assert!(depth > 0.0 && depth <= 1.0, "{depth}");
        }
    }

    #[test]
    fn straight_down_and_straight_up_north_is_up() {
        let camera =
            Camera::looking_at(DVec3::new(5.0, 100.0, 7.0), DVec3::new(5.0, 0.0, 7.0), 1.0, [100, 100]);
        let north = camera.view_from_world(DVec3::new(5.0, 0.0, 6.0));
        assert!(north.y > 0.99 && north.x.abs() < 1.0e-9, "{north}");
        let east = camera.view_from_world(DVec3::new(6.0, 0.0, 7.0));
        assert!(east.x > 0.99 && east.y.abs() < 1.0e-9, "{east}");
        let camera = Camera::looking_at(DVec3::ZERO, DVec3::Y, 1.0, [100, 100]);
        let north = camera.view_from_world(DVec3::new(0.0, 100.0, -1.0));
        assert!(north.y > 0.99, "{north}");
    }
}
