//! A noise over a page, worked out block by block.

use std::collections::BTreeSet;

use orogeny_field::noise::{LATTICE_BLOCK, NoiseFrame, NoiseKernel};
use orogeny_field::{Page, PageLayout, SampleRect};
use orogeny_reference::noise::LANES;
use orogeny_reference::noise::row::{self, LatticeBlock};

/// A noise that does not depend on the instance, worked out once for each lattice block of a page.
#[derive(Debug)]
pub(crate) struct Pattern {
    values: Page,
    known: BTreeSet<(u32, u32)>,
}

impl Pattern {
    /// None of it known yet.
    pub(crate) fn new(layout: PageLayout) -> Self {
        Self { values: Page::constant(layout, 0.0), known: BTreeSet::new() }
    }

    /// The values, as far as they were worked out.
    pub(crate) const fn values(&self) -> &Page {
        &self.values
    }

    /// Works out the blocks of a rectangle that are not known yet.
    pub(crate) fn work_out(
        &mut self,
        kernel: &NoiseKernel,
        frame: &NoiseFrame,
        roughness: Option<&Page>,
        rect: &SampleRect,
        page_rect: &SampleRect,
    ) {
        let block = LATTICE_BLOCK.cast_signed();
        let mut row = [0.0; LANES];
        for block_z in rect.z0.div_euclid(block)..=(rect.z1 - 1).div_euclid(block) {
            for block_x in rect.x0.div_euclid(block)..=(rect.x1 - 1).div_euclid(block) {
                let [x, z] =
                    [(block_x * block).abs_diff(page_rect.x0), (block_z * block).abs_diff(page_rect.z0)];
                if !self.known.insert((x, z)) {
                    continue;
                }
                let lattice = LatticeBlock::around([block_x * block, block_z * block], kernel, frame);
                for within in 0..LATTICE_BLOCK {
                    let rough = roughness
                        .and_then(|page| page.row(z + within, x, x + LATTICE_BLOCK)?.first_chunk::<LANES>());
                    row::block_row(&mut row, within, kernel, &lattice, rough);
                    if let Some(values) = self.values.row_mut(z + within, x, x + LATTICE_BLOCK) {
                        values.copy_from_slice(&row);
                    }
                }
            }
        }
    }
}
