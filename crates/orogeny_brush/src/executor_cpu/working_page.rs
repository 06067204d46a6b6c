//! A page while an operation works on it: its heights and what a wash, gates and values keep beside them.

use orogeny_field::{Instance, Page, PageKey, PageLayout, Plane, SampleRect, WeightMode};
use orogeny_reference::amounts;
use orogeny_reference::noise::row;

use crate::gate::{GateInput, GatePlan};
use crate::kernels::{RowStart, Rule, apply_row};
use crate::pattern::Pattern;
use crate::plan::{Batch, PageWork, Pass};

/// Samples of a row that are worked at once: their amounts stay in the first-level cache.
pub(super) const ROW_CHUNK: usize = 256;

/// A page during an operation.
#[derive(Debug)]
pub(super) struct WorkingPage {
    pub(super) heights: Page,
    pub(super) wash: Option<Wash>,
    pub(super) gate: Gating,
    /// How rough a noise is there.
    pub(super) roughness: Gating,
    /// The noise at each of its samples, where all instances have the same.
    pub(super) pattern: Option<Pattern>,
}

/// What a wash keeps beside a page.
#[derive(Debug)]
pub(super) struct Wash {
    pub(super) before: Page,
    pub(super) weights: Page,
}

/// What is known of where a brush may act on a page.
#[derive(Debug)]
pub(super) enum Gating {
    /// Everywhere.
    Open,
    /// What its weights are to be made of.
    Loaded(GateInput),
    Weights(Page),
}

/// Whether the noise of a pass is the same for all instances, so that a page keeps it.
pub(super) fn has_pattern(pass: &Pass) -> bool {
    matches!(&pass.rule, Rule::Noise(kernel) if kernel.is_shared())
}

/// How many pages' memory a page takes while a pass works on it.
pub(super) fn num_held_for(pass: &Pass) -> usize {
    let wash = if pass.weight_mode() == WeightMode::Wash { 2 } else { 0 };
    let gates = usize::from(pass.gate.is_some()) + usize::from(pass.roughness.is_some());
    1 + wash + gates + usize::from(has_pattern(pass))
}

impl WorkingPage {
    /// How many pages' memory it takes.
    pub(super) const fn num_held(&self) -> usize {
        let wash = if self.wash.is_some() { 2 } else { 0 };
        let pattern = if self.pattern.is_some() { 1 } else { 0 };
        1 + wash + self.gate.num_held() + self.roughness.num_held() + pattern
    }

    /// Applies the batch's instances to the page; returns the number of clamped heights.
    pub(super) fn apply(
        &mut self,
        batch: &Batch,
        work: &PageWork,
        goal: Option<&Plane>,
        layout: PageLayout,
    ) -> u64 {
        let page_rect = layout.page_rect(&work.key);
        self.gate.work_out(batch.pass.gate.as_deref(), &work.key, layout);
        self.roughness.work_out(batch.pass.roughness.as_deref(), &work.key, layout);
        if let (Some(pattern), Rule::Noise(kernel)) = (&mut self.pattern, &batch.pass.rule)
            && let Some(frame) = batch.frames.first()
        {
            pattern.work_out(kernel, frame, self.roughness.weights(), &work.rect, &page_rect);
        }
        let instances = work.instances.iter().filter_map(|index| {
            let index = *index as usize;
            Some((batch.instances.get(index)?, batch.bounds.get(index)?.intersection(&page_rect)))
        });
        let site = Site {
            batch,
            page_rect,
            gate: self.gate.weights(),
            roughness: self.roughness.weights(),
            pattern: self.pattern.as_ref(),
            goal,
        };
        match &mut self.wash {
            None => {
                let mut num_clamped = 0;
                for (instance, rect) in instances {
                    let heights = &mut self.heights;
                    site.for_each_row(heights, instance, &rect, |start, heights, amounts| {
                        num_clamped += u64::from(site.apply_row(instance, start, heights, amounts));
                    });
                }
                num_clamped
            }
            Some(wash) => {
                for (instance, rect) in instances {
                    let weights = &mut wash.weights;
                    site.for_each_row(weights, instance, &rect, |_, weights, amounts| {
                        amounts::gather(weights, amounts, instance.flow);
                    });
                }
                wash.apply(&mut self.heights, &site, work)
            }
        }
    }
}

impl Gating {
    /// Makes weights of what was loaded.
    fn work_out(&mut self, plan: Option<&GatePlan>, key: &PageKey, layout: PageLayout) {
        if let (Self::Loaded(input), Some(plan)) = (&*self, plan) {
            *self = Self::Weights(plan.page(key, layout, input));
        }
    }

    const fn weights(&self) -> Option<&Page> {
        match self {
            Self::Weights(weights) => Some(weights),
            Self::Open | Self::Loaded(_) => None,
        }
    }

    /// How many pages' memory it takes.
    const fn num_held(&self) -> usize {
        if matches!(self, Self::Open) { 0 } else { 1 }
    }
}

/// What is the same for all rows of a page.
struct Site<'a> {
    batch: &'a Batch,
    page_rect: SampleRect,
    gate: Option<&'a Page>,
    roughness: Option<&'a Page>,
    pattern: Option<&'a Pattern>,
    goal: Option<&'a Plane>,
}

impl Site<'_> {
    /// Multiplies a row's amounts by what its gate lets through.
    fn let_through(&self, start: RowStart, amounts: &mut [f32]) {
        if let Some(weights) = self.gate.and_then(|page| self.row_of(page, start, amounts.len())) {
            amounts::let_through(amounts, weights);
        }
    }

    fn row_of<'p>(&self, page: &'p Page, start: RowStart, length: usize) -> Option<&'p [f32]> {
        let first = start.x.abs_diff(self.page_rect.x0);
        page.row(start.z.abs_diff(self.page_rect.z0), first, first + length as u32)
    }

    /// Applies the kernel to a row of at most [`ROW_CHUNK`] samples.
    fn apply_row(&self, instance: &Instance, start: RowStart, heights: &mut [f32], amounts: &[f32]) -> u32 {
        let pass = &self.batch.pass;
        if let Some(goal) = self.goal {
            let first = start.x.abs_diff(goal.rect().x0) as usize;
            let goals = goal.row(start.z).and_then(|row| row.get(first..first + heights.len()));
            let goals = goals.unwrap_or_default();
            return apply_row(pass, instance, start, heights, amounts, goals);
        }
        let Rule::Noise(kernel) = &pass.rule else {
            return apply_row(pass, instance, start, heights, amounts, &[]);
        };
        if let Some(pattern) = self.pattern {
            let values = self.row_of(pattern.values(), start, heights.len()).unwrap_or_default();
            return apply_row(pass, instance, start, heights, amounts, values);
        }
        let mut values = [0.0; ROW_CHUNK];
        let values = values.get_mut(..heights.len()).unwrap_or_default();
        let rough = self.roughness.and_then(|page| self.row_of(page, start, values.len()));
        let mut frames = self.batch.frames.iter().skip(instance.frame as usize);
        if let Some(frame) = frames.next() {
            row::row(values, start.x, start.z, kernel, frame, rough);
        }
        if kernel.num_directions() > 1
            && let Some(next) = frames.next()
        {
            let mut others = [0.0; ROW_CHUNK];
            let others = others.get_mut(..values.len()).unwrap_or_default();
            row::row(others, start.x, start.z, kernel, next, rough);
            row::blend(values, others, instance.frame_blend);
        }
        apply_row(pass, instance, start, heights, amounts, values)
    }

    /// Calls `act` with the samples of a page that may lie within an instance's radius, by rows of at most [`ROW_CHUNK`], and
    /// the instance's amounts there, but for a wash those that the gate lets through.
    fn for_each_row(
        &self,
        page: &mut Page,
        instance: &Instance,
        rect: &SampleRect,
        mut act: impl FnMut(RowStart, &mut [f32], &[f32]),
    ) {
        let footprint = &self.batch.pass.footprint;
        let mut amounts = [0.0; ROW_CHUNK];
        for z in rect.z0..rect.z1 {
            let (x0, x1) = chord(instance, rect, z);
            let columns = (x0.abs_diff(self.page_rect.x0), x1.abs_diff(self.page_rect.x0));
            let Some(row) = page.row_mut(z.abs_diff(self.page_rect.z0), columns.0, columns.1) else {
                continue;
            };
            let mut x = x0;
            for chunk in row.chunks_mut(ROW_CHUNK) {
                let Some(amounts) = amounts.get_mut(..chunk.len()) else { continue };
                amounts::row(amounts, x, z, instance, footprint);
                if footprint.weight_mode != WeightMode::Wash {
                    self.let_through(RowStart { x, z }, amounts);
                }
                act(RowStart { x, z }, chunk, amounts);
                x += chunk.len() as i32;
            }
        }
    }
}

impl Wash {
    /// Applies the weights so far to the heights from before the stroke, over the rectangle that the batch touched.
    fn apply(&self, heights: &mut Page, site: &Site<'_>, work: &PageWork) -> u64 {
        let Some(instance) =
            work.instances.first().and_then(|index| site.batch.instances.get(*index as usize))
        else {
            return 0;
        };
        let page_rect = site.page_rect;
        let mut num_clamped = 0;
        let (x0, x1) = (work.rect.x0.abs_diff(page_rect.x0), work.rect.x1.abs_diff(page_rect.x0));
        let mut amounts = [0.0; ROW_CHUNK];
        for z in work.rect.z0..work.rect.z1 {
            let row = z.abs_diff(page_rect.z0);
            let rows =
                (heights.row_mut(row, x0, x1), self.before.row(row, x0, x1), self.weights.row(row, x0, x1));
            let (Some(heights), Some(before), Some(weights)) = rows else { continue };
            heights.copy_from_slice(before);
            let mut x = work.rect.x0;
            for (heights, weights) in heights.chunks_mut(ROW_CHUNK).zip(weights.chunks(ROW_CHUNK)) {
                let Some(amounts) = amounts.get_mut(..weights.len()) else { continue };
                amounts.copy_from_slice(weights);
                let start = RowStart { x, z };
                site.let_through(start, amounts);
                num_clamped += u64::from(site.apply_row(instance, start, heights, amounts));
                x += weights.len() as i32;
            }
        }
        num_clamped
    }
}

/// The columns of a row of `rect` that may lie within an instance's radius. Errs on the side of one sample more, whose
/// weight is then exactly 0.
pub(super) fn chord(instance: &Instance, rect: &SampleRect, z: i32) -> (i32, i32) {
    if instance.inverse_radius <= 0.0 || instance.inverse_segment_squared > 0.0 {
        return (rect.x0, rect.x1);
    }
    let [cell_x, cell_z] = instance.cell.map(f64::from);
    let [fraction_x, fraction_z] = instance.fraction.map(f64::from);
    let radius = 1.000_001 / f64::from(instance.inverse_radius);
    let dz = f64::from(z) - (cell_z + fraction_z);
    let half = (radius * radius - dz * dz).max(0.0).sqrt();
    let centre = cell_x + fraction_x;
    let first = ((centre - half).floor() as i32).clamp(rect.x0, rect.x1);
    let end = ((centre + half).ceil() as i32).saturating_add(1).clamp(first, rect.x1);
    (first, end)
}
