//! Cloned ground: laid on the terrain, and blended in by a stroke's weights.

use std::sync::Arc;

use orogeny_field::{CloneBlend, Cloning, FieldId, Part, Placement, Plane, SampleRect};

use super::{Filter, Graph, Step, Weights, pyramid};

/// Samples of the shorter side of what is painted, on a pyramid's coarsest level.
const COARSEST_SAMPLES: u32 = 8;

/// The most levels where none are asked for: each doubles what must be looked at around, which is then 4,096 samples.
const MAX_USUAL_LEVELS: u32 = 10;

/// Where cloned ground comes from.
#[derive(Debug, Clone)]
pub enum CloneGround {
    /// A field of the same terrain.
    Field(FieldId),
    /// Data from outside.
    Raster {
        /// From sample (0, 0) on.
        heights: Arc<Plane>,
        /// Metres between its samples.
        spacing_m: f64,
    },
}

/// Another ground as it comes to lie on the terrain.
#[derive(Debug, Clone)]
pub(crate) struct Laid<'a> {
    pub(crate) ground: &'a CloneGround,
    pub(crate) placement: Placement,
    /// What its heights are multiplied by, and what is added to them then, metres.
    pub(crate) heights: [f32; 2],
    /// The part of it that is copied, in its samples; `None`: all of it.
    pub(crate) region: Option<SampleRect>,
    /// Over how many of its samples that part begins at its edges.
    pub(crate) feather: f64,
    /// The selection without which nothing of it counts.
    pub(crate) selection: Option<FieldId>,
}

impl Laid<'_> {
    /// Adds it as a plane.
    fn add(&self, graph: &mut Graph) -> usize {
        let given = match self.ground {
            CloneGround::Field(field) => Step::Field(*field),
            CloneGround::Raster { heights, .. } => Step::Raster(Arc::clone(heights)),
        };
        let mut node = graph.add(given, &[]);
        // Where samples come to lie closer together than the terrain's, on the level of the pyramid where they do not.
        let num_levels = self.placement.samples_between().max(1.0).log2().floor() as u32;
        for _ in 0..num_levels {
            node = pyramid::reduce(graph, node);
        }
        let placement = self.placement.on_level(num_levels);
        graph.add(Step::Resample { placement, heights: self.heights }, &[node])
    }

    /// The samples of it that are copied.
    pub(crate) fn copied(&self, extent: [u32; 2]) -> SampleRect {
        let [width, depth] = match self.ground {
            CloneGround::Field(_) => extent,
            CloneGround::Raster { heights, .. } => [heights.rect().width(), heights.rect().depth()],
        };
        let all = SampleRect::new(0, 0, width.cast_signed(), depth.cast_signed());
        self.region.map_or(all, |region| region.intersection(&all))
    }

    /// The samples of a terrain of `extent` where there may be anything of it.
    pub(crate) fn bounds(&self, extent: [u32; 2]) -> SampleRect {
        self.placement.terrain_rect(&self.copied(extent))
    }

    /// Adds where there is anything of it, if that is not all of `rect`.
    fn add_cover(&self, graph: &mut Graph, rect: &SampleRect) -> Option<usize> {
        let copied = self.copied(graph.extent());
        let has_soft_edges = self.feather > 0.0 || self.selection.is_some();
        if !has_soft_edges && copied.contains(&self.placement.source_rect(rect)) {
            return None;
        }
        let part = Part {
            first: [copied.x0, copied.z0],
            last: [copied.x1 - 1, copied.z1 - 1],
            inverse_feather: if self.feather > 0.0 { (1.0 / self.feather) as f32 } else { 0.0 },
            padding: 0,
        };
        let selection = self.selection.map(|field| graph.add(Step::Field(field), &[]));
        let inputs: Vec<_> = selection.into_iter().collect();
        Some(graph.add(Step::Cover { placement: self.placement, part }, &inputs))
    }

    /// Adds the ground pulled to it by the whole of `weights`, or wherever it is.
    pub(crate) fn add_blended(
        &self,
        graph: &mut Graph,
        ground: usize,
        cloning: &Cloning,
        weights: Option<Weights>,
    ) -> usize {
        let whole = SampleRect::new(0, 0, graph.extent()[0].cast_signed(), graph.extent()[1].cast_signed());
        let rect = weights.as_ref().map_or(whole, Weights::rect);
        let source = self.add(graph);
        let cover = self.add_cover(graph, &rect);
        let weights = weights.map(|weights| graph.add(Step::Weights(Arc::new(weights)), &[]));
        let mask = match (weights, cover) {
            (Some(weights), Some(cover)) => graph.add(Step::Band { factor: 1.0 }, &[weights, cover]),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => return source,
        };
        if cloning.blend != CloneBlend::Laplacian {
            return graph.add(Step::Lerp, &[ground, source, mask]);
        }
        let difference = graph.add(Step::Combine { factors: [1.0, -1.0] }, &[source, ground]);
        let factor = |level| cloning.level_weight(level) as f32;
        let change =
            pyramid::add_blend(graph, mask, difference, num_levels(cloning, &rect, graph.extent()), factor);
        graph.add(Step::Combine { factors: [1.0, 1.0] }, &[ground, change])
    }
}

/// Blends a field into the ground of a terrain of `extent` samples band by band of their Laplacian pyramids, by a field of weights:
/// a layer that is joined so to what is below it.
#[must_use]
pub fn blend_fields(extent: [u32; 2], heights: FieldId, weights: FieldId, num_levels: u32) -> Filter {
    let mut graph = Graph::new(extent);
    let source = graph.add(Step::Field(heights), &[]);
    let mask = graph.add(Step::Field(weights), &[]);
    let difference = graph.add(Step::Combine { factors: [1.0, -1.0] }, &[source, Graph::HEIGHTS]);
    let change = pyramid::add_blend(&mut graph, mask, difference, num_levels, |_| 1.0);
    graph.add(Step::Combine { factors: [1.0, 1.0] }, &[Graph::HEIGHTS, change]);
    Filter { graph: Arc::new(graph), is_sequential: false }
}

/// How many levels below the finest a clone is blended in on, by what is painted; on none beyond the first that has the whole of
/// a terrain of `extent` samples in one, since each doubles what must be looked at around.
pub(crate) fn num_levels(cloning: &Cloning, rect: &SampleRect, extent: [u32; 2]) -> u32 {
    if cloning.blend != CloneBlend::Laplacian {
        return 0;
    }
    let longest = extent.into_iter().max().unwrap_or_default().max(1);
    let most = longest.next_power_of_two().ilog2();
    let wanted = cloning.num_levels.unwrap_or_else(|| {
        let shorter = rect.width().min(rect.depth());
        let is_short = |level: &u32| shorter.div_ceil(1 << level) <= COARSEST_SAMPLES;
        (0..MAX_USUAL_LEVELS).find(is_short).unwrap_or(MAX_USUAL_LEVELS)
    });
    wanted.min(most)
}

/// How many samples beyond its weights a blend on that many levels may change the ground.
pub(crate) const fn spread(num_levels: u32) -> i32 {
    if num_levels == 0 { 0 } else { 1 << (num_levels + 2) }
}
