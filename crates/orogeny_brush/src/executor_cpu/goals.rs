//! What filters make of the ground, block by block, on its way to the pages.

use orogeny_field::{Page, PageKey, Plane, SampleRect};
use orogeny_pages::PageStore;
use rayon::prelude::*;

use super::CpuExecutor;
use crate::Result;
use crate::execute::Watch;
use crate::filter::{self, Block, Filter};
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
        let blocks = filter::blocks(self.layout, &batch.pages, &filter.graph);
        // What is made of the ground as it is now is made for all blocks before it changes in any.
        let num_at_once = if filter.is_sequential { blocks.len().max(1) } else { 1 };
        let mut planes = std::mem::take(&mut self.planes);
        for blocks in blocks.chunks(num_at_once) {
            let mut goals = Vec::with_capacity(blocks.len());
            for block in blocks {
                let heights = |plane| self.gather(plane, filter, batch, store);
                goals.push(planes.work_out(&self.threads, &filter.graph, block.rect, heights, watch)?);
            }
            for (Block { pages, .. }, goal) in blocks.iter().zip(goals) {
                self.apply(batch, pages, Some(&goal), store)?;
                planes.give_back(goal);
            }
        }
        self.planes = planes;
        Ok(())
    }

    /// The ground of a rectangle, as the filter wants it.
    fn gather(
        &self,
        mut plane: Plane,
        filter: &Filter,
        batch: &Batch,
        store: &mut dyn PageStore,
    ) -> Result<Plane> {
        let is_now_wanted = |key: &PageKey| filter.is_sequential || !self.changed.contains(key);
        let here = |key: &PageKey| {
            let page = self.resident.peek(key)?;
            let before = page.wash.as_ref().map(|wash| &wash.before);
            if is_now_wanted(key) { Some(&page.heights) } else { before }
        };
        // Only what is not here is loaded.
        let mut loaded = Vec::new();
        for (x, z) in self.layout.pages_in(plane.rect()) {
            let key = PageKey::full_resolution(batch.pass.field, x, z);
            let page = match here(&key) {
                Some(_) => None,
                None => Some(self.load(&key, store, |store, key| {
                    if is_now_wanted(key) { store.load(key) } else { store.load_before(key) }
                })?),
            };
            loaded.push((key, page));
        }
        let pages: Vec<(SampleRect, &Page)> = (loaded.iter())
            .filter_map(|(key, page)| {
                let page = page.as_ref().or_else(|| here(key))?;
                Some((self.layout.page_rect(key), page))
            })
            .collect();
        self.threads.install(|| copy(&pages, &mut plane));
        Ok(plane)
    }
}

/// Copies what pages have of a plane into it.
fn copy(pages: &[(SampleRect, &Page)], plane: &mut Plane) {
    let rect = plane.rect();
    let width = rect.width() as usize;
    plane.samples_mut().par_chunks_mut(width.max(1)).enumerate().with_min_len(64).for_each(|(row, to)| {
        let z = rect.z0 + row as i32;
        for (page_rect, page) in
            pages.iter().filter(|(page_rect, _)| (page_rect.z0..page_rect.z1).contains(&z))
        {
            let both = rect.intersection(page_rect);
            let (x0, x1) = (both.x0.abs_diff(page_rect.x0), both.x1.abs_diff(page_rect.x0));
            let first = both.x0.abs_diff(rect.x0) as usize;
            let from = page.row(z.abs_diff(page_rect.z0), x0, x1);
            if let (Some(from), Some(to)) = (from, to.get_mut(first..first + both.width() as usize)) {
                to.copy_from_slice(from);
            }
        }
    });
}
