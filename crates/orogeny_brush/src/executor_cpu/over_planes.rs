//! Batches that act everywhere alike, over planes in memory: without pages, which they would be cut into and put together from again.

use orogeny_field::{FieldId, Plane, SampleRect, WeightMode};
use orogeny_reference::amounts;
use rayon::prelude::*;

use super::CpuExecutor;
use super::working_page::ROW_CHUNK;
use crate::Result;
use crate::filter::{self, Step};
use crate::kernels::{RowStart, Rule, apply_row};
use crate::plan::{Batch, Pass};

/// Rows that a thread takes at once.
const MIN_ROWS: usize = 16;

impl CpuExecutor {
    /// As [`crate::Executor::run_over_planes`].
    pub(super) fn over_planes(
        &mut self,
        batch: &Batch,
        fields: &[(FieldId, &Plane)],
        rect: SampleRect,
    ) -> Result<Option<Plane>> {
        let plane_of = |field: FieldId| fields.iter().find(|(of, _)| *of == field).map(|(_, plane)| *plane);
        let pass = &batch.pass;
        let Some(ground) = plane_of(pass.field) else { return Ok(None) };
        let (true, [instance]) = (is_everywhere(batch, rect), batch.instances.as_slice()) else {
            return Ok(None);
        };
        let apply = |plane: &mut Plane, part: SampleRect, goal: Option<&Plane>| {
            let width = rect.width() as usize;
            let first = part.x0.abs_diff(rect.x0) as usize;
            let of_part =
                part.z0.abs_diff(rect.z0) as usize * width..part.z1.abs_diff(rect.z0) as usize * width;
            let rows = plane.samples_mut().get_mut(of_part).unwrap_or_default().par_chunks_mut(width);
            let rows = rows.zip((part.z0..part.z1).into_par_iter()).with_min_len(MIN_ROWS);
            rows.for_each(|(row, z)| {
                let Some(row) = row.get_mut(first..first + part.width() as usize) else { return };
                row.copy_from_slice(row_from(ground, z, part.x0, row.len()));
                let goals = goal.map(|goal| row_from(goal, z, part.x0, row.len())).unwrap_or_default();
                let mut amounts = [0.0; ROW_CHUNK];
                for (number, heights) in row.chunks_mut(ROW_CHUNK).enumerate() {
                    let Some(amounts) = amounts.get_mut(..heights.len()) else { continue };
                    let from = number * ROW_CHUNK;
                    let start = RowStart { x: part.x0 + from as i32, z };
                    amounts::row(amounts, start.x, z, instance, &pass.footprint);
                    let goals = goals.get(from..from + heights.len()).unwrap_or_default();
                    apply_row(pass, instance, start, heights, amounts, goals);
                }
            });
        };
        let Rule::Filter(filter) = &pass.rule else {
            let mut plane = self.planes.memory(rect, 1);
            self.threads.install(|| apply(&mut plane, rect, None));
            return Ok(Some(plane));
        };
        let is_here = |step: &Step| match step {
            Step::Heights => true,
            Step::Field(field) => plane_of(*field).is_some(),
            _ => false,
        };
        if filter.graph.nodes().iter().any(|node| node.step.is_given() && !is_here(&node.step)) {
            return Ok(None);
        }
        let mut planes = std::mem::take(&mut self.planes);
        let mut plane = planes.memory(rect, 1);
        for block in filter::blocks(self.layout, &batch.pages, &filter.graph) {
            let there = |step: &Step| match step {
                Step::Heights => Some(ground),
                Step::Field(field) => plane_of(*field),
                _ => None,
            };
            let (graph, given) = (&filter.graph, |_: &Step, plane| Ok(plane));
            let goal = planes.work_out(&self.threads, graph, block.rect, there, given, &mut |_| true)?;
            self.threads.install(|| apply(&mut plane, block.rect, Some(&goal)));
            planes.give_back(goal);
        }
        planes.shrink_to(self.room_in_bytes(0));
        self.planes = planes;
        Ok(Some(plane))
    }
}

/// Whether a batch does the same to all of a rectangle by itself, but for what it makes of the ground.
fn is_everywhere(batch: &Batch, rect: SampleRect) -> bool {
    let Batch { pass: Pass { rule, footprint, gate, roughness, .. }, instances, bounds, .. } = batch;
    let is_one = matches!((instances.as_slice(), bounds.as_slice()), ([instance], [bound])
        if instance.inverse_radius <= 0.0 && *bound == rect);
    let is_plain = gate.is_none() && roughness.is_none() && footprint.weight_mode == WeightMode::Direct;
    // A noise keeps pages of its values, and what a user wrote is refused where it is run.
    is_one && is_plain && !matches!(rule, Rule::Noise(_) | Rule::Custom(_))
}

/// `length` samples of a row from a column on, which the plane has.
fn row_from(plane: &Plane, z: i32, x: i32, length: usize) -> &[f32] {
    let first = x.abs_diff(plane.rect().x0) as usize;
    plane.row(z).and_then(|row| row.get(first..first + length)).unwrap_or_default()
}
