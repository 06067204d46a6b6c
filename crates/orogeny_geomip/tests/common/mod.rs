//! Ground with all that is asked of it, worked out plainly.

use std::collections::HashMap;
use std::sync::Mutex;

use glam::DVec3;
use orogeny_field::{HeightBounds, MIN_ERROR_GROWTH, TerrainGrid, hash};
use orogeny_geomip::{DrawnTile, Relief, Tile, indices};

/// A level, and beside each sample of full resolution how far its surface is counted to be from the ground there.
struct Level {
    width: usize,
    depth: usize,
    heights: Vec<f32>,
    errors: Vec<f32>,
}

/// Hills on one side, a plain on the other, a cliff between.
pub struct Hills {
    pub grid: TerrainGrid,
    levels: Vec<Level>,
    /// What was asked before: cameras ask for the same again and again.
    known: Mutex<HashMap<(Tile, Option<u8>), HeightBounds>>,
}

impl Level {
    fn at(&self, x: usize, z: usize) -> f32 {
        self.heights[z.min(self.depth - 1) * self.width + x.min(self.width - 1)]
    }

    fn coarser(&self) -> Self {
        let (width, depth) = (self.width.div_ceil(2), self.depth.div_ceil(2));
        let mean = |x: usize, z: usize| {
            let mut sum = 0.0;
            for (dz, wz) in [(-1, 1.0), (0, 2.0), (1, 1.0)] {
                for (dx, wx) in [(-1, 1.0), (0, 2.0), (1, 1.0)] {
                    let place = |place: usize, by: isize| (2 * place).saturating_add_signed(by);
                    sum += wx * wz * self.at(place(x, dx), place(z, dz));
                }
            }
            sum / 16.0
        };
        let heights =
            (0..depth).flat_map(|z| (0..width).map(move |x| (x, z))).map(|(x, z)| mean(x, z)).collect();
        Self { width, depth, heights, errors: Vec::new() }
    }
}

impl Hills {
    pub fn new(width: u64, depth: u64, spacing_m: f64) -> Self {
        let grid = TerrainGrid::new(width, depth, spacing_m).unwrap();
        let height = |x: u32, z: u32| {
            let (fx, fz) = (x as f32, z as f32);
            let hills = 60.0 * (fx / 23.0).sin() * (fz / 31.0).cos() + 9.0 * hash::uniform(x, z, 3);
            if fx > fz + 40.0 { 200.0 + 0.01 * fx } else { hills }
        };
        let (w, d) = (grid.width(), grid.depth());
        let heights =
            (0..d).flat_map(|z| (0..w).map(move |x| (x, z))).map(|(x, z)| height(x, z)).collect::<Vec<_>>();
        let errors = vec![0.0; heights.len()];
        let mut levels = vec![Level { width: w as usize, depth: d as usize, heights, errors }];
        for number in 1..=Tile::root(&grid).level as usize + 7 {
            let mut level = levels[number - 1].coarser();
            let ground = &levels[0].heights;
            level.errors = (0..ground.len())
                .map(|place| {
                    let (x, z) = (place % w as usize, place / w as usize);
                    let off = (surface(&level, number, x, z) - ground[place]).abs();
                    off.max(levels[number - 1].errors[place] * MIN_ERROR_GROWTH)
                })
                .collect();
            levels.push(level);
        }
        Self { grid, levels, known: Mutex::default() }
    }

    pub fn height_m(&self, level: u8, [x, z]: [u32; 2]) -> f32 {
        let level = &self.levels[level as usize];
        assert!((x as usize) < level.width && (z as usize) < level.depth, "{x}, {z}");
        level.at(x as usize, z as usize)
    }

    fn ring(&self, tile: Tile) -> [std::ops::RangeInclusive<usize>; 2] {
        let [first, last] = tile.samples(&self.grid).unwrap();
        let side = tile.side();
        let num = [self.grid.width(), self.grid.depth()];
        [0, 1].map(|axis| {
            first[axis].saturating_sub(side) as usize..=(last[axis] + side).min(num[axis] - 1) as usize
        })
    }

    fn over_ring(&self, tile: Tile, values: &[f32]) -> HeightBounds {
        let [x, z] = self.ring(tile);
        let rows = z.map(|z| &values[z * self.levels[0].width..][x.clone()]);
        rows.filter_map(HeightBounds::of_row).reduce(HeightBounds::with).unwrap()
    }
}

/// The triangles of a level at a sample of full resolution.
fn surface(level: &Level, number: usize, x: usize, z: usize) -> f32 {
    let side = 1 << number;
    let (i, j) = (x / side, z / side);
    let (fx, fz) = ((x % side) as f32 / side as f32, (z % side) as f32 / side as f32);
    let (first, last) = (level.at(i, j), level.at(i + 1, j + 1));
    if fx >= fz {
        let east = level.at(i + 1, j);
        first + fx * (east - first) + fz * (last - east)
    } else {
        let south = level.at(i, j + 1);
        first + fz * (south - first) + fx * (last - south)
    }
}

impl Relief for Hills {
    fn top_level(&self) -> u8 {
        // Two below the root's, as that of a terrain of pages of 256 samples is.
        Tile::root(&self.grid).level.saturating_sub(2)
    }

    fn ring_bounds(&self, tile: Tile) -> HeightBounds {
        // Coarser levels lie between the lowest and the highest.
        let bounds = || self.over_ring(tile, &self.levels[0].heights);
        *self.known.lock().unwrap().entry((tile, None)).or_insert_with(bounds)
    }

    fn ring_error_m(&self, tile: Tile, level: u8) -> f32 {
        let errors = || self.over_ring(tile, &self.levels[level as usize].errors);
        self.known.lock().unwrap().entry((tile, Some(level))).or_insert_with(errors).max_m
    }
}

/// The triangles of a tile, as a GPU would have them; those without an area too.
pub fn triangles(drawn: &DrawnTile, hills: &Hills) -> Vec<[DVec3; 3]> {
    let row = orogeny_geomip::TILE_CELLS + 1;
    let height_m = |level, sample| hills.height_m(level, sample);
    let place = |index: u16| {
        let index = u32::from(index);
        drawn.vertex_m([index % row, index / row], &hills.grid, &height_m)
    };
    indices(drawn.step()).as_chunks::<3>().0.iter().map(|corners| corners.map(place)).collect()
}

/// Of a triangle seen from above; negative, where it is seen from below.
pub fn area([a, b, c]: [DVec3; 3]) -> f64 {
    -((b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x)) / 2.0
}
