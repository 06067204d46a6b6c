//! What of a terrain a picture cannot show.

use glam::DVec3;
use orogeny_field::{HeightBounds, TerrainGrid};

use crate::{Camera, Tile};

/// A box along the axes, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Its lowest, north-western corner.
    pub min_m: DVec3,
    /// Its highest, south-eastern corner.
    pub max_m: DVec3,
}

impl Bounds {
    /// Of samples, the first and the last, between two heights.
    #[must_use]
    pub fn of_samples([first, last]: [[u32; 2]; 2], heights: HeightBounds, spacing_m: f64) -> Self {
        let corner = |[x, z]: [u32; 2], height: f32| {
            DVec3::new(f64::from(x) * spacing_m, f64::from(height), f64::from(z) * spacing_m)
        };
        Self { min_m: corner(first, heights.min_m), max_m: corner(last, heights.max_m) }
    }

    /// Of a tile and those of its level around it, between the heights that are there; `None` where the terrain ends before the tile.
    #[must_use]
    pub fn of_ring(tile: Tile, grid: &TerrainGrid, heights: HeightBounds) -> Option<Self> {
        let [first, last] = tile.samples(grid)?;
        let [width, depth] = [grid.width() - 1, grid.depth() - 1];
        let side = tile.side();
        let first = first.map(|first| first.saturating_sub(side));
        // At most 2^21 samples from the origin.
        let last = [width.min(last[0] + side), depth.min(last[1] + side)];
        Some(Self::of_samples([first, last], heights, grid.spacing_m()))
    }

    /// As it is, but further to all four sides, metres.
    #[must_use]
    pub fn grown(&self, by_m: f64) -> Self {
        let by_m = DVec3::new(by_m, 0.0, by_m);
        Self { min_m: self.min_m - by_m, max_m: self.max_m + by_m }
    }

    /// How far a place lies from it, metres; 0 within.
    #[must_use]
    pub fn distance_m(&self, place_m: DVec3) -> f64 {
        place_m.distance(place_m.clamp(self.min_m, self.max_m))
    }
}

/// The planes through the eye between which a picture lies: its four sides, and what is before the eye; with infinitely far reversed
/// depth there is no far plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frustum {
    eye_m: DVec3,
    /// Pointing inwards.
    normals: [DVec3; 5],
}

impl Frustum {
    /// Of a camera.
    #[must_use]
    pub fn of(camera: &Camera) -> Self {
        let [half_width, half_height] = camera.half_extent();
        let [right, up, backward] = camera.axes();
        let sides = [(right, half_width), (-right, half_width), (up, half_height), (-up, half_height)];
        // Inside, what is before the eye outweighs what is beside it.
        let [west, east, south, north] = sides.map(|(side, half)| side - backward * half);
        Self { eye_m: camera.eye_m(), normals: [west, east, south, north, -backward] }
    }

    /// Whether a box may be seen; a few that lie beside two planes are said to be.
    #[must_use]
    pub fn may_show(&self, bounds: &Bounds) -> bool {
        let (min, max) = (bounds.min_m - self.eye_m, bounds.max_m - self.eye_m);
        self.normals.iter().all(|normal| {
            let furthest = DVec3::select(normal.cmpge(DVec3::ZERO), max, min);
            normal.dot(furthest) >= 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place() -> impl Strategy<Value = DVec3> {
        (-1.0e4..1.0e4_f64, -500.0..5.0e3_f64, -1.0e4..1.0e4_f64).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn a_box_of_which_a_point_is_in_the_picture_may_be_seen(
            eye in place(), target in place(), corner in place(), size in (0.0..900.0_f64, 0.0..900.0_f64, 0.0..900.0_f64),
            within in (0.0..=1.0_f64, 0.0..=1.0_f64, 0.0..=1.0_f64),
        ) {
            let camera = Camera::looking_at(eye, target, 0.9, [800, 600]);
            let size = DVec3::new(size.0, size.1, size.2);
            let bounds = Bounds { min_m: corner, max_m: corner + size };
            let point = corner + size * DVec3::new(within.0, within.1, within.2);
            let view = camera.view_from_world(point);
            let [half_width, half_height] = camera.half_extent();
            let is_in_picture =
                view.z < 0.0 && view.x.abs() <= half_width * -view.z && view.y.abs() <= half_height * -view.z;
            prop_assert!(!is_in_picture || Frustum::of(&camera).may_show(&bounds));
        }

        #[test]
        fn a_box_behind_the_eye_or_beside_the_picture_is_not_seen(
            eye in place(), target in place(), away in 100.0..5.0e3_f64, side in 0..5_usize,
        ) {
            prop_assume!(eye.distance(target) > 1.0);
            let camera = Camera::looking_at(eye, target, 0.9, [800, 600]);
            let [right, up, backward] = camera.axes();
            let direction = [backward, right, -right, up, -up][side];
            let centre = eye + direction * (away + 20.0);
            let bounds = Bounds { min_m: centre - 5.0, max_m: centre + 5.0 };
            prop_assert!(!Frustum::of(&camera).may_show(&bounds));
        }
    }
}
