//! Grabbed ground: moved by the way from the stroke's first point to its last, with its copies in mirrors.

use orogeny_field::{Drag, Falloff, GrabKernel};
use orogeny_reference::falloff;

use super::{StrokePlanner, bounds_of, checked_num_pages, placed};
use crate::Result;
use crate::filter;
use crate::plan::Batch;
use crate::symmetry;

impl StrokePlanner {
    /// The one batch of what is grabbed, once the stroke has ended.
    pub(super) fn grab(&mut self) -> Result<Option<Batch>> {
        let (Some([x, z]), Some([end_x, end_z])) = (self.first_position, self.last_position) else {
            return Ok(None);
        };
        if !self.sampler.is_finished() || std::mem::replace(&mut self.is_given, true) {
            return Ok(None);
        }
        // Where an instance would be left out there is nothing to be taken along.
        if self.radius < 0.5 {
            return Ok(None);
        }
        let (brush, grid) = (&self.plan.brush, &self.plan.canvas.grid);
        let way = [(end_x - x) * brush.strength, (end_z - z) * brush.strength];
        let (mut drags, mut bounds) = (Vec::new(), Vec::new());
        for (image, [x, z]) in symmetry::places(&self.images, [x, z]) {
            let [way_x, way_z] = image.way(way);
            let bound =
                bounds_of([x, z], self.radius).bounds_with(&bounds_of([x + way_x, z + way_z], self.radius));
            let bound = bound.intersection(&grid.bounds());
            checked_num_pages(self.plan.canvas.layout, bound)?;
            let dab = placed([x, z], self.radius, grid.spacing_m());
            drags.push(Drag {
                cell: dab.cell,
                fraction: dab.fraction,
                way: [way_x as f32, way_z as f32],
                inverse_radius: dab.inverse_radius,
                padding: 0.0,
            });
            bounds.push(bound);
        }
        let profile = Falloff::from(brush.profile());
        let kernel = GrabKernel::new(drags, |r| falloff::weight(r, &profile));
        Ok(Some(self.plan.settled(filter::grab::filter(grid, kernel), bounds, self.plan.gate.clone())))
    }
}
