//! What filters make of the ground, block by block, on its way to the pages.

use orogeny_field::{FieldId, Page, PageKey, Plane, SampleRect};
use orogeny_pages::PageStore;
use rayon::prelude::*;

use super::{CpuExecutor, weights};
use crate::Result;
use crate::execute::Watch;
use crate::filter::{self, Block, Filter, Step};
use crate::plan::Batch;

impl CpuExecutor {
    /// Works out what a filter makes of the ground under a batch, and applies it.
    pub(super) fn run_filter(
        &mut self,
        filter: &Filter,
        batch: &Batch,
        store: &mut dyn PageStore,
        watch: Watch<'_>,
    ) -> Result<()> {
        let mut regions = std::mem::take(&mut self.regions);
        let load = |field, rect| self.gather(Plane::constant(rect, 0.0), field, false, store);
        regions.work_out(&filter.graph, Some(&self.threads), load, watch)?;
        self.regions = regions;
        let blocks = filter::blocks(self.layout, &batch.pages, &filter.graph);
        // What is made of the ground as it is now is made for all blocks before it changes in any.
        let num_at_once = if filter.is_sequential { blocks.len().max(1) } else { 1 };
        let mut planes = std::mem::take(&mut self.planes);
        for blocks in blocks.chunks(num_at_once) {
            let mut goals = Vec::with_capacity(blocks.len());
            for block in blocks {
                let given = |step: &Step, plane| self.given(step, plane, filter, batch, store);
                goals.push(planes.work_out(
                    &self.threads,
                    &filter.graph,
                    block.rect,
                    |_| None,
                    given,
                    watch,
                )?);
            }
            for (Block { pages, .. }, goal) in blocks.iter().zip(goals) {
                self.apply(batch, pages, Some(&goal), store)?;
                planes.give_back(goal);
            }
        }
        self.planes = planes;
        Ok(())
    }

    /// What a graph is made of, over the rectangle of a plane.
    fn given(
        &self,
        step: &Step,
        mut plane: Plane,
        filter: &Filter,
        batch: &Batch,
        store: &mut dyn PageStore,
    ) -> Result<Plane> {
        match step {
            Step::Heights => self.gather(plane, batch.pass.field, filter.is_sequential, store),
            Step::Field(field) => self.gather(plane, *field, false, store),
            Step::Raster(raster) => {
                self.threads.install(|| copy(&[(raster.rect(), Rows::Plane(raster))], &mut plane));
                Ok(plane)
            }
            Step::Region(kernel) => {
                if let Some(region) = self.regions.plane(kernel) {
                    self.threads.install(|| copy(&[(region.rect(), Rows::Plane(region))], &mut plane));
                }
                Ok(plane)
            }
            Step::Gate(gate) => {
                let pages = gate.pages(&plane.rect(), store)?;
                let pages: Vec<_> = pages.iter().map(|(rect, page)| (*rect, Rows::Page(page))).collect();
                self.threads.install(|| copy(&pages, &mut plane));
                Ok(plane)
            }
            Step::Weights(weights) => {
                let gate = weights.pages_let_through(&plane.rect(), store)?;
                self.threads.install(|| weights::fill(&mut plane, weights, &gate));
                Ok(plane)
            }
            _ => Ok(plane),
        }
    }

    /// The ground of a rectangle, as it is now or as it was before the operation.
    fn gather(
        &self,
        mut plane: Plane,
        field: FieldId,
        wants_now: bool,
        store: &mut dyn PageStore,
    ) -> Result<Plane> {
        let is_now_wanted = |key: &PageKey| wants_now || !self.changed.contains(key);
        let here = |key: &PageKey| {
            let page = self.resident.peek(key)?;
            let before = page.wash.as_ref().map(|wash| &wash.before);
            if is_now_wanted(key) { Some(&page.heights) } else { before }
        };
        // Only what is not here is loaded.
        let mut loaded = Vec::new();
        for (x, z) in self.layout.pages_in(plane.rect()) {
            let key = PageKey::full_resolution(field, x, z);
            let page = match here(&key) {
                Some(_) => None,
                None => Some(self.load(&key, store, |store, key| {
                    if is_now_wanted(key) { store.load(key) } else { store.load_before(key) }
                })?),
            };
            loaded.push((key, page));
        }
        let pages: Vec<(SampleRect, Rows<'_>)> = (loaded.iter())
            .filter_map(|(key, page)| {
                let page = page.as_ref().or_else(|| here(key))?;
                Some((self.layout.page_rect(key), Rows::Page(page)))
            })
            .collect();
        self.threads.install(|| copy(&pages, &mut plane));
        Ok(plane)
    }
}

/// Something that has samples of a rectangle.
#[derive(Clone, Copy)]
enum Rows<'a> {
    Page(&'a Page),
    Plane(&'a Plane),
}

impl<'a> Rows<'a> {
    /// Samples of a row, counted from the first one there.
    fn part(self, z: u32, x0: u32, x1: u32) -> Option<&'a [f32]> {
        match self {
            Self::Page(page) => page.row(z, x0, x1),
            Self::Plane(plane) => {
                plane.row(plane.rect().z0.saturating_add_unsigned(z))?.get(x0 as usize..x1 as usize)
            }
        }
    }
}

/// Copies what others have of a plane into it.
fn copy(others: &[(SampleRect, Rows<'_>)], plane: &mut Plane) {
    let rect = plane.rect();
    let width = rect.width() as usize;
    plane.samples_mut().par_chunks_mut(width.max(1)).enumerate().with_min_len(64).for_each(|(row, to)| {
        let z = rect.z0 + row as i32;
        for (there, other) in others.iter().filter(|(there, _)| (there.z0..there.z1).contains(&z)) {
            let both = rect.intersection(there);
            let (x0, x1) = (both.x0.abs_diff(there.x0), both.x1.abs_diff(there.x0));
            let first = both.x0.abs_diff(rect.x0) as usize;
            let from = other.part(z.abs_diff(there.z0), x0, x1);
            if let (Some(from), Some(to)) = (from, to.get_mut(first..first + both.width() as usize)) {
                to.copy_from_slice(from);
            }
        }
    });
}
