//! Steps down and up a pyramid, and what is blended on its levels (Burt & Adelson 1983).
//!
//! A Laplacian blend needs two pyramids, not three: what is blended in on each level is the source's level less the ground's,
//! and steps down and up a pyramid are sums, so that difference is the level of the difference, and the ground's own levels come
//! to the ground. Where source and ground are the same nothing changes, to the bit; and so where all weights are 0.

use orogeny_field::{PYRAMID_PHASES, PYRAMID_WEIGHTS};

use super::{Axis, Graph, Step};

/// Adds `level` by the Gaussian pyramid of `mask`, level by level of its Laplacian pyramid.
pub(super) fn add_blend(
    graph: &mut Graph,
    mask: usize,
    level: usize,
    num_levels: u32,
    factor: impl Fn(u32) -> f32,
) -> usize {
    let mut levels = vec![(mask, level)];
    for _ in 0..num_levels {
        let (mask, level) = levels.last().copied().unwrap_or((mask, level));
        levels.push((reduce(graph, mask), reduce(graph, level)));
    }
    let mut below = None;
    for (number, (mask, level)) in (0..num_levels + 1).zip(&levels).rev() {
        let factor = factor(number);
        below = Some(match below {
            None => graph.add(Step::Band { factor }, &[*mask, *level]),
            Some((coarser, below)) => {
                // The other axis is the band's own: two planes less are written and read.
                let [coarser, below] = [coarser, below].map(|plane| expand_along(graph, plane, Axis::Z));
                graph.add(Step::Band { factor }, &[*mask, *level, coarser, below])
            }
        })
        .map(|below| (*level, below));
    }
    below.map_or(level, |(_, below)| below)
}

/// Adds the next level down a pyramid.
pub(super) fn reduce(graph: &mut Graph, input: usize) -> usize {
    [Axis::X, Axis::Z].into_iter().fold(input, |node, axis| {
        graph.add(Step::Convolve { axis, stride: 2, weights: PYRAMID_WEIGHTS.into() }, &[node])
    })
}

/// Adds the next level up again.
pub(super) fn expand(graph: &mut Graph, input: usize) -> usize {
    [Axis::Z, Axis::X].into_iter().fold(input, |node, axis| expand_along(graph, node, axis))
}

fn expand_along(graph: &mut Graph, input: usize, axis: Axis) -> usize {
    graph.add(Step::Interpolate { axis, phases: PYRAMID_PHASES.into() }, &[input])
}
