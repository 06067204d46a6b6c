//! What each surface is painted of.

mod earth;
mod floor;
mod frozen;
mod grass;
mod rock;
mod stones;

use glam::Vec3;

use super::Surface;
use super::canvas::{Canvas, Texel};

/// Paints a surface.
pub(super) fn paint(surface: Surface, canvas: &Canvas) -> Vec<Texel> {
    match surface {
        Surface::Grass => grass::grass(canvas),
        Surface::Meadow => grass::meadow(canvas),
        Surface::ForestFloor => floor::forest_floor(canvas),
        Surface::Moss => floor::moss(canvas),
        Surface::Soil => earth::soil(canvas),
        Surface::CrackedEarth => earth::cracked_earth(canvas),
        Surface::Mud => earth::mud(canvas),
        Surface::Sand => earth::sand(canvas),
        Surface::Gravel => stones::gravel(canvas),
        Surface::Scree => stones::scree(canvas),
        Surface::Rock => rock::rock(canvas),
        Surface::Cliff => rock::cliff(canvas),
        Surface::Basalt => rock::basalt(canvas),
        Surface::Snow => frozen::snow(canvas),
        Surface::Ice => frozen::ice(canvas),
    }
}

/// A colour of a row of them at equal distances, `share` 0..1 of the way along.
fn ramp<const N: usize>(colours: &[Vec3; N], share: f32) -> Vec3 {
    let place = share.clamp(0.0, 1.0) * (N.max(2) - 1) as f32;
    let index = (place as usize).min(N.max(2) - 2);
    let colour = |index: usize| colours.get(index).or(colours.last()).copied().unwrap_or_default();
    colour(index).lerp(colour(index + 1), place - index as f32)
}
