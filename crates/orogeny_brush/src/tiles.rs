//! Pages cut into tiles for a GPU: each with the instances that reach it, so that a long stroke does not cost every instance
//! at every sample.

use orogeny_field::{PageLayout, SampleRect};

use crate::plan::{Batch, PageWork, reaches};

/// Samples a side of a tile: a workgroup of 16 x 16 takes four samples an invocation. Tiles are the blocks that share a place
/// on the lattices of a noise.
pub const TILE_SIDE: u32 = orogeny_field::noise::LATTICE_BLOCK;

/// One workgroup's work. The layout is that of `Tile` in `shaders/driver/local.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Tile {
    /// The page's first sample, on the terrain.
    pub page_origin: [i32; 2],
    /// First sample to change, in the page.
    pub first: [u32; 2],
    /// One past the last.
    pub end: [u32; 2],
    /// The page's layer in its texture array.
    pub heights_layer: u32,
    /// The layer of its weights and its heights from before, in a wash.
    pub scratch_layer: u32,
    /// The layer of its gate, where there is one.
    pub gate_layer: u32,
    /// Its instances are `indices[first_index .. end_index]`.
    pub first_index: u32,
    /// One past the last.
    pub end_index: u32,
    /// Of a noise: its places on the lattices begin here.
    pub first_lattice: u32,
}

impl Tile {
    /// The first sample of the lattice block that it lies in: tiles are those blocks, cut at what is to change.
    #[must_use]
    pub fn lattice_block_origin(&self) -> [i32; 2] {
        let ([origin_x, origin_z], [first_x, first_z]) = (self.page_origin, self.first);
        let down = |first: u32| (first / TILE_SIDE * TILE_SIDE).cast_signed();
        [origin_x + down(first_x), origin_z + down(first_z)]
    }
}

/// Where a page lies in the atlases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PageLayers {
    /// Of its heights.
    pub heights: u32,
    /// Of its weights and its heights from before.
    pub scratch: u32,
    /// Of its gate.
    pub gate: u32,
}

/// The tiles of some pages of a batch, and their instance lists one after another.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TileList {
    /// In the order of their pages.
    pub tiles: Vec<Tile>,
    /// Indices into [`Batch::instances`].
    pub indices: Vec<u32>,
}

impl TileList {
    /// Adds the tiles of one page that any of its instances reaches.
    pub fn add_page(&mut self, batch: &Batch, work: &PageWork, layout: PageLayout, layers: PageLayers) {
        let page = layout.page_rect(&work.key);
        let side = TILE_SIDE.cast_signed();
        let first_tile = |edge: i32, origin: i32| origin + (edge - origin) / side * side;
        let rows = (first_tile(work.rect.z0, page.z0)..work.rect.z1).step_by(TILE_SIDE as usize);
        for z in rows {
            for x in (first_tile(work.rect.x0, page.x0)..work.rect.x1).step_by(TILE_SIDE as usize) {
                let rect = SampleRect::new(x, z, x + side, z + side).intersection(&work.rect);
                let first_index = self.indices.len() as u32;
                let reaching = work.instances.iter().copied().filter(|index| {
                    let index = *index as usize;
                    let both = batch.instances.get(index).zip(batch.bounds.get(index));
                    both.is_some_and(|(instance, bound)| reaches(instance, &rect.intersection(bound)))
                });
                self.indices.extend(reaching);
                let end_index = self.indices.len() as u32;
                if end_index == first_index {
                    continue;
                }
                let local = |x: i32, z: i32| [x.abs_diff(page.x0), z.abs_diff(page.z0)];
                self.tiles.push(Tile {
                    page_origin: [page.x0, page.z0],
                    first: local(rect.x0, rect.z0),
                    end: local(rect.x1, rect.z1),
                    heights_layer: layers.heights,
                    scratch_layer: layers.scratch,
                    gate_layer: layers.gate,
                    first_index,
                    end_index,
                    first_lattice: 0,
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::Rule;
    use crate::plan::Pass;
    use orogeny_field::{FieldId, Footprint, Instance};
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn pass() -> Pass {
        Pass::new(Rule::Raise, Footprint::EVERYWHERE, FieldId(0))
    }

    proptest! {
        /// Every sample within an instance's radius lies in exactly one tile that lists the instance, in stroke order;
        /// no sample outside the bounds is covered.
        #[test]
        fn tiles_cover_what_the_instances_reach_once(
            dabs in prop::collection::vec((-20.0_f64..220.0, -20.0_f64..160.0, 0.5_f64..90.0), 1..8),
        ) {
            let layout = PageLayout::new(64).unwrap();
            let terrain = SampleRect::new(0, 0, 200, 140);
            let mut instances = Vec::new();
            let mut bounds = Vec::new();
            for (x, z, radius) in &dabs {
                instances.push(Instance {
                    cell: [x.floor() as i32, z.floor() as i32],
                    fraction: [(x - x.floor()) as f32, (z - z.floor()) as f32],
                    inverse_radius: (1.0 / radius) as f32,
                    ..Instance::EVERYWHERE
                });
                let rect = SampleRect::new(
                    (x - radius).ceil() as i32,
                    (z - radius).ceil() as i32,
                    (x + radius).floor() as i32 + 1,
                    (z + radius).floor() as i32 + 1,
                );
                bounds.push(rect.intersection(&terrain));
            }
            let batch = Batch::new(pass(), layout, instances, bounds);
            let mut list = TileList::default();
            for work in &batch.pages {
                list.add_page(&batch, work, layout, PageLayers { heights: 7, scratch: 9, gate: 3 });
            }
            let mut covered = BTreeSet::new();
            for tile in &list.tiles {
                let indices = &list.indices[tile.first_index as usize..tile.end_index as usize];
                prop_assert!(indices.windows(2).all(|pair| pair[0] < pair[1]));
                for z in tile.first[1]..tile.end[1] {
                    for x in tile.first[0]..tile.end[0] {
                        let sample = (tile.page_origin[0] + x as i32, tile.page_origin[1] + z as i32);
                        prop_assert!((0..200).contains(&sample.0) && (0..140).contains(&sample.1));
                        for index in indices {
                            prop_assert!(covered.insert((sample, *index)), "{:?} twice", sample);
                        }
                    }
                }
            }
            for (index, (x, z, radius)) in dabs.iter().enumerate() {
                for j in 0..140 {
                    for i in 0..200 {
                        if (f64::from(i) - x).hypot(f64::from(j) - z) < *radius {
                            prop_assert!(covered.contains(&((i, j), index as u32)), "{i}, {j} of {index}");
                        }
                    }
                }
            }
        }
    }
}
