//! The CPU back end: the reference's rows over pages, on all cores.
//!
//! A page is one task: its instances act on it in stroke order, row by row, so neither the number of threads nor the order
//! of the tasks can change a bit.

use std::collections::BTreeSet;

use lru::LruCache;
use orogeny_field::{Instance, Page, PageKey, PageLayout, SampleRect, WeightMode};
use orogeny_pages::PageStore;
use orogeny_reference::amounts;
use orogeny_reference::noise::row;
use rayon::prelude::*;

use crate::execute::{Executor, Notices, PageMemory};
use crate::gate::{GateInput, GatePlan};
use crate::kernels::{RowStart, Rule, apply_row};
use crate::pattern::Pattern;
use crate::plan::{Batch, PageWork, Pass};
use crate::spill::Spill;
use crate::{Error, Result};

/// Samples of a row that are worked at once: their amounts stay in the first-level cache.
const ROW_CHUNK: usize = 256;

/// Pages that are copied and saved at once at the end: bounds the copies to 8 MiB.
const SAVE_PAGES: usize = 32;

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
    notices: Notices,
}

/// A page during an operation.
#[derive(Debug)]
struct WorkingPage {
    heights: Page,
    wash: Option<Wash>,
    gate: Gating,
    /// How rough a noise is there.
    roughness: Gating,
    /// The noise at each of its samples, where all instances have the same.
    pattern: Option<Pattern>,
}

/// What a wash keeps beside a page.
#[derive(Debug)]
struct Wash {
    before: Page,
    weights: Page,
}

/// What is known of where a brush may act on a page.
#[derive(Debug)]
enum Gating {
    /// Everywhere.
    Open,
    /// What its weights are to be made of.
    Loaded(GateInput),
    Weights(Page),
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
        while !changed.is_empty() {
            let rest = changed.split_off(changed.len().min(self.pages_saved_at_once()));
            store.save(std::mem::replace(&mut changed, rest)).map_err(orogeny_pages::Error::Source)?;
        }
        Ok(())
    }

    /// How many pages are handed over together: on a small budget, a small part of it.
    fn pages_saved_at_once(&self) -> usize {
        (self.max_pages / 8).clamp(1, SAVE_PAGES)
    }

    /// The operation is over.
    fn end(&mut self) {
        self.dirty.clear();
        self.changed.clear();
        self.spilled_weights.clear();
        for (_, page) in &mut self.resident {
            page.wash = None;
            page.gate = Gating::Open;
            page.roughness = Gating::Open;
            page.pattern = None;
        }
        self.num_held = self.resident.len();
    }
}

impl Executor for CpuExecutor {
    fn description(&self) -> String {
        format!("CPU, {} threads", self.threads.current_num_threads())
    }

    fn run(&mut self, batch: &Batch, store: &mut dyn PageStore) -> Result<()> {
        self.check_size(store.layout().size())?;
        if matches!(batch.pass.rule, Rule::Custom(_)) {
            return Err(Error::NeedsGpu);
        }
        let held_for_one = num_held_for(&batch.pass);
        // One page at least, however small the budget is.
        for works in batch.pages.chunks((self.max_pages / held_for_one).max(1)) {
            // Those that are here are taken out first, so that none of them makes room for another.
            let here: Vec<_> = works.iter().map(|work| self.take(&work.key)).collect();
            self.make_room(works.len() * held_for_one, store)?;
            let mut tasks = Vec::with_capacity(works.len());
            for (work, here) in works.iter().zip(here) {
                tasks.push((work, self.ready(&work.key, here, &batch.pass, store)?));
            }
            let layout = self.layout;
            let num_clamped: u64 = self
                .threads
                .install(|| tasks.par_iter_mut().map(|(work, page)| page.apply(batch, work, layout)).sum());
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

    fn finish(&mut self, store: &mut dyn PageStore) -> Result<Notices> {
        let dirty: Vec<_> = std::mem::take(&mut self.dirty).into_iter().collect();
        for keys in dirty.chunks(self.pages_saved_at_once()) {
            let copy = |key: &PageKey| Some((*key, self.resident.peek(key)?.heights.clone()));
            store.save(keys.iter().filter_map(copy).collect()).map_err(orogeny_pages::Error::Source)?;
        }
        self.end();
        Ok(std::mem::take(&mut self.notices))
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
        PageMemory { host_in_bytes: self.num_held as u64 * self.layout.size_in_bytes(), textures_in_bytes: 0 }
    }
}

/// Whether the noise of a pass is the same for all instances, so that a page keeps it.
fn has_pattern(pass: &Pass) -> bool {
    matches!(&pass.rule, Rule::Noise(kernel) if kernel.is_shared())
}

/// How many pages' memory a page takes while a pass works on it.
fn num_held_for(pass: &Pass) -> usize {
    let wash = if pass.weight_mode() == WeightMode::Wash { 2 } else { 0 };
    let gates = usize::from(pass.gate.is_some()) + usize::from(pass.roughness.is_some());
    1 + wash + gates + usize::from(has_pattern(pass))
}

impl WorkingPage {
    /// How many pages' memory it takes.
    const fn num_held(&self) -> usize {
        let wash = if self.wash.is_some() { 2 } else { 0 };
        let pattern = if self.pattern.is_some() { 1 } else { 0 };
        1 + wash + self.gate.num_held() + self.roughness.num_held() + pattern
    }

    /// Applies the batch's instances to the page; returns the number of clamped heights.
    fn apply(&mut self, batch: &Batch, work: &PageWork, layout: PageLayout) -> u64 {
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
fn chord(instance: &Instance, rect: &SampleRect, z: i32) -> (i32, i32) {
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
