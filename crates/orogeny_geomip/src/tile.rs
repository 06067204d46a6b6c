//! Tiles: squares of cells of a level, in a quadtree.

use orogeny_field::TerrainGrid;

/// Cells a side of a tile, of its own level. A power of two that divides every page.
pub const TILE_CELLS: u32 = 64;

/// So many levels coarser than its own a tile is drawn at most. It keeps two tiles side by side, whose levels differ by 1 at
/// most, able to share vertices: 5 levels coarser than the finer one's own there are two cells a side.
pub const MAX_COARSENING: u8 = 4;

/// A square of [`TILE_CELLS`] cells a side, each 2^level samples long.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Tile {
    /// 0 is full resolution; that of the largest terrain's root is 14.
    pub level: u8,
    /// Row of tiles of the level.
    pub z: u32,
    /// Column of tiles of the level.
    pub x: u32,
}

impl Tile {
    /// The smallest one that holds all of a terrain.
    #[must_use]
    pub fn root(grid: &TerrainGrid) -> Self {
        let num_cells = grid.width().max(grid.depth()) - 1;
        let num_tiles = num_cells.div_ceil(TILE_CELLS).max(1).next_power_of_two();
        // At most 2^20 samples a side.
        Self { level: num_tiles.trailing_zeros() as u8, z: 0, x: 0 }
    }

    /// Samples of full resolution along a side.
    #[must_use]
    pub const fn side(&self) -> u32 {
        TILE_CELLS << self.level
    }

    /// Its first sample of full resolution, along x and z.
    #[must_use]
    pub const fn origin(&self) -> [u32; 2] {
        [self.x * self.side(), self.z * self.side()]
    }

    /// Its first and last sample of full resolution along x and z, within a terrain; `None` where the terrain ends before it.
    #[must_use]
    pub fn samples(&self, grid: &TerrainGrid) -> Option<[[u32; 2]; 2]> {
        let last = [grid.width() - 1, grid.depth() - 1];
        let first = self.origin();
        // The last sample of a terrain has no cells to its east: a tile that begins there has none, but for the very first.
        let is_there = first.iter().zip(last).all(|(first, last)| *first < last || *first == 0);
        let [x, z] = first;
        is_there.then(|| [first, [last[0].min(x + self.side()), last[1].min(z + self.side())]])
    }

    /// The four tiles of the next finer level; none of full resolution.
    pub fn children(&self) -> impl Iterator<Item = Self> + use<> {
        let Self { level, z, x } = *self;
        let finer = level.checked_sub(1);
        [(0, 0), (0, 1), (1, 0), (1, 1)]
            .into_iter()
            .filter_map(move |(dz, dx)| Some(Self { level: finer?, z: 2 * z + dz, x: 2 * x + dx }))
    }

    /// The tile of the next coarser level.
    #[must_use]
    pub const fn parent(&self) -> Self {
        Self { level: self.level + 1, z: self.z / 2, x: self.x / 2 }
    }

    /// The tile of its level so many columns and rows off; `None` before the first.
    #[must_use]
    pub fn beside(&self, [dx, dz]: [i32; 2]) -> Option<Self> {
        Some(Self { level: self.level, z: self.z.checked_add_signed(dz)?, x: self.x.checked_add_signed(dx)? })
    }
}
