//! The vertices of a tile, and the triangles between them. Twin of the vertex shader.

use glam::DVec3;
use orogeny_field::TerrainGrid;

use crate::{MAX_COARSENING, TILE_CELLS, Tile};

/// Parts of a tile's rim whose details may differ: four corners, four middles, and the eight halves of sides between them.
pub const RIM_PARTS: usize = 16;

/// A tile as it is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnTile {
    /// Which one.
    pub tile: Tile,
    /// Its detail: a level with a fraction, from its own level on.
    pub detail: f32,
    /// That of its rim's parts, clockwise from the north-western corner: none below its own.
    pub rim: [f32; RIM_PARTS],
}

impl DrawnTile {
    /// Cells from one vertex to the next, as the tile's triangles have them. A power of two.
    #[must_use]
    pub fn step(&self) -> u32 {
        1 << coarsening(self.tile, self.detail)
    }

    /// Which part of the rim a place of the tile belongs to, in cells of its own level; `None` within the tile.
    #[must_use]
    pub fn rim_part([x, z]: [u32; 2]) -> Option<usize> {
        match [part_of_side(x), part_of_side(z)] {
            [x, 0] => Some(x),
            [4, z] => Some(4 + z),
            [x, 4] => Some(12 - x),
            [0, z] => Some(16 - z),
            _ => None,
        }
    }

    /// Where the vertex is that belongs to a place of the tile, in cells of its own level, which is a multiple of the step; metres.
    /// `height_m` gives a sample of a level.
    #[must_use]
    pub fn vertex_m<H: Fn(u8, [u32; 2]) -> f32>(
        &self,
        place: [u32; 2],
        grid: &TerrainGrid,
        height_m: &H,
    ) -> DVec3 {
        let ([x, z], [border_x, border_z]) = (place, self.border(grid));
        let (x, z) = (x.min(border_x), z.min(border_z));
        let place = [x, z];
        let detail = self.detail_at(place);
        let coarsening = coarsening(self.tile, detail);
        // What is at the terrain's border stays there.
        let along = |place: u32, border: u32, coarsening: u8| {
            if place == border { place } else { (place >> coarsening) << coarsening }
        };
        let rounded = |coarsening: u8| [along(x, border_x, coarsening), along(z, border_z, coarsening)];
        let finer = rounded(coarsening);
        if finer != place {
            // It has fallen together with another one.
            return self.vertex_m(finer, grid, height_m);
        }
        let level = self.tile.level + coarsening;
        let finer_m = self.sample_m(place, level, grid, height_m);
        let fraction = f64::from(detail) - f64::from(level);
        if fraction <= 0.0 {
            return finer_m;
        }
        let coarser = rounded(coarsening + 1);
        let coarser_m = if coarser == place {
            self.sample_m(place, level + 1, grid, height_m)
        } else {
            // To where that vertex is now, which may have a detail of its own: no further than to the corner of the tile.
            self.vertex_m(coarser, grid, height_m)
        };
        finer_m + (coarser_m - finer_m) * fraction
    }

    /// The detail at a place of the tile, in cells of its own level.
    fn detail_at(&self, place: [u32; 2]) -> f32 {
        Self::rim_part(place).and_then(|part| self.rim.get(part)).copied().unwrap_or(self.detail)
    }

    /// Where a level has its sample at a place of the tile, metres. At the terrain's border it is as high as the level's last one.
    fn sample_m(
        &self,
        place: [u32; 2],
        level: u8,
        grid: &TerrainGrid,
        height_m: &impl Fn(u8, [u32; 2]) -> f32,
    ) -> DVec3 {
        let ([x, z], last) = (place, grid.bounds_at(level));
        let along = |tile: u32, place: u32, num: u32, end: i32| {
            let full = (tile * TILE_CELLS + place) << self.tile.level;
            ((full >> level).min(end.abs_diff(1)), f64::from(full.min(num - 1)) * grid.spacing_m())
        };
        let (x, x_m) = along(self.tile.x, x, grid.width(), last.x1);
        let (z, z_m) = along(self.tile.z, z, grid.depth(), last.z1);
        DVec3::new(x_m, f64::from(height_m(level, [x, z])), z_m)
    }

    /// The terrain's border along x and z, in cells of the tile's level; the first place at or beyond it.
    fn border(&self, grid: &TerrainGrid) -> [u32; 2] {
        let [x, z] = self.tile.origin();
        [(grid.width(), x), (grid.depth(), z)].map(|(num, first)| {
            // A tile on the terrain begins at a sample of it.
            (num - 1).saturating_sub(first).div_ceil(1 << self.tile.level).min(TILE_CELLS)
        })
    }

    /// How many of its triangles have an area while no vertex is on its way, if all of it lies on the terrain: those along the rim go where vertices of the rim
    /// fall together.
    #[must_use]
    pub fn num_triangles(&self) -> u32 {
        let num_cells = TILE_CELLS / self.step();
        let along_half = |part: usize| {
            let rim = self.rim.get(part).copied().unwrap_or(self.detail);
            let together = 1 << coarsening(self.tile, rim).saturating_sub(coarsening(self.tile, self.detail));
            num_cells / 2 - (num_cells / 2) / together.min(num_cells / 2)
        };
        2 * num_cells * num_cells - (1..RIM_PARTS).step_by(2).map(along_half).sum::<u32>()
    }
}

/// Whole levels that a detail is coarser than a tile's own.
fn coarsening(tile: Tile, detail: f32) -> u8 {
    // Details are levels. None is below the tile's, nor further above it than two tiles side by side may be.
    (detail as u8).saturating_sub(tile.level).min(MAX_COARSENING + 1)
}

/// 0 the first place of a side, 2 its middle, 4 its last; 1 and 3 its halves.
const fn part_of_side(place: u32) -> usize {
    const MIDDLE: u32 = TILE_CELLS / 2;
    match place {
        0 => 0,
        MIDDLE => 2,
        TILE_CELLS => 4,
        _ if place < MIDDLE => 1,
        _ => 3,
    }
}

/// The triangles of a tile drawn with a step, counter-clockwise from above: three numbers each, of vertices counted row by row of
/// `TILE_CELLS + 1`. A step is a power of two up to [`TILE_CELLS`]; another is as the next one up. All tiles of one step share them, whatever lies beside them.
#[must_use]
pub fn indices(step: u32) -> Vec<u16> {
    const ROW: u32 = TILE_CELLS + 1;
    let step = step.clamp(1, TILE_CELLS).next_power_of_two();
    let places = || (0..TILE_CELLS).step_by(step as usize);
    let corner = |x: u32, z: u32| (z * ROW + x) as u16;
    places()
        .flat_map(|z| places().map(move |x| (x, z)))
        .flat_map(|(x, z)| {
            let (east, south) = (x + step, z + step);
            let (first, last) = (corner(x, z), corner(east, south));
            [first, last, corner(east, z), first, corner(x, south), last]
        })
        .collect()
}
