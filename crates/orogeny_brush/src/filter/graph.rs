//! What a neighbourhood kernel works out, as plain data: planes, each made from others by one step.
//!
//! A graph knows nothing of pages. [`Graph::plan`] finds for each plane the rectangle that it must have so that the last one has the
//! rectangle that is asked for. No rectangle occurs in the rule by which a value is made of those below it; so it has the
//! same bits, whichever rectangle it is worked out with.
//!
//! Only what is given is mirrored at the terrain's border. All other planes go on beyond it, made of what is mirrored, as
//! though the terrain had no end: so each level of a pyramid is that of the mirrored terrain, whatever its size.

use orogeny_field::{SampleRect, mirrored};

use super::Step;

/// A plane of a graph.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// How its values are made.
    pub step: Step,
    /// Of which planes: their places in the graph, before its own.
    pub inputs: Vec<usize>,
    /// The last place that is made of it; its own, where none is.
    last_reader: usize,
    num_readers: usize,
}

/// Planes, each after those that it is made of; the last is the result.
#[derive(Debug, Clone, PartialEq)]
pub struct Graph {
    extent: [u32; 2],
    nodes: Vec<Node>,
}

impl Graph {
    /// The place of the heights.
    pub const HEIGHTS: usize = 0;

    /// A graph of heights of a terrain of `extent` samples, and nothing made of them.
    #[must_use]
    pub fn new(extent: [u32; 2]) -> Self {
        Self {
            extent,
            nodes: vec![Node {
                step: Step::Heights,
                inputs: Vec::new(),
                last_reader: Self::HEIGHTS,
                num_readers: 0,
            }],
        }
    }

    /// Adds a plane made of others that are there; gives its place.
    pub fn add(&mut self, step: Step, inputs: &[usize]) -> usize {
        debug_assert!(inputs.iter().all(|input| *input < self.nodes.len()), "{inputs:?}");
        let place = self.nodes.len();
        for input in inputs {
            if let Some(input) = self.nodes.get_mut(*input) {
                input.last_reader = place;
                input.num_readers += 1;
            }
        }
        self.nodes.push(Node { step, inputs: inputs.to_vec(), last_reader: place, num_readers: 0 });
        place
    }

    /// The planes that no place after this one is made of, and this one is.
    pub fn done_with(&self, place: usize) -> impl Iterator<Item = usize> + '_ {
        let inputs = self.nodes.get(place).map(|node| node.inputs.as_slice()).unwrap_or_default();
        let is_done =
            move |input: &usize| self.nodes.get(*input).is_some_and(|node| node.last_reader == place);
        inputs.iter().copied().filter(is_done)
    }

    /// Whether a plane is one axis of a filter of which only the other axis is made: it need never be whole.
    #[must_use]
    pub fn is_passing(&self, place: usize) -> bool {
        // What it is made of is kept until it is read, so it is read at once.
        let is_passed_on = |node: &&Node| node.num_readers == 1 && node.last_reader == place + 1;
        let Some(node) = self.nodes.get(place).filter(is_passed_on) else { return false };
        let next = self.nodes.get(node.last_reader).and_then(|reader| reader.step.filtered_axis());
        let (Some(axis), Some(next)) = (node.step.filtered_axis(), next) else { return false };
        // Planes that pass do not read others that do.
        axis != next && node.inputs.iter().all(|input| !self.is_passing(*input))
    }

    /// The planes, each after those that it is made of.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Samples of the terrain along x and z.
    #[must_use]
    pub const fn extent(&self) -> [u32; 2] {
        self.extent
    }

    /// Samples along x and z of what a plane is a part of, if that is given and mirrored at its border.
    #[must_use]
    pub fn given_extent(&self, place: usize) -> Option<[u32; 2]> {
        self.nodes.get(place)?.step.given_extent(self.extent)
    }

    /// For each plane the rectangle that it must have for the last one to have `target`; one that is given stays within the
    /// terrain.
    #[must_use]
    pub fn plan(&self, target: SampleRect) -> Vec<SampleRect> {
        self.plan_on(self.extent, target)
    }

    /// The same on a terrain of another size.
    fn plan_on(&self, [width, depth]: [u32; 2], target: SampleRect) -> Vec<SampleRect> {
        let terrain = SampleRect::new(0, 0, width.cast_signed(), depth.cast_signed());
        let mut rects = vec![SampleRect::EMPTY; self.nodes.len()];
        if let Some(last) = rects.last_mut() {
            *last = target;
        }
        for (place, node) in self.nodes.iter().enumerate().rev() {
            let Some(rect) = rects.get(place).copied().filter(|rect| !rect.is_empty()) else { continue };
            for (number, input) in node.inputs.iter().enumerate() {
                let needed = node.step.source_rect(&rect, number);
                let needed = if node.step.is_closed() { needed.intersection(&terrain) } else { needed };
                if let Some(known) = rects.get_mut(*input) {
                    *known = known.bounds_with(&needed);
                }
            }
        }
        for (node, rect) in self.nodes.iter().zip(&mut rects) {
            if let Some([width, depth]) = node.step.given_extent([width, depth])
                && !rect.is_empty()
            {
                let (x0, x1) = mirrored_range(rect.x0, rect.x1, width);
                let (z0, z1) = mirrored_range(rect.z0, rect.z1, depth);
                *rect = SampleRect::new(x0, z0, x1, z1);
            }
        }
        rects
    }

    /// How many values the largest plane has, for the last one to have `target`.
    #[must_use]
    pub fn largest(&self, target: SampleRect) -> u64 {
        let values = |(node, rect): (&Node, SampleRect)| rect.area() * u64::from(node.step.num_channels());
        self.nodes.iter().zip(self.plan(target)).map(values).max().unwrap_or_default()
    }

    /// How many samples beyond its result the heights are read, at most.
    #[must_use]
    pub fn halo(&self) -> u32 {
        // Far from a border, about a sample of the coarsest grid.
        let (far, extent) = (1 << 28, [1 << 29; 2]);
        let rects = self.plan_on(extent, SampleRect::new(far - 1, far - 1, far + 1, far + 1));
        let reach = |rect: &SampleRect| [far - rect.x0, rect.x1 - far, far - rect.z0, rect.z1 - far];
        // Where the heights are not read at all there is none.
        let heights = rects.first().filter(|rect| !rect.is_empty());
        heights.and_then(|rect| reach(rect).into_iter().max()).unwrap_or_default().unsigned_abs()
    }
}

/// The samples of a grid that `first..end` are once it is mirrored at its ends: first and one past the last.
fn mirrored_range(first: i32, end: i32, num_samples: u32) -> (i32, i32) {
    let last = num_samples.saturating_sub(1).cast_signed();
    if last == 0 {
        return (0, 1);
    }
    // A piece between two mirrors keeps its order, so its ends are ends; a mirror within the range is an end too.
    let (a, b) = (mirrored(first, num_samples), mirrored(end - 1, num_samples));
    let mut bounds = (a.min(b), a.max(b));
    let fold = first.div_euclid(last);
    for fold in [fold + 1, fold + 2] {
        if fold.saturating_mul(last) < end {
            let place = mirrored(fold * last, num_samples);
            bounds = (bounds.0.min(place), bounds.1.max(place));
        }
    }
    (bounds.0, bounds.1 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_mirrored_range_holds_what_its_samples_are_and_no_more(
            num_samples in 1_u32..40, first in -100_i32..100, length in 1_i32..120,
        ) {
            let places: Vec<_> = (first..first + length).map(|place| mirrored(place, num_samples)).collect();
            let expected = (*places.iter().min().unwrap(), places.iter().max().unwrap() + 1);
            prop_assert_eq!(mirrored_range(first, first + length, num_samples), expected);
        }
    }
}
