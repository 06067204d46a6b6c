//! Ramps: one instance from a stroke's first point to its last.

use orogeny_field::Instance;
use orogeny_pages::PageStore;

use super::prepared::missing;
use super::{StrokePlanner, bounds_of, checked_num_pages, placed};
use crate::Result;
use crate::plan::Batch;

impl StrokePlanner {
    /// A ramp's one batch, once the stroke has ended.
    pub(super) fn ramp(&mut self, store: &mut dyn PageStore) -> Result<Option<Batch>> {
        let (Some(start), Some(end)) = (self.first_position, self.last_position) else { return Ok(None) };
        if !self.sampler.is_finished() || std::mem::replace(&mut self.is_given, true) {
            return Ok(None);
        }
        let brush = &self.plan.brush;
        let length = crate::curve::distance(start, end);
        if length < 1.0 {
            return Err(missing(
                brush,
                "points",
                "a ramp leads from the stroke's first point to its last, a sample away or more",
            ));
        }
        let ends = [(start, brush.height_m), (end, brush.end_height_m)];
        let mut heights_m = [0.0; 2];
        for (height_m, (place, given)) in heights_m.iter_mut().zip(ends) {
            *height_m = match given {
                Some(given) => given,
                None => self.probe.height_m(store, place)?,
            };
        }
        let [reference_height_m, end_height_m] = heights_m;
        let (mut instances, mut bounds) = (Vec::new(), Vec::new());
        for image in &self.images {
            let (start, end) = (image.place(start), image.place(end));
            let bound = bounds_of(start, self.radius).bounds_with(&bounds_of(end, self.radius));
            let bound = bound.intersection(&self.plan.canvas.grid.bounds());
            checked_num_pages(self.plan.canvas.layout, bound)?;
            let ([x, z], [end_x, end_z]) = (start, end);
            instances.push(Instance {
                amplitude: self.plan.brush.strength as f32,
                reference_height_m,
                end_height_m,
                segment: [(end_x - x) as f32, (end_z - z) as f32],
                inverse_segment_squared: (1.0 / (length * length)) as f32,
                ..placed(start, self.radius, self.plan.canvas.grid.spacing_m())
            });
            bounds.push(bound);
        }
        let pass = self.pass(store)?;
        Ok(Some(Batch::new(pass, self.plan.canvas.layout, instances, bounds)))
    }
}
