//! Pages put together into rectangles whose goals are worked out at once.

use std::collections::BTreeMap;

use orogeny_field::{PageLayout, SampleRect};

use super::Graph;
use crate::plan::PageWork;

/// Samples a side after which a block is cut, unless the filter's halo asks for more.
const BLOCK_SIDE: u32 = 1024;
/// A block is so many times as long as the halo about it, if that is more.
const HALOS_A_SIDE: u32 = 24;
/// Values that a plane of a block has at most, if a page allows: WebGPU binds 128 MiB at once by default.
const MAX_VALUES: u64 = 5632 * 5632;

/// Pages whose goals are worked out at once.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// The samples that may change.
    pub rect: SampleRect,
    /// In the order of their keys.
    pub pages: Vec<PageWork>,
}

/// Puts pages together into blocks, so that the halo of a graph is read once for pages side by side: up to a number of samples a
/// side that is some times the halo, or as many as can be worked on at once.
#[must_use]
pub fn blocks(layout: PageLayout, pages: &[PageWork], graph: &Graph) -> Vec<Block> {
    let bounds = pages.iter().fold(SampleRect::EMPTY, |all, work| all.bounds_with(&work.rect));
    let side = side(graph, &bounds) / layout.size();
    let side = side.max(1);
    let mut cells = BTreeMap::<(u32, u32), Block>::new();
    for work in pages {
        let cell = cells
            .entry((work.key.z / side, work.key.x / side))
            .or_insert_with(|| Block { rect: SampleRect::EMPTY, pages: Vec::new() });
        cell.rect = cell.rect.bounds_with(&work.rect);
        cell.pages.push(work.clone());
    }
    cells.into_values().collect()
}

/// How many samples a side of `bounds` may be worked on at once.
fn side(graph: &Graph, bounds: &SampleRect) -> u32 {
    let wanted = BLOCK_SIDE.max(graph.halo().saturating_mul(HALOS_A_SIDE));
    let longest = bounds.width().max(bounds.depth());
    let mut side = longest.min(wanted);
    let fits = |side: u32| {
        let middle = |first: i32, end: i32| first + (end - first - side.cast_signed().min(end - first)) / 2;
        let (x, z) = (middle(bounds.x0, bounds.x1), middle(bounds.z0, bounds.z1));
        let rect = SampleRect::new(x, z, x + side.cast_signed(), z + side.cast_signed()).intersection(bounds);
        graph.largest(rect) <= MAX_VALUES
    };
    while side > 1 && !fits(side) {
        side -= side.div_ceil(8);
    }
    // All of it is one block, wherever its pages begin.
    if side == longest { u32::MAX } else { side }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::{Axis, Step};
    use orogeny_field::{FieldId, PageKey};

    #[test]
    fn every_page_is_in_one_block_that_holds_its_rectangle() {
        let layout = PageLayout::new(64).unwrap();
        let terrain = SampleRect::new(10, 7, 1900, 2500);
        let pages: Vec<_> = (0..40)
            .flat_map(|z| (0..30).map(move |x| PageKey::full_resolution(FieldId(1), x, z)))
            .filter(|key| (key.x + key.z) % 3 != 0)
            .map(|key| PageWork {
                key,
                rect: layout.page_rect(&key).intersection(&terrain),
                instances: vec![key.x],
            })
            .collect();
        for halo in [0, 5, 300, 2400] {
            let mut graph = Graph::new([1900, 20_000]);
            let weights = vec![0.0; halo as usize].into();
            graph.add(Step::Convolve { axis: Axis::X, stride: 1, weights }, &[Graph::HEIGHTS]);
            let blocks = blocks(layout, &pages, &graph);
            let mut found: Vec<_> = blocks.iter().flat_map(|block| block.pages.clone()).collect();
            found.sort_by_key(|work| work.key);
            let mut expected = pages.clone();
            expected.sort_by_key(|work| work.key);
            assert_eq!(found, expected);
            for Block { rect, pages } in &blocks {
                let longest = rect.width().max(rect.depth());
                assert!(longest <= BLOCK_SIDE.max(HALOS_A_SIDE * halo));
                assert!(graph.largest(*rect) <= MAX_VALUES);
                assert!(pages.iter().all(|work| rect.contains(&work.rect)));
                assert!(pages.is_sorted_by_key(|work| work.key));
            }
        }
    }
}
