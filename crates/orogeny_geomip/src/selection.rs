//! Which tiles a picture consists of, and their details.

use std::collections::HashMap;

use orogeny_field::TerrainGrid;

use crate::{Camera, DetailRule, DrawnTile, RIM_PARTS, Relief, Tile};

/// How fast a tile may become coarser than its parent was, once that has been taken apart: in levels, for each level that the parent
/// is finer than its own. By 3/4 of a level on, a tile may be as coarse as it wants.
const CHILD_GAIN: f64 = 4.0;

/// An error at which nothing is fine any more, pixels.
const MAX_ERROR_PX: f64 = 1.0e6;

/// All tiles that the terrain is drawn of from a camera, those out of sight too; each once, finest first. No more than `max_tiles`, or twice the error is accepted, and
/// twice that, until they are.
///
/// The surface that they make follows the camera without a jump: where a tile is taken apart, its children are at first drawn exactly as it
/// was. So there is nothing that could go back and forth, and no need for hysteresis.
#[must_use]
pub fn select(
    grid: &TerrainGrid,
    camera: &Camera,
    rule: &DetailRule,
    relief: &impl Relief,
    max_tiles: usize,
) -> Vec<DrawnTile> {
    let mut rule = *rule;
    loop {
        // Beyond this there is one tile for each square of the top level.
        let max_tiles = if rule.max_error_px < MAX_ERROR_PX { max_tiles } else { usize::MAX };
        if let Some(leaves) = leaves(grid, camera, &rule, relief, max_tiles) {
            return with_rims(leaves);
        }
        rule.max_error_px = rule.max_error_px.max(1.0) * 2.0;
    }
}

/// The tiles with their details; `None` where they are too many.
fn leaves(
    grid: &TerrainGrid,
    camera: &Camera,
    rule: &DetailRule,
    relief: &impl Relief,
    max_tiles: usize,
) -> Option<Vec<(Tile, f32)>> {
    let mut leaves = Vec::new();
    let mut open = vec![(Tile::root(grid), f64::INFINITY)];
    while let Some((tile, coarsest)) = open.pop() {
        let Some(wanted) = rule.wanted(tile, camera, grid, relief) else { continue };
        let own = f64::from(tile.level);
        if wanted < own {
            let coarsest = own + CHILD_GAIN * (own - wanted);
            open.extend(tile.children().map(|child| (child, coarsest)));
        } else {
            leaves.push((tile, wanted.min(coarsest) as f32));
        }
        if leaves.len() + open.len() > max_tiles {
            return None;
        }
    }
    Some(leaves)
}

/// Leaves of a quadtree with their details, whose levels differ by at most 1 where they touch, as they are drawn.
#[must_use]
pub fn with_rims(mut leaves: Vec<(Tile, f32)>) -> Vec<DrawnTile> {
    leaves.sort_by_key(|(tile, _)| *tile);
    let details: HashMap<Tile, f32> = leaves.iter().copied().collect();
    leaves
        .into_iter()
        .map(|(tile, detail)| DrawnTile { tile, detail, rim: rim(tile, detail, &details) })
        .collect()
}

/// The details of a tile's rim: of each part the coarsest of all tiles that touch it.
fn rim(tile: Tile, own: f32, details: &HashMap<Tile, f32>) -> [f32; RIM_PARTS] {
    // Where on the rim each part lies, in halves of the tile's side.
    const PLACES: [[i32; 2]; RIM_PARTS / 2] =
        [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]];
    // The squares of half a side in and around the tile, from its north-western neighbour's last on.
    let mut squares = [[own; 4]; 4];
    for (z, row) in (-1..).zip(&mut squares) {
        for (x, square) in (-1..).zip(row) {
            if !(0..2).contains(&x) || !(0..2).contains(&z) {
                *square = detail_of_square(tile, [x, z], details).unwrap_or(own);
            }
        }
    }
    let square = |[x, z]: [i32; 2]| {
        let [x, z] = [x, z].map(|place| (place + 1).unsigned_abs() as usize);
        squares.get(z).and_then(|row| row.get(x)).copied().unwrap_or(own)
    };
    let mut rim = [own; RIM_PARTS];
    let next = PLACES.iter().cycle().skip(1);
    for ((parts, [x, z]), [next_x, next_z]) in rim.chunks_mut(2).zip(PLACES).zip(next) {
        // The squares of half a side around the corner or the middle.
        let around = [(x - 1, z - 1), (x, z - 1), (x - 1, z), (x, z)];
        let of_corner = around.into_iter().map(|(x, z)| square([x, z])).fold(own, f32::max);
        // The one square outside that the half of a side up to the next lies along.
        let (first_x, first_z) = (x.min(*next_x), z.min(*next_z));
        let outside = match (x == *next_x, x, z) {
            (true, 0, _) => [-1, first_z],
            (true, ..) => [2, first_z],
            (false, _, 0) => [first_x, -1],
            (false, ..) => [first_x, 2],
        };
        if let [corner, half] = parts {
            (*corner, *half) = (of_corner, own.max(square(outside)));
        }
    }
    rim
}

/// The detail of the tile that holds a square of half a side of another, counted from that one's north-western corner.
fn detail_of_square(tile: Tile, [x, z]: [i32; 2], details: &HashMap<Tile, f32>) -> Option<f32> {
    let beside = tile.beside([x.div_euclid(2), z.div_euclid(2)])?;
    let smaller = || {
        let [x, z] = [x, z].map(|half| half.rem_euclid(2).unsigned_abs());
        Some(Tile { level: beside.level.checked_sub(1)?, z: 2 * beside.z + z, x: 2 * beside.x + x })
    };
    let of = |tile: Tile| details.get(&tile).copied();
    of(beside).or_else(|| of(beside.parent())).or_else(|| of(smaller()?))
}
