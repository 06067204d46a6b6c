//! Where the shadow maps lie: around slices of what the camera sees, each further slice with coarser texels.
//!
//! A map covers a ball around its slice, so that its size is the same however the camera turns, and is moved by whole texels only: edges of
//! shadows stay where they are while the camera moves.

use glam::{DMat3, DVec3, Mat4, Vec4};

use crate::{Bounds, Camera};

/// Shadow maps at most.
pub const MAX_CASCADES: usize = 4;

/// How many times as far as its sides a square's corners are.
const CORNER: f64 = std::f64::consts::SQRT_2 * 1.0001;

/// Lower suns throw shadows as if they stood this high, as a sine.
const MIN_SUN_HEIGHT: f64 = 0.01;

/// What a shadow map holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cascade {
    /// Its clip space from metres relative to the eye: depth 0 towards the sun, 1 away from it.
    pub clip_from_relative: Mat4,
    /// How wide a texel is, metres.
    pub texel_m: f64,
    /// Its middle relative to the eye, and what it holds around that across the sun's direction, metres.
    pub centre_relative_m: DVec3,
    /// Half its width, metres.
    pub radius_m: f64,
}

/// The maps for what a camera sees from a nearest to a furthest distance, metres, of ground within `ground`, `texels` a side each.
#[must_use]
pub fn cascades(
    camera: &Camera,
    to_sun: DVec3,
    [nearest_m, furthest_m]: [f64; 2],
    ground: &Bounds,
    texels: u32,
) -> [Cascade; MAX_CASCADES] {
    // Steps of distances are halves of octaves, so that a small move of the camera keeps the slices.
    let quantised =
        |distance_m: f64, round: fn(f64) -> f64| 2.0_f64.powf(round(distance_m.log2() * 2.0) / 2.0);
    let near_m = quantised(nearest_m.max(0.5), f64::floor);
    let far_m = quantised(furthest_m.max(near_m * 2.0), f64::ceil);
    let split = |k: usize| {
        // Each slice is as many times as far as the one before it: then texels are as many pixels wide in all of them.
        if k == 0 { 0.0 } else { near_m * (far_m / near_m).powf(k as f64 / MAX_CASCADES as f64) }
    };
    std::array::from_fn(|k| cascade(camera, to_sun, [split(k), split(k + 1)], ground, texels))
}

fn cascade(
    camera: &Camera,
    to_sun: DVec3,
    [from_m, to_m]: [f64; 2],
    ground: &Bounds,
    texels: u32,
) -> Cascade {
    let [half_width, half_height] = camera.half_extent();
    // The ball through the corners of both ends of the slice; where the far end is wider than the slice is long, around that end.
    let spread = half_width * half_width + half_height * half_height;
    let centre_at = (0.5 * (to_m + from_m) * (1.0 + spread)).min(to_m);
    let radius_m = ((to_m - centre_at).powi(2) + to_m * to_m * spread).sqrt();
    let radius_m = 2.0_f64.powf((radius_m.log2() * 4.0).ceil() / 4.0);
    let texel_m = 2.0 * radius_m / f64::from(texels);
    let [_, _, backward] = camera.axes();
    let centre = camera.eye_m() - backward * centre_at;
    // Columns: two directions across the sun's, and that to it.
    let across = if to_sun.y.abs() > 0.999 { DVec3::X } else { DVec3::Y };
    let right = across.cross(to_sun).normalize();
    let axes = DMat3::from_cols(right, to_sun.cross(right), to_sun);
    // By whole texels of a grid that is fixed to the terrain.
    let along = axes.transpose() * centre;
    let snapped =
        DVec3::new((along.x / texel_m).round() * texel_m, (along.y / texel_m).round() * texel_m, along.z);
    let centre_relative_m = axes * snapped - camera.eye_m();
    // Whatever of the ground may throw a shadow, or have one.
    let corners = (0..8_u32).map(|corner| {
        let pick = |bit: u32, min: f64, max: f64| if corner >> bit & 1 == 0 { min } else { max };
        let (min, max) = (ground.min_m, ground.max_m);
        let place = DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
        to_sun.dot(place - camera.eye_m())
    });
    let (lowest, highest) =
        corners.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    // No more of it than the ground in the map's square column: depth is as exact as its range is short.
    let middle = to_sun.dot(centre_relative_m);
    let sine = to_sun.y.max(MIN_SUN_HEIGHT);
    let slanted_m = CORNER * radius_m * (1.0 - sine * sine).sqrt() / sine;
    let reach_m = radius_m + slanted_m + (ground.max_m.y - ground.min_m.y) / sine;
    let (lowest, highest) = (lowest.max(middle - reach_m), highest.min(middle + reach_m));
    let length = (highest - lowest).max(1.0);
    let row = |axis: DVec3, scale: f64, offset: f64| (axis * scale).as_vec3().extend(offset as f32);
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis];
    let clip_from_relative = Mat4::from_cols(
        row(x, 1.0 / radius_m, -x.dot(centre_relative_m) / radius_m),
        row(y, 1.0 / radius_m, -y.dot(centre_relative_m) / radius_m),
        row(z, -1.0 / length, highest / length),
        Vec4::W,
    )
    .transpose();
    Cascade { clip_from_relative, texel_m, centre_relative_m, radius_m }
}

impl Cascade {
    /// Whether a box may throw a shadow on what the map holds.
    #[must_use]
    pub fn may_hold(&self, bounds: &Bounds, eye_m: DVec3, to_sun: DVec3) -> bool {
        let middle = (bounds.min_m + bounds.max_m) / 2.0 - eye_m - self.centre_relative_m;
        let across = middle - to_sun * middle.dot(to_sun);
        across.length() <= CORNER * self.radius_m + (bounds.max_m - bounds.min_m).length() / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ground() -> Bounds {
        Bounds { min_m: DVec3::new(0.0, -50.0, 0.0), max_m: DVec3::new(2.0e5, 3_000.0, 2.0e5) }
    }

    fn to_sun() -> impl Strategy<Value = DVec3> {
        (-1.0..1.0_f64, 0.05..1.0_f64, -1.0..1.0_f64).prop_map(|(x, y, z)| DVec3::new(x, y, z).normalize())
    }

    proptest! {
        #[test]
        fn what_is_seen_on_the_ground_is_in_a_map(
            eye in (1.0e3..1.9e5_f64, 100.0..3.0e3_f64, 1.0e3..1.9e5_f64), turn in 0.0..std::f64::consts::TAU, to_sun in to_sun(),
            pixel in (0.0..640.0_f64, 0.0..480.0_f64), distance in 60.0..4.0e4_f64,
        ) {
            let eye = DVec3::new(eye.0, eye.1, eye.2);
            let camera = Camera::looking_at(eye, eye + DVec3::new(turn.cos(), -0.2, turn.sin()), 1.0, [640, 480]);
            let relative = camera.direction_of_pixel([pixel.0, pixel.1]) * distance;
            prop_assume!((-50.0..3_000.0).contains(&(eye + relative).y));
            prop_assume!(ground().distance_m(eye + relative) == 0.0);
            let maps = cascades(&camera, to_sun, [50.0, 5.0e4], &ground(), 1024);
            let held = maps.iter().any(|map| {
                let clip = map.clip_from_relative * relative.as_vec3().extend(1.0);
                clip.x.abs() <= 1.0 && clip.y.abs() <= 1.0 && (-1.0e-3..=1.001).contains(&clip.z)
            });
            prop_assert!(held);
        }

        #[test]
        fn a_map_moves_by_whole_texels(
            eye in (1.0e3..1.9e5_f64, 100.0..3.0e3_f64, 1.0e3..1.9e5_f64), step in (-9.0..9.0_f64, -9.0..9.0_f64), to_sun in to_sun(),
        ) {
            let eye = DVec3::new(eye.0, eye.1, eye.2);
            let map_of = |eye: DVec3| {
                let camera = Camera::looking_at(eye, eye + DVec3::new(1.0, -0.3, 0.2), 1.0, [640, 480]);
                cascades(&camera, to_sun, [50.0, 5.0e4], &ground(), 1024)[1]
            };
            let (first, second) = (map_of(eye), map_of(eye + DVec3::new(step.0, 0.0, step.1)));
            prop_assert_eq!(first.texel_m, second.texel_m);
            let place = eye + DVec3::new(30.0, -40.0, 5.0);
            let texel = |map: &Cascade, eye: DVec3| {
                let clip = map.clip_from_relative * (place - eye).as_vec3().extend(1.0);
                [clip.x * 512.0, clip.y * 512.0]
            };
            let (a, b) = (texel(&first, eye), texel(&second, eye + DVec3::new(step.0, 0.0, step.1)));
            for (a, b) in a.iter().zip(b) {
                let moved = a - b;
                prop_assert!((moved - moved.round()).abs() < 0.05, "{moved}");
            }
        }
    }
}
