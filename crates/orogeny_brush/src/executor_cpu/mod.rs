//! The CPU back end: the reference's rows over pages, on all cores.
//!
//! A page is one task: its instances act on it in stroke order, row by row, so neither the number of threads nor the order
//! of the tasks can change a bit.

mod goals;
mod over_planes;
mod planes;
mod steps;
mod weights;
mod working_page;

use std::collections::BTreeSet;

use lru::LruCache;
use orogeny_field::{FieldId, Page, PageKey, PageLayout, Plane, SampleRect, WeightMode};
use orogeny_pages::PageStore;
use rayon::prelude::*;

use crate::execute::{Executor, Notices, PageMemory, Watch};
use crate::filter::region::Regions;
use crate::kernels::Rule;
use crate::pattern::Pattern;
use crate::plan::{Batch, PageWork, Pass};
use crate::spill::Spill;
use crate::{Error, Result};
use planes::Planes;
use working_page::{Gating, Wash, WorkingPage, has_pattern, num_held_for};

/// Pages that are copied and saved at once at the end: bounds the copies to 8 MiB.
const SAVE_PAGES: usize = 32;

/// Samples times instances that take about as long as a thread takes to wake up, 50 µs.
const LITTLE_SAMPLES: u64 = 1 << 16;

/// Applies batches on the CPU.
pub struct CpuExecutor {
    layout: PageLayout,
    threads: rayon::ThreadPool,
    max_pages: usize,
    resident: LruCache<PageKey, WorkingPage>,
    /// Pages that the resident ones hold: three for each of a running wash.
    num_held: usize,
    dirty: BTreeSet<PageKey>,
    /// Pages that the running operation has changed: their heights are no longer those from before it.
    changed: BTreeSet<PageKey>,
    /// Weights of a wash whose page had to make room.
    spilled_weights: Spill,
    planes: Planes,
    regions: Regions,
    notices: Notices,
}

impl CpuExecutor {
    /// An executor with a budget for resident pages and a number of threads (`None`: all cores). At least one page is
    /// always held.
    ///
    /// # Errors
    /// [`Error::Threads`] when the system gives no threads.
    pub fn new(layout: PageLayout, budget_in_bytes: u64, num_threads: Option<usize>) -> Result<Self> {
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(num_threads.unwrap_or_default())
            .thread_name(|index| format!("orogeny.brush.{index}"))
            .build()
            .map_err(|err| Error::Threads { reason: err.to_string() })?;
        let max_pages = usize::try_from(budget_in_bytes / layout.size_in_bytes()).unwrap_or(usize::MAX);
        Ok(Self {
            layout,
            threads,
            max_pages,
            resident: LruCache::unbounded(),
            num_held: 0,
            dirty: BTreeSet::new(),
            changed: BTreeSet::new(),
            spilled_weights: Spill::new(layout),
            planes: Planes::default(),
            regions: Regions::default(),
            notices: Notices::default(),
        })
    }

    /// A page ready to be worked on: as it was resident, or loaded.
    fn ready(
        &mut self,
        key: &PageKey,
        here: Option<WorkingPage>,
        pass: &Pass,
        store: &mut dyn PageStore,
    ) -> Result<WorkingPage> {
        let mut page = match here {
            Some(page) => page,
            None => WorkingPage {
                heights: self.load(key, store, |store, key| store.load(key))?,
                wash: None,
                gate: Gating::Open,
                roughness: Gating::Open,
                pattern: None,
            },
        };
        if let (Some(gate), Gating::Open) = (&pass.gate, &page.gate) {
            page.gate = Gating::Loaded(gate.load(key, store)?);
        }
        if let (Some(roughness), Gating::Open) = (&pass.roughness, &page.roughness) {
            page.roughness = Gating::Loaded(roughness.load(key, store)?);
        }
        if has_pattern(pass) && page.pattern.is_none() {
            page.pattern = Some(Pattern::new(self.layout));
        }
        if pass.weight_mode() == WeightMode::Wash && page.wash.is_none() {
            let before = if self.changed.contains(key) {
                self.load(key, store, |store, key| store.load_before(key))?
            } else {
                page.heights.clone()
            };
            let weights = self.spilled_weights.take(key)?.unwrap_or_else(|| Page::constant(self.layout, 0.0));
            page.wash = Some(Wash { before, weights });
        }
        Ok(page)
    }

    fn load(
        &self,
        key: &PageKey,
        store: &mut dyn PageStore,
        load: impl FnOnce(&mut dyn PageStore, &PageKey) -> Result<Option<Page>, orogeny_pages::BoxError>,
    ) -> Result<Page> {
        let page = load(store, key).map_err(orogeny_pages::Error::Source)?;
        let page = page.unwrap_or_else(|| Page::constant(self.layout, store.constant(key.field)));
        self.check_size(page.size())?;
        Ok(page)
    }

    fn check_size(&self, actual: u32) -> Result<()> {
        let expected = self.layout.size();
        if actual == expected { Ok(()) } else { Err(Error::PageSize { expected, actual }) }
    }

    fn take(&mut self, key: &PageKey) -> Option<WorkingPage> {
        let page = self.resident.pop(key)?;
        self.num_held -= page.num_held();
        Some(page)
    }

    /// Saves and drops the least recently used pages until `num_pages` more fit into the budget.
    fn make_room(&mut self, num_pages: usize, store: &mut dyn PageStore) -> Result<()> {
        let mut changed = Vec::new();
        while self.num_held + num_pages > self.max_pages {
            let Some((key, page)) = self.resident.pop_lru() else { break };
            self.num_held -= page.num_held();
            if let Some(wash) = page.wash {
                self.spilled_weights.put(key, &wash.weights)?;
            }
            if self.dirty.remove(&key) {
                changed.push((key, page.heights));
            }
        }
        self.planes.shrink_to(self.room_in_bytes(num_pages));
        while !changed.is_empty() {
            let rest = changed.split_off(changed.len().min(self.pages_saved_at_once()));
            store.save(std::mem::replace(&mut changed, rest)).map_err(orogeny_pages::Error::Source)?;
        }
        Ok(())
    }

    /// What the budget leaves beside the pages that are here and some more.
    fn room_in_bytes(&self, num_pages: usize) -> u64 {
        let num_pages = self.max_pages.saturating_sub(self.num_held + num_pages) as u64;
        num_pages.saturating_mul(self.layout.size_in_bytes())
    }

    /// How many pages are handed over together: on a small budget, a small part of it.
    fn pages_saved_at_once(&self) -> usize {
        (self.max_pages / 8).clamp(1, SAVE_PAGES)
    }

    /// Applies a batch to some of its pages; `goal` is what a filter made of the ground there.
    fn apply(
        &mut self,
        batch: &Batch,
        works: &[PageWork],
        goal: Option<&Plane>,
        store: &mut dyn PageStore,
    ) -> Result<()> {
        let held_for_one = num_held_for(&batch.pass);
        // One page at least, however small the budget is.
        for works in works.chunks((self.max_pages / held_for_one).max(1)) {
            // Those that are here are taken out first, so that none of them makes room for another.
            let here: Vec<_> = works.iter().map(|work| self.take(&work.key)).collect();
            self.make_room(works.len() * held_for_one, store)?;
            let mut tasks = Vec::with_capacity(works.len());
            for (work, here) in works.iter().zip(here) {
                tasks.push((work, self.ready(&work.key, here, &batch.pass, store)?));
            }
            let layout = self.layout;
            let apply = |(work, page): &mut (&PageWork, WorkingPage)| page.apply(batch, work, goal, layout);
            let num_clamped: u64 = if is_little(&batch.pass.rule, works) {
                tasks.iter_mut().map(apply).sum()
            } else {
                self.threads.install(|| tasks.par_iter_mut().map(apply).sum())
            };
            self.notices.num_clamped_heights += num_clamped;
            for (work, page) in tasks {
                self.dirty.insert(work.key);
                self.changed.insert(work.key);
                self.num_held += page.num_held();
                self.resident.put(work.key, page);
            }
        }
        Ok(())
    }

    /// The operation is over.
    fn end(&mut self) {
        self.dirty.clear();
        self.changed.clear();
        self.spilled_weights.clear();
        self.regions.clear();
        for (_, page) in &mut self.resident {
            page.wash = None;
            page.gate = Gating::Open;
            page.roughness = Gating::Open;
            page.pattern = None;
        }
        self.num_held = self.resident.len();
        // Memory of planes is kept for the next operation as far as the pages leave room for it.
        self.planes.shrink_to(self.room_in_bytes(0));
    }
}

/// Whether pages are worked out sooner here than other threads wake up.
fn is_little(rule: &Rule, works: &[PageWork]) -> bool {
    let num_samples: u64 = works.iter().map(|work| work.rect.area() * work.instances.len() as u64).sum();
    let limit = match rule {
        // A sample of it takes as long as some twenty of other brushes.
        Rule::Noise(_) => LITTLE_SAMPLES / 16,
        _ => LITTLE_SAMPLES,
    };
    num_samples <= limit
}

impl Executor for CpuExecutor {
    fn description(&self) -> String {
        format!("CPU, {} threads", self.threads.current_num_threads())
    }

    fn run_watched(&mut self, batch: &Batch, store: &mut dyn PageStore, watch: Watch<'_>) -> Result<()> {
        self.check_size(store.layout().size())?;
        if matches!(batch.pass.rule, Rule::Custom(_)) {
            return Err(Error::NeedsGpu);
        }
        match &batch.pass.rule {
            Rule::Filter(filter) => self.run_filter(filter, batch, store, watch),
            _ => self.apply(batch, &batch.pages, None, store),
        }
    }

    fn save(&mut self, store: &mut dyn PageStore) -> Result<()> {
        let dirty: Vec<_> = std::mem::take(&mut self.dirty).into_iter().collect();
        for keys in dirty.chunks(self.pages_saved_at_once()) {
            let copy = |key: &PageKey| Some((*key, self.resident.peek(key)?.heights.clone()));
            store.save(keys.iter().filter_map(copy).collect()).map_err(orogeny_pages::Error::Source)?;
        }
        Ok(())
    }

    fn finish(&mut self, store: &mut dyn PageStore) -> Result<Notices> {
        self.save(store)?;
        self.end();
        Ok(std::mem::take(&mut self.notices))
    }

    fn run_over_planes(
        &mut self,
        batch: &Batch,
        fields: &[(FieldId, &Plane)],
        rect: SampleRect,
    ) -> Result<Option<Plane>> {
        self.over_planes(batch, fields, rect)
    }

    fn plane(&mut self, rect: SampleRect) -> Plane {
        self.planes.memory(rect, 1)
    }

    fn give_back(&mut self, plane: Plane) {
        self.planes.give_back(plane);
        self.planes.shrink_to(self.room_in_bytes(0));
    }

    fn cancel(&mut self) {
        self.resident.clear();
        self.end();
        self.notices = Notices::default();
    }

    fn forget(&mut self, keys: &[PageKey]) {
        for key in keys {
            self.take(key);
            self.dirty.remove(key);
        }
    }

    fn memory(&self) -> PageMemory {
        let pages_in_bytes = self.num_held as u64 * self.layout.size_in_bytes();
        let planes_in_bytes = self.planes.size_in_bytes() + self.regions.size_in_bytes();
        PageMemory { host_in_bytes: pages_in_bytes + planes_in_bytes, textures_in_bytes: 0 }
    }
}
