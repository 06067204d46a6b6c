//! What a neighbourhood kernel works out, as plain data: planes, each made from others by one step.
//!
//! A graph knows nothing of pages. [`Graph::plan`] finds for each plane the rectangle that it must have so that the last one has the
//! rectangle that is asked for. No rectangle occurs in the rule by which a value is made of those below it; so it has the
//! same bits, whichever rectangle it is worked out with.
//!
//! What is given is mirrored at the terrain's border. All other planes go on beyond it, made of what is mirrored, as though the
//! terrain had no end: so each level of a pyramid is that of the mirrored terrain, whatever its size. What a symmetric filter makes
//! is mirrored too, to the bit, and made only once ([`Step::mirrors`]).

use orogeny_field::{Mirrors, SampleRect};

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
    mirrors: Mirrors,
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
                mirrors: Mirrors::of_extent(extent),
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
        let first = inputs.first().map_or(Mirrors::NONE, |input| self.mirrors(*input));
        let mirrors = step.mirrors(self.extent, first);
        self.nodes.push(Node { step, inputs: inputs.to_vec(), last_reader: place, num_readers: 0, mirrors });
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

    /// Where what a plane is a part of is mirrored.
    #[must_use]
    pub fn mirrors(&self, place: usize) -> Mirrors {
        self.nodes.get(place).map_or(Mirrors::NONE, |node| node.mirrors)
    }

    /// For each plane the rectangle that it must have for the last one to have `target`; of one that is mirrored only what is shown
    /// by its mirrors.
    #[must_use]
    pub fn plan(&self, target: SampleRect) -> Vec<SampleRect> {
        let [width, depth] = self.extent;
        self.plan_on(Some(SampleRect::new(0, 0, width.cast_signed(), depth.cast_signed())), target)
    }

    /// The same; without a terrain, as though none of its borders were near.
    fn plan_on(&self, terrain: Option<SampleRect>, target: SampleRect) -> Vec<SampleRect> {
        let mut rects = vec![SampleRect::EMPTY; self.nodes.len()];
        if let Some(last) = rects.last_mut() {
            *last = target;
        }
        for (place, node) in self.nodes.iter().enumerate().rev() {
            let Some(known) = rects.get_mut(place).filter(|rect| !rect.is_empty()) else { continue };
            // All that read it come after it.
            if terrain.is_some() {
                *known = node.mirrors.shown(known);
            }
            let rect = *known;
            for (number, input) in node.inputs.iter().enumerate() {
                let needed = node.step.source_rect(&rect, number);
                let needed = match &terrain {
                    Some(terrain) if node.step.is_closed() => needed.intersection(terrain),
                    _ => needed,
                };
                if let Some(known) = rects.get_mut(*input) {
                    *known = known.bounds_with(&needed);
                }
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
        // Far from the first sample, about one of the coarsest grid.
        let far = 1 << 28;
        let rects = self.plan_on(None, SampleRect::new(far - 1, far - 1, far + 1, far + 1));
        let reach = |rect: &SampleRect| [far - rect.x0, rect.x1 - far, far - rect.z0, rect.z1 - far];
        // Where the heights are not read at all there is none.
        let heights = rects.first().filter(|rect| !rect.is_empty());
        heights.and_then(|rect| reach(rect).into_iter().max()).unwrap_or_default().unsigned_abs()
    }
}
