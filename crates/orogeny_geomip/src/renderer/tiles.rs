//! Which tiles each pass of a frame draws: one list for the picture, one for each shadow map, all in one buffer.

use std::collections::BTreeMap;
use std::ops::Range;

use orogeny_field::{PageLayout, TerrainGrid};

use super::uniforms::TileInstance;
use crate::{
    Bounds, Camera, Cascade, DrawnTile, Frustum, MAX_COARSENING, PagePlace, PageRelief, PageSummaries,
    PageTable, above_horizon,
};

/// A tile with the box that it is drawn in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    pub(super) drawn: DrawnTile,
    pub(super) bounds: Bounds,
}

/// Tiles of one step, which one call draws.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Batch {
    pub(super) step: u32,
    /// In the buffer of instances.
    pub(super) instances: Range<u32>,
}

/// What is in the buffer of instances.
#[derive(Debug, Default)]
pub(super) struct Lists {
    pub(super) instances: Vec<TileInstance>,
}

impl Lists {
    /// Appends the tiles of one pass, by their steps, none of them finer than a detail.
    pub(super) fn append<'a>(&mut self, tiles: impl Iterator<Item = &'a Placed>, finest: f32) -> Vec<Batch> {
        let mut by_step: BTreeMap<u32, Vec<TileInstance>> = BTreeMap::new();
        for placed in tiles {
            let drawn = coarsened(&placed.drawn, finest);
            by_step.entry(drawn.step()).or_default().push((&drawn).into());
        }
        by_step
            .into_iter()
            .map(|(step, tiles)| {
                let first = self.instances.len() as u32;
                self.instances.extend(tiles);
                Batch { step, instances: first..self.instances.len() as u32 }
            })
            .collect()
    }
}

/// A tile, drawn no more finely than a detail. Its rim follows by the same rule, so that tiles still meet.
fn coarsened(drawn: &DrawnTile, finest: f32) -> DrawnTile {
    DrawnTile { detail: drawn.detail.max(finest), rim: drawn.rim.map(|rim| rim.max(finest)), ..*drawn }
}

/// The detail from which on a map shows no more: samples as wide as its texels. No further from full resolution than the finest tile may be drawn.
pub(super) fn finest_of_map(cascade: &Cascade, grid: &TerrainGrid, top_level: u8) -> f32 {
    let texel = (cascade.texel_m / grid.spacing_m()).log2();
    texel.clamp(0.0, f64::from(MAX_COARSENING.min(top_level))) as f32
}

/// The page of a tile's detail that its first sample lies in.
fn page_of(drawn: &DrawnTile, layout: PageLayout) -> PagePlace {
    // Details are levels.
    let level = (drawn.detail as u8).max(drawn.tile.level);
    let [x, z] = drawn.tile.origin().map(|sample| (sample >> level) / layout.size());
    PagePlace { level, z, x }
}

/// All tiles with their boxes. A coarse surface stays between the heights of a tile's ring.
pub(super) fn placed<S: PageSummaries>(
    drawn: &[DrawnTile],
    grid: &TerrainGrid,
    layout: PageLayout,
    relief: &PageRelief<'_, S>,
    table: &PageTable,
) -> Vec<Placed> {
    drawn
        .iter()
        .filter_map(|drawn| {
            let mut heights = relief.narrow_ring_bounds(drawn.tile);
            // What is read from a coarser page may be anything that this page says.
            let read = page_of(drawn, layout);
            if let Some((level, _)) = table.lookup(read)
                && level > read.level
            {
                let coarser =
                    PagePlace { level, z: read.z >> (level - read.level), x: read.x >> (level - read.level) };
                heights = heights.with(relief.summary(coarser).bounds);
            }
            let bounds = Bounds::of_samples(drawn.tile.samples(grid)?, heights, grid.spacing_m());
            Some(Placed { drawn: *drawn, bounds })
        })
        .collect()
}

/// Of these, what the picture shows: in its frustum, and not behind nearer ground.
pub(super) fn in_sight<'a>(tiles: &'a [Placed], camera: &Camera) -> Vec<&'a Placed> {
    let frustum = Frustum::of(camera);
    // What lies beside the picture is asked too: a ray's way is straight, whatever the picture shows of it.
    let boxes: Vec<_> = tiles.iter().map(|placed| placed.bounds).collect();
    let above = above_horizon(&boxes, camera.eye_m());
    let all = tiles.iter().zip(above);
    all.filter(|(placed, is_above)| *is_above && frustum.may_show(&placed.bounds))
        .map(|(placed, _)| placed)
        .collect()
}

/// Of these, what may throw a shadow that a map holds.
pub(super) fn in_map<'a>(
    tiles: &'a [Placed],
    cascade: &Cascade,
    camera: &Camera,
    to_sun: glam::DVec3,
) -> impl Iterator<Item = &'a Placed> {
    let (cascade, eye_m) = (*cascade, camera.eye_m());
    tiles.iter().filter(move |placed| cascade.may_hold(&placed.bounds, eye_m, to_sun))
}

/// The nearest and the furthest distance of what is in sight, metres.
pub(super) fn depth_range(tiles: &[&Placed], camera: &Camera) -> [f64; 2] {
    let eye_m = camera.eye_m();
    let nearest = tiles.iter().map(|placed| placed.bounds.distance_m(eye_m)).fold(f64::INFINITY, f64::min);
    let furthest = tiles.iter().map(|placed| {
        let (min, max) = ((placed.bounds.min_m - eye_m).abs(), (placed.bounds.max_m - eye_m).abs());
        min.max(max).length()
    });
    [nearest.min(1.0e7), furthest.fold(1.0, f64::max)]
}
