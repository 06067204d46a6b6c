//! Pages as the renderer names them: of the composite, so of no field.

use orogeny_field::{PageLayout, TerrainGrid};

/// A page of the composite at a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PagePlace {
    /// 0 is full resolution.
    pub level: u8,
    /// Row of pages of the level.
    pub z: u32,
    /// Column of pages of the level.
    pub x: u32,
}

impl PagePlace {
    /// The one page of a terrain's top level, which all of it is drawn from until there is more.
    #[must_use]
    pub fn root(grid: &TerrainGrid, layout: PageLayout) -> Self {
        Self { level: layout.top_level(grid), z: 0, x: 0 }
    }

    /// The page one level up that covers this one.
    #[must_use]
    pub const fn parent(&self) -> Self {
        Self { level: self.level + 1, z: self.z / 2, x: self.x / 2 }
    }

    /// The pages one level down that this one covers; those beyond the terrain's edge are left out.
    pub fn children(&self, grid: &TerrainGrid, layout: PageLayout) -> impl Iterator<Item = Self> + use<> {
        let Self { level, z, x } = *self;
        let below = level.checked_sub(1);
        let (columns, rows) = below.map_or((0, 0), |level| layout.num_pages_at(grid, level));
        [(0, 0), (0, 1), (1, 0), (1, 1)]
            .into_iter()
            .filter_map(move |(dz, dx)| Some(Self { level: below?, z: 2 * z + dz, x: 2 * x + dx }))
            .filter(move |child| child.x < columns && child.z < rows)
    }

    /// Its first and last sample of full resolution along x and z, the first of the next pages included, within the terrain.
    #[must_use]
    pub fn samples(&self, grid: &TerrainGrid, layout: PageLayout) -> [[u32; 2]; 2] {
        let side = layout.size() << self.level;
        let last = [grid.width() - 1, grid.depth() - 1];
        // A page of the largest terrain's root ends at 2^20.
        let first = [self.x * side, self.z * side];
        let [x, z] = first;
        [first, [last[0].min(x + side), last[1].min(z + side)]]
    }
}
