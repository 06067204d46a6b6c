//! Cloned ground: planned instance by instance, and blended in when the stroke has ended, by the weights of all of it.

use std::sync::Arc;

use orogeny_field::{Alignment, BrushType, CloneBlend, Footprint, Instance, SampleRect, WeightMode};
use orogeny_pages::PageStore;

use super::mean::mean_difference;
use super::prepared::{Plan, missing};
use super::{StrokePlanner, checked_num_pages};
use crate::filter::cloning::{num_levels, spread};
use crate::filter::region::{self, is_region_wide};
use crate::filter::{Filter, Graph, Weights};
use crate::kernels::Rule;
use crate::plan::{Batch, Pass};
use crate::symmetry::Image;
use crate::{Error, Result};

/// The most samples that a page of a clone may be made of: 512 MiB for each plane of them.
const MAX_WINDOW_SAMPLES: u64 = 1 << 27;

/// Instances of one image of a stroke.
#[derive(Debug)]
pub(super) struct Gathered {
    image: Image,
    instances: Vec<Instance>,
    bounds: Vec<SampleRect>,
}

impl StrokePlanner {
    /// Whether the stroke is gathered, and acts as a whole at its end.
    pub(super) fn gathers(&self) -> bool {
        let brush = &self.plan.brush;
        let is_clone =
            brush.brush_type == BrushType::Clone && brush.cloning.source.alignment != Alignment::Fixed;
        is_clone || is_region_wide(brush.brush_type)
    }

    /// Takes instances in; gives a batch that does nothing.
    pub(super) fn gather(
        &mut self,
        instances: Vec<Instance>,
        bounds: Vec<SampleRect>,
        images: impl Iterator<Item = Image>,
    ) -> Batch {
        for ((instance, bound), image) in instances.into_iter().zip(bounds).zip(images) {
            let place = match self.gathered.iter().position(|gathered| gathered.image == image) {
                Some(place) => place,
                None => {
                    self.gathered.push(Gathered { image, instances: Vec::new(), bounds: Vec::new() });
                    self.gathered.len() - 1
                }
            };
            if let Some(gathered) = self.gathered.get_mut(place) {
                gathered.instances.push(instance);
                gathered.bounds.push(bound);
            }
        }
        let nothing = Graph::new([self.plan.canvas.grid.width(), self.plan.canvas.grid.depth()]);
        let rule = Rule::Filter(Filter { graph: Arc::new(nothing), is_sequential: false });
        let pass = Pass::new(rule, Footprint::EVERYWHERE, self.plan.canvas.field);
        Batch::new(pass, self.plan.canvas.layout, Vec::new(), Vec::new())
    }

    /// The one batch of a stroke that was gathered, once it has ended.
    pub(super) fn gathered_batch(&mut self, store: &mut dyn PageStore) -> Result<Option<Batch>> {
        if !self.sampler.is_finished() || self.gathered.is_empty() {
            return Ok(None);
        }
        if is_region_wide(self.plan.brush.brush_type) {
            return self.region_batch(store).map(Some);
        }
        let source = &self.plan.brush.cloning.source;
        let spacing_m = self.plan.canvas.grid.spacing_m();
        let to_m = match source.to_m.filter(|_| source.alignment == Alignment::Aligned) {
            Some(to_m) => to_m,
            None => self.first_position.unwrap_or_default().map(|place| place * spacing_m),
        };
        let footprint = Footprint {
            falloff: self.falloff(),
            weight_mode: WeightMode::Wash,
            alpha: self.plan.resources.alpha.clone(),
            is_segment: false,
        };
        let mut images = Vec::new();
        for Gathered { image, instances, bounds } in std::mem::take(&mut self.gathered) {
            let gate = self.plan.gate.clone();
            images.push((image, Weights { footprint: footprint.clone(), instances, bounds, gate }));
        }
        self.plan.cloned(to_m, images, store).map(Some)
    }

    /// The one batch of a stroke that works on a whole region at once: all that it reaches.
    fn region_batch(&mut self, store: &mut dyn PageStore) -> Result<Batch> {
        let mut pass = self.pass(store)?;
        let (mut instances, mut bounds) = (Vec::new(), Vec::new());
        for gathered in std::mem::take(&mut self.gathered) {
            instances.extend(gathered.instances);
            bounds.extend(gathered.bounds);
        }
        let rect = bounds.iter().fold(SampleRect::EMPTY, |all, bound| all.bounds_with(bound));
        let rect = region::of_stroke(&self.plan.brush, &self.plan.canvas, rect)?;
        if let Some(filter) = self.plan.of_region(rect)? {
            pass.rule = Rule::Filter(filter);
        }
        Ok(Batch::new(pass, self.plan.canvas.layout, instances, bounds))
    }

    /// What an instance at a place in samples makes of the ground with a source that is fixed to its centre.
    pub(super) fn fixed_clone(&self, image: &Image, centre: [f64; 2]) -> Result<Filter> {
        let grid = &self.plan.canvas.grid;
        let laid = self.plan.laid(centre.map(|place| place * grid.spacing_m()), image)?;
        let mut graph = Graph::new([grid.width(), grid.depth()]);
        laid.add_blended(&mut graph, Graph::HEIGHTS, &self.plan.brush.cloning, None);
        Ok(Filter { graph: Arc::new(graph), is_sequential: true })
    }
}

impl Plan {
    /// The batch of cloned ground whose place comes to lie at `to_m`, and of its images, by their weights.
    pub(super) fn cloned(
        &self,
        to_m: [f64; 2],
        images: Vec<(Image, Weights)>,
        store: &mut dyn PageStore,
    ) -> Result<Batch> {
        let (cloning, grid) = (&self.brush.cloning, &self.canvas.grid);
        let extent = [grid.width(), grid.depth()];
        let mut graph = Graph::new(extent);
        let (mut ground, mut bounds) = (Graph::HEIGHTS, Vec::new());
        for (image, mut weights) in images {
            let mut laid = self.laid(to_m, &image)?;
            // Where there is nothing to be copied nothing is looked at.
            let there = laid.bounds(graph.extent());
            weights.bounds.iter_mut().for_each(|bound| *bound = bound.intersection(&there));
            if cloning.blend == CloneBlend::MeanShifted {
                let difference = mean_difference(&laid, &weights, &self.canvas, store)?;
                let [_, offset_m] = &mut laid.heights;
                *offset_m += difference as f32;
            }
            let rect = weights.rect();
            let bound = rect.grown(spread(num_levels(cloning, &rect, extent))).intersection(&grid.bounds());
            checked_num_pages(self.canvas.layout, bound)?;
            bounds.push(bound);
            ground = laid.add_blended(&mut graph, ground, cloning, Some(weights));
        }
        // The least that can be worked on at once: a page.
        let page = self.canvas.layout.size().cast_signed();
        let first = |bound: &SampleRect| SampleRect { x1: bound.x0 + page, z1: bound.z0 + page, ..*bound };
        let num_samples = bounds.iter().map(|bound| graph.largest(first(bound).intersection(bound))).max();
        let num_samples = num_samples.unwrap_or_default();
        if num_samples > MAX_WINDOW_SAMPLES {
            return Err(Error::CloneSize { num_samples, limit: MAX_WINDOW_SAMPLES });
        }
        Ok(self.settled(Filter { graph: Arc::new(graph), is_sequential: false }, bounds, None))
    }

    /// Where a clone comes to lie that has no stroke to say so.
    pub(super) fn given_place(&self) -> Result<[f64; 2]> {
        let why = "a fill has no stroke on whose first point the source could come to lie";
        self.brush.cloning.source.to_m.ok_or_else(|| missing(&self.brush, "source.to", why))
    }
}
