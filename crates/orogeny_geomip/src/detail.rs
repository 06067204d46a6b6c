//! How finely a tile is drawn: from how many pixels what is left out would be high, or how many lie between two vertices.

use orogeny_field::{HeightBounds, TerrainGrid};

use crate::{Bounds, Camera, MAX_COARSENING, Tile};

/// The least error that is worth its triangles, pixels.
const MIN_ERROR_PX: f64 = 0.1;

/// No vertices are wanted closer than this, pixels from above.
const MIN_SAMPLE_PX: f64 = 1.0;

/// What is asked of a terrain's heights to choose details. `Tile`s lie on the terrain.
///
/// Both answers are about the *ring* of a tile: the tile and the eight of its level around it. Then a tile never asks for less than what lies
/// beside it and is smaller, so that the levels of two leaves of the quadtree side by side differ by at most 1.
pub trait Relief {
    /// The coarsest level that there is: no tile is drawn coarser.
    fn top_level(&self) -> u8;

    /// The lowest and highest height of a tile's ring: of all samples of its tiles, the last ones included, which are the first of the next.
    fn ring_bounds(&self, tile: Tile) -> HeightBounds;

    /// How far, at most, the surface of a level is from that of full resolution anywhere in a tile's ring, metres.
    ///
    /// At least [`orogeny_field::MIN_ERROR_GROWTH`] times that of the next finer level, so that a small step of the camera is a small one in
    /// detail; not less than that of a tile whose ring lies within this one's; 0 for level 0. `level` is at most the top level.
    fn ring_error_m(&self, tile: Tile, level: u8) -> f32;
}

/// By what a tile's detail is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metric {
    /// By how many pixels what a level leaves out may be high, seen from the side (de Boer 2000): flat ground has few vertices. None are closer than a pixel,
    /// seen from above.
    Roughness,
    /// By how many pixels there are between two vertices, seen from above, whatever the heights: nothing changes with them.
    FromAbove,
}

/// What detail follows from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetailRule {
    /// How it is measured.
    pub metric: Metric,
    /// How many pixels are accepted; less than 0.1 is as 0.1.
    pub max_error_px: f64,
}

impl Default for DetailRule {
    fn default() -> Self {
        Self { metric: Metric::Roughness, max_error_px: 2.0 }
    }
}

impl DetailRule {
    /// The detail that a camera asks of a tile: below the tile's own level, where four smaller tiles are wanted in its place, and at most
    /// [`MAX_COARSENING`] above it, and no coarser than the top level. `None` where the terrain ends before the tile.
    ///
    /// It follows the camera's place without a jump, and where a tile asks for its own level exactly, each of its children asks for
    /// that level or a coarser one.
    #[must_use]
    pub fn wanted(
        &self,
        tile: Tile,
        camera: &Camera,
        grid: &TerrainGrid,
        relief: &impl Relief,
    ) -> Option<f64> {
        tile.samples(grid)?;
        let own = f64::from(tile.level);
        let top = relief.top_level();
        if tile.level > top {
            return Some(own - 1.0);
        }
        let ring = Bounds::of_ring(tile, grid, relief.ring_bounds(tile))?;
        let distance_m = ring.distance_m(camera.eye_m());
        // Metres that are `max_error_px` pixels high at that distance.
        let accepted_m = self.max_error_px.max(MIN_ERROR_PX) * distance_m / camera.pixels_at_one_metre();
        let max_coarsening = MAX_COARSENING.min(top - tile.level);
        let coarsest = own + f64::from(max_coarsening);
        let finest = if tile.level == 0 { 0.0 } else { own - 1.0 };
        if accepted_m <= 0.0 {
            // Nothing is fine enough where the eye is.
            return Some(finest);
        }
        let wanted = match self.metric {
            Metric::FromAbove => (accepted_m / grid.spacing_m()).log2(),
            Metric::Roughness => {
                let error_m = |coarsening: u8| f64::from(relief.ring_error_m(tile, tile.level + coarsening));
                // Vertices closer than pixels show no more of a rough ground, whatever its error.
                let pixel_m = distance_m / camera.pixels_at_one_metre();
                let sample_px = (MIN_SAMPLE_PX * pixel_m / grid.spacing_m()).log2();
                (own + coarsening_by_roughness(accepted_m, max_coarsening, error_m)).max(sample_px)
            }
        };
        Some(wanted.clamp(finest, coarsest))
    }
}

/// By how many levels a tile may be coarser than its own; negative, where its own is too coarse.
fn coarsening_by_roughness(accepted_m: f64, max_coarsening: u8, error_m: impl Fn(u8) -> f64) -> f64 {
    let mut finer = error_m(0);
    if finer > accepted_m {
        // Errors about double from level to level.
        return -(finer / accepted_m).log2();
    }
    for coarsening in 1..=max_coarsening {
        let coarser = error_m(coarsening);
        if coarser > accepted_m {
            return f64::from(coarsening - 1) + (accepted_m - finer) / (coarser - finer);
        }
        finer = coarser;
    }
    f64::from(max_coarsening)
}
