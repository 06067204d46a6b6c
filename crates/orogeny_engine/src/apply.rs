//! Running operations: all of a list in one transaction, or none.

use std::time::Instant;

use orogeny_brush::{Batch, Canvas, Executor, Notices, Resources, StrokePlanner, plan_fill, resolved};
use orogeny_field::{
    Brush, BrushType, LayerContent, LayerReference, PageKey, PageLayout, SampleRect, Selecting, Stroke,
    TerrainGrid,
};
use orogeny_pages::PageStore as _;
use orogeny_store::{EntryId, Layer, Recording};

use crate::clone_source;
use crate::composite::{Change, Compositor};
use crate::hand::{Hand, Known, SoFar, check_num_points};
use crate::import::RecordedImport;
use crate::layers::{Changed, Stack, refuse_locked, refused};
use crate::operation::{self, BrushOperation, LayerOperation};
use crate::pages::RecordedPages;
use crate::progress::report;
use crate::resources;
use crate::seen::{SEEN, Seen, keeps_difference, works_on_heights};
use crate::select;
use crate::terrain::{Parts, find_layer};
use crate::{Error, Observer, Operation, Result, Target, Terrain};

/// Instances of a stroke that are planned and run at once.
const BATCH_INSTANCES: usize = 1024;
/// Pages that are run at once: after each such piece the observer may cancel.
const BATCH_PAGES: usize = 64;

/// What an operation did.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Applied {
    /// Its place in the history.
    pub entry: EntryId,
    /// Its `op`.
    pub operation: &'static str,
    /// What it was done with; of a layer, what it is made of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub brush: Option<BrushType>,
    /// The layer that it made, by its id.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub made_layer: Option<u32>,
    /// Pages that it wrote.
    pub num_pages: usize,
    /// What it changed of one field, for those who look; `None` where it is not one field alone.
    #[serde(skip)]
    pub(crate) change: Option<Change>,
    /// How long it took, in seconds, without making it durable, which goes on behind.
    pub elapsed_s: f64,
    /// What it met on its way.
    pub notices: Notices,
}

impl Applied {
    /// Of an import.
    pub(crate) fn import(entry: EntryId, made_layer: Option<u32>, num_pages: usize) -> Self {
        Self {
            entry,
            operation: RecordedImport::OP,
            brush: None,
            made_layer,
            num_pages,
            change: None,
            elapsed_s: 0.0,
            notices: Notices::default(),
        }
    }
}

/// What running operations needs.
pub(crate) struct Site<'a> {
    pub(crate) grid: TerrainGrid,
    pub(crate) layout: PageLayout,
    pub(crate) executor: &'a mut dyn Executor,
    pub(crate) compositor: &'a mut Compositor,
    pub(crate) observer: &'a mut dyn Observer,
}

/// What was painted.
pub(crate) struct Painted {
    /// With all that had to be found out for it found out.
    operation: BrushOperation,
    notices: Notices,
    /// The pages that changed.
    pub(crate) pages: Vec<PageKey>,
    /// The samples that changed.
    change: Change,
}

impl Terrain {
    /// Runs operations in order, each as one entry of the history. When this returns they are on disk.
    ///
    /// Should the GPU device be lost on the way, the list is run again, once, on a new one.
    ///
    /// # Errors
    /// [`Error::InRecipe`] with the operation that failed, or [`Error::Cancelled`]; none of them was done then.
    pub fn apply(&mut self, operations: &[Operation], observer: &mut dyn Observer) -> Result<Vec<Applied>> {
        let applied = self.submit(operations, observer)?;
        self.flush()?;
        Ok(applied)
    }

    /// As [`Self::apply`], but returns when the operations are painted, while they are still on their way to the disk: what
    /// comes next need not wait for it. They are done when [`Self::flush`] says so. The next call first waits for this one,
    /// at its own end, so at most one may be lost.
    ///
    /// # Errors
    /// As [`Self::apply`]; also what kept the operations before these from being made durable. None of either was done then.
    pub fn submit(&mut self, operations: &[Operation], observer: &mut dyn Observer) -> Result<Vec<Applied>> {
        self.run(operations, observer, After::Commit)
    }

    /// Waits until everything that was submitted is on disk.
    ///
    /// # Errors
    /// [`Error::Store`] with what kept the last operations from it; the terrain is as before them.
    pub fn flush(&mut self) -> Result<()> {
        let flushed = self.recorder()?.flush();
        if flushed.is_err() {
            self.forget_all_pages();
        }
        Ok(flushed?)
    }

    /// Runs operations and takes them back: whether they would work, and what they would do.
    ///
    /// # Errors
    /// As [`Self::apply`].
    pub fn try_out(&mut self, operations: &[Operation], observer: &mut dyn Observer) -> Result<Vec<Applied>> {
        self.run(operations, observer, After::TakeBack)
    }

    fn run(
        &mut self,
        operations: &[Operation],
        observer: &mut dyn Observer,
        after: After,
    ) -> Result<Vec<Applied>> {
        self.with_new_device_if_lost(|terrain, _| terrain.run_once(operations, observer, after))
    }

    /// Does something, and once more should the GPU device be lost on the way: on a new one then, and told so.
    fn with_new_device_if_lost<T>(
        &mut self,
        mut attempt: impl FnMut(&mut Self, bool) -> Result<T>,
    ) -> Result<T> {
        match attempt(self, false) {
            Err(err) if matches!(err.gpu(), Some(orogeny_gpu::Error::DeviceLost { .. })) => {
                tracing::warn!("{err}; it is done again on a new device");
                attempt(self, true)
            }
            result => result,
        }
    }

    fn run_once(
        &mut self,
        operations: &[Operation],
        observer: &mut dyn Observer,
        after: After,
    ) -> Result<Vec<Applied>> {
        if operations.is_empty() {
            return Ok(Vec::new());
        }
        let author = self.settings().author.clone();
        self.record(observer, after, |site, recording| apply_all(operations, &author, site, recording))
    }

    /// Draws a stroke, whose points come from a hand, as one entry of the history. When this returns it is painted, as
    /// by [`Self::submit`]. Should the GPU device be lost, the hand is asked for its points again.
    pub(crate) fn draw(
        &mut self,
        operation: &BrushOperation,
        hand: &mut dyn Hand,
        observer: &mut dyn Observer,
    ) -> Result<Applied> {
        let author = self.settings().author.clone();
        self.with_new_device_if_lost(|terrain, is_again| {
            if is_again {
                hand.begin_again();
            }
            terrain.record(observer, After::Commit, |site, recording| {
                apply_brush(operation, hand, &author, site, recording)
            })
        })
    }

    /// Does something in one transaction.
    pub(crate) fn record<T>(
        &mut self,
        observer: &mut dyn Observer,
        after: After,
        work: impl FnOnce(&mut Site<'_>, &mut Recording<'_>) -> Result<T>,
    ) -> Result<T> {
        let Parts { recorder, executor, compositor } = self.parts()?;
        let (grid, layout) = (recorder.on_disk()?.grid(), recorder.on_disk()?.layout());
        let result = recorder.begin().map_err(Error::from).and_then(|mut recording| {
            let mut site = Site { grid, layout, executor, compositor, observer };
            let done = work(&mut site, &mut recording)?;
            match after {
                After::Commit => recording.finish()?,
                // Whether what was handed over could be written is known when all of it was.
                After::TakeBack => recording.with_transaction(|_| Ok(()))?,
            }
            Ok(done)
        });
        if result.is_err() || after == After::TakeBack {
            self.forget_all_pages();
        }
        if result.as_ref().is_err_and(|err| err.gpu().is_some()) {
            // A lost or hung device does not come back; the next operation makes a new one.
            self.drop_executor();
        }
        result
    }
}

/// What becomes of operations that have run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum After {
    Commit,
    TakeBack,
}

/// Runs operations one after another.
pub(crate) fn apply_all(
    operations: &[Operation],
    author: &str,
    site: &mut Site<'_>,
    recording: &mut Recording<'_>,
) -> Result<Vec<Applied>> {
    let mut applied = Vec::with_capacity(operations.len());
    for (index, operation) in operations.iter().enumerate() {
        let (number, count) = (index + 1, operations.len());
        let brush = operation.brush().map_or("", |brush| brush.brush_type.name());
        tracing::info!("operation {number} of {count}: {} {brush}", operation.name());
        if number == count {
            recording.wait_for_look();
        }
        let one = match operation {
            Operation::Brush(operation) => {
                apply_brush(operation, &mut Known(operation.points()), author, site, recording)
            }
            Operation::Layers(operation) => apply_layers(operation, author, site, recording),
            Operation::Select(selecting) => apply_select(selecting, author, site, recording),
        };
        applied.push(one.map_err(|err| match err {
            Error::Cancelled => Error::Cancelled,
            source => Error::InRecipe { number, count, name: operation.name(), source: Box::new(source) },
        })?);
    }
    Ok(applied)
}

fn apply_brush(
    operation: &BrushOperation,
    hand: &mut dyn Hand,
    author: &str,
    site: &mut Site<'_>,
    recording: &mut Recording<'_>,
) -> Result<Applied> {
    let start = Instant::now();
    let layer = find_layer(recording.layers(), operation.layer())?.id;
    let Painted { operation, notices, pages, change } = paint(operation, hand, site, recording)?;
    let entry = recording.record(operation.to_recorded_json(layer)?, author)?;
    Ok(Applied {
        entry,
        operation: operation.name(),
        brush: Some(operation.brush().brush_type),
        made_layer: None,
        num_pages: pages.len(),
        change: Some(change),
        elapsed_s: start.elapsed().as_secs_f64(),
        notices,
    })
}

/// Applies a brush, as a part of the entry that is recorded next. Of a stroke, the points are the hand's.
///
/// # Errors
/// [`Error::UnknownLayer`], [`Error::LayerLocked`], [`Error::LayerRefused`]; what the brush cannot be done for; [`Error::Cancelled`].
pub(crate) fn paint(
    operation: &BrushOperation,
    hand: &mut dyn Hand,
    site: &mut Site<'_>,
    recording: &mut Recording<'_>,
) -> Result<Painted> {
    let layer = find_layer(recording.layers(), operation.layer())?.clone();
    check_paintable(operation, recording.layers(), &layer)?;
    let (mut brush, mut resources) = resources::load(operation.brush(), recording)?;
    let mut canvas = canvas(operation, &layer, site, recording)?;
    // The layer may have got a mask.
    let layer = find_layer(recording.layers(), Some(&LayerReference::Id(layer.id)))?.clone();
    let Site { grid, layout, executor, observer, compositor, .. } = site;
    let seen = match operation.target() {
        // Its own heights are asked for.
        Target::Heights => None,
        target => Seen::of(&layer, target == Target::Selection, *grid, compositor, recording)?,
    };
    if seen.is_some() {
        canvas.heights = SEEN;
        let brush_type = operation.brush().brush_type;
        if operation.target() == Target::Seen && works_on_heights(brush_type) && keeps_difference(&layer) {
            canvas.field = SEEN;
        }
    }
    resources.clone_ground = clone_source::load(operation, &mut brush, canvas.field, grid, recording)?;
    let mut operation = operation.clone().with_brush(resolved(&brush));
    // What is seen is kept by the layer.
    let field = if canvas.field == SEEN { layer.heights } else { canvas.field };
    let mut pages = RecordedPages::new(recording, *layout).with_seen(seen);
    let mut changed = SampleRect::EMPTY;
    let result = match &mut operation {
        BrushOperation::Stroke { stroke, .. } => {
            let so_far = SoFar { executor: *executor, pages: &mut pages, field, changed: SampleRect::EMPTY };
            run_stroke(stroke, hand, canvas, resources, so_far, *observer, &mut changed)
        }
        BrushOperation::Fill { brush, seed, region_m, .. } => {
            let region = match region_m {
                Some(region_m) => grid.samples_in_region(*region_m)?,
                None => grid.bounds(),
            };
            let batch = plan_fill(brush, *seed, canvas, resources, region, &mut pages)?;
            let total = batch.pages.len() as u64;
            note_changed(&batch, &mut changed);
            run_batch(batch, *executor, &mut pages, |done| report(*observer, "filling", done, total))
        }
    };
    let result = result.and_then(|()| Ok(executor.finish(&mut pages)?));
    let (saved, asked_for) = pages.into_saved();
    let notices = result?;
    executor.forget(&asked_for);
    // What it has of the layer itself was changed beside it.
    if canvas.field == SEEN {
        executor.forget(&saved);
    }
    let change = Change { field, rect: changed };
    site.compositor.forget(&site.grid, site.layout, &[change]);
    Ok(Painted { operation, notices, pages: saved, change })
}

fn apply_layers(
    operation: &LayerOperation,
    author: &str,
    site: &mut Site<'_>,
    recording: &mut Recording<'_>,
) -> Result<Applied> {
    let start = Instant::now();
    let mut stack = Stack { site, recording, written: Vec::new() };
    let Changed { recorded, made_layer } = stack.apply(operation)?;
    let written = std::mem::take(&mut stack.written);
    site.executor.forget(&written);
    site.compositor.forget(&site.grid, site.layout, &Change::of_pages(site.layout, &written));
    let entry = recording.record(recorded.to_json()?, author)?;
    Ok(Applied {
        entry,
        operation: recorded.name(),
        brush: recorded.content().and_then(|content| Some(content.procedure()?.brush.brush_type)),
        made_layer,
        num_pages: written.len(),
        change: None,
        elapsed_s: start.elapsed().as_secs_f64(),
        notices: Notices::default(),
    })
}

fn apply_select(
    selecting: &Selecting,
    author: &str,
    site: &mut Site<'_>,
    recording: &mut Recording<'_>,
) -> Result<Applied> {
    let start = Instant::now();
    let (recorded, written) = select::run(selecting, site.grid, recording, site.compositor, site.observer)?;
    site.executor.forget(&written);
    site.compositor.forget(&site.grid, site.layout, &Change::of_pages(site.layout, &written));
    let entry = recording.record(operation::select::to_json(&recorded)?, author)?;
    Ok(Applied {
        entry,
        operation: operation::select::NAME,
        brush: None,
        made_layer: None,
        num_pages: written.len(),
        change: None,
        elapsed_s: start.elapsed().as_secs_f64(),
        notices: Notices::default(),
    })
}

/// Refuses what cannot be painted on.
fn check_paintable(operation: &BrushOperation, layers: &[Layer], layer: &Layer) -> Result<()> {
    if operation.target() == Target::Selection {
        return Ok(());
    }
    refuse_locked(layers, layer)?;
    let why = match layer.content {
        LayerContent::Heights if !layer.transform.is_identity() => {
            "it was moved, turned or enlarged: collapse it first, by `collapse_layer`"
        }
        LayerContent::Heights => return Ok(()),
        _ if operation.target() == Target::Mask => return Ok(()),
        LayerContent::Group => "it is a group: paint on one of its layers, or on its mask",
        _ => "a brush works it out: paint on its mask, or collapse it first, by `collapse_layer`",
    };
    Err(refused(layer, "painted on", why.to_owned()))
}

/// Whether a brush looks at the terrain's selection.
pub(crate) fn needs_selection(brush: &Brush) -> bool {
    let gates = [brush.gate.as_deref(), brush.hardness.as_deref(), brush.noise.roughness.as_deref()];
    gates.into_iter().flatten().any(|gate| gate.selection)
        || (brush.brush_type == BrushType::Clone && brush.cloning.source.is_selected_only)
}

/// What an operation paints on. Makes the mask or the selection that it needs.
fn canvas(
    operation: &BrushOperation,
    layer: &Layer,
    site: &Site<'_>,
    recording: &mut Recording<'_>,
) -> Result<Canvas> {
    let heights = Canvas::heights(site.grid, site.layout, layer.heights);
    let needs_selection = needs_selection(operation.brush());
    let selection = if needs_selection || operation.target() == Target::Selection {
        Some(recording.selection()?)
    } else {
        None
    };
    let selection = selection.unwrap_or(heights.selection);
    let field = match operation.target() {
        Target::Seen | Target::Heights => layer.heights,
        Target::Mask => recording.with_mask(layer)?.mask.unwrap_or(layer.heights),
        Target::Selection => selection,
    };
    Ok(Canvas { field, is_mask: !operation.target().is_heights(), selection, ..heights })
}

fn run_stroke(
    stroke: &mut Stroke,
    hand: &mut dyn Hand,
    canvas: Canvas,
    resources: Resources,
    mut so_far: SoFar<'_, '_, '_>,
    observer: &mut dyn Observer,
    changed: &mut SampleRect,
) -> Result<()> {
    stroke.points.clear();
    stroke.brush.check()?;
    let mut planner = StrokePlanner::new(&stroke.brush, stroke.seed, canvas, resources)?;
    let mut num_instances = 0;
    let mut run_settled = |planner: &mut StrokePlanner, so_far: &mut SoFar<'_, '_, '_>| -> Result<()> {
        while let Some(batch) = planner.next_batch(so_far.pages, BATCH_INSTANCES)? {
            num_instances += batch.instances.len() as u64;
            note_changed(&batch, changed);
            note_changed(&batch, &mut so_far.changed);
            let tell = |_| report(observer, "painting", num_instances, 0);
            run_batch(batch, so_far.executor, so_far.pages, tell)?;
        }
        Ok(())
    };
    while let Some(points) = hand.next_points(&mut so_far)? {
        check_num_points(stroke.points.len() + points.len())?;
        for point in points {
            planner.push(&point)?;
            stroke.points.push(point);
        }
        run_settled(&mut planner, &mut so_far)?;
    }
    check_num_points(stroke.points.len())?;
    planner.finish();
    run_settled(&mut planner, &mut so_far)
}

/// Adds the samples that a batch may change.
fn note_changed(batch: &Batch, changed: &mut SampleRect) {
    for work in &batch.pages {
        *changed = changed.bounds_with(&work.rect);
    }
}

/// Runs a batch piece by piece. `tell` gets the pages done so far and may cancel; it is asked before the first piece too, so
/// that it is asked for a batch without pages.
fn run_batch(
    batch: Batch,
    executor: &mut dyn Executor,
    pages: &mut RecordedPages<'_, '_>,
    mut tell: impl FnMut(u64) -> Result<()>,
) -> Result<()> {
    let mut num_done = 0;
    tell(num_done)?;
    for piece in batch.split(pages.layout(), BATCH_PAGES) {
        let num_pages = piece.pages.len() as u64;
        let mut told = Ok(());
        let mut watch = |share: f64| {
            told = tell(num_done + (share * num_pages as f64) as u64);
            told.is_ok()
        };
        let run = executor.run_watched(&piece, pages, &mut watch);
        // Who cancelled it is said before that it was.
        told?;
        run?;
        num_done += num_pages;
        tell(num_done)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stub_executor::{StubExecutor, dab};
    use crate::{Adapter, Quiet, Settings};

    /// Whose GPU fails with the first batch.
    fn terrain_on(folder: &tempfile::TempDir, error: orogeny_gpu::Error) -> Terrain {
        let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
        let grid = TerrainGrid::new(64, 64, 1.0).unwrap();
        let mut terrain = Terrain::create(&folder.path().join("t.orogeny"), grid, 0.0, settings).unwrap();
        terrain.set_executor(Box::new(StubExecutor(move || Err(error.clone().into()))));
        terrain
    }

    #[test]
    fn what_a_lost_device_left_undone_is_done_again_on_a_new_one() {
        let folder = tempfile::tempdir().unwrap();
        let lost = orogeny_gpu::Error::DeviceLost { adapter: "a".to_owned(), reason: "b".to_owned() };
        let mut terrain = terrain_on(&folder, lost);
        assert_eq!(terrain.apply(&[dab(), dab()], &mut Quiet).unwrap().len(), 2);
        assert_eq!(terrain.height_m([8.0, 8.0]).unwrap(), 2.0);
        assert_eq!(terrain.log().unwrap().len(), 2);
    }

    #[test]
    fn a_hung_device_is_told_and_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let mut terrain = terrain_on(&folder, orogeny_gpu::Error::Timeout { timeout_s: 60.0 });
        let err = terrain.apply(&[dab()], &mut Quiet).unwrap_err();
        assert!(err.to_string().contains("60"), "{err}");
        assert_eq!(terrain.height_m([8.0, 8.0]).unwrap(), 0.0);
        terrain.apply(&[dab()], &mut Quiet).unwrap();
        assert_eq!(terrain.height_m([8.0, 8.0]).unwrap(), 1.0);
    }
}
