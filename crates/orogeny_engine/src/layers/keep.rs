//! Effects that are kept: worked out over their mask's bounds when that is asked for, as the difference to what is below; and
//! whether what is below has changed since.

use orogeny_brush::{Canvas, plan_fill};
use orogeny_field::{
    Blend, FieldId, LayerContent, MaskSource, MaskTerm, Page, PageKey, PageLayout, SampleRect, TerrainGrid,
};
use orogeny_pages::{BoxError, PageStore};
use orogeny_store::{BlobHash, FieldKind, Layer, MadeOf, Recording, Store};

use super::copy::num_below;
use super::{Stack, refused};
use crate::composite::{self, Compositor, FieldPages as _, Live, Look, Node, RecordingPages, with_groups};
use crate::progress::report;
use crate::terrain::find_layer;
use crate::{Error, Observer, Result};

/// The field that is worked on, and that gates look at: what is below the layer. No terrain has one of this number.
const BELOW: FieldId = FieldId(u32::MAX - 1);
const NO_FIELD: FieldId = FieldId(u32::MAX);
/// Pages that are run at once: after each such piece the observer may cancel.
const BATCH_PAGES: usize = 64;

impl Stack<'_, '_> {
    /// Works an effect that is kept out anew.
    pub(super) fn refresh(&mut self, layer: &Layer) -> Result<()> {
        let layer = &self.layer(&orogeny_field::LayerReference::Id(layer.id))?;
        let Some(procedure) = layer.content.procedure().filter(|_| layer.content.is_kept()) else {
            let why = "it is no effect that is kept: it is worked out whenever it is looked at".to_owned();
            return Err(refused(layer, "refreshed", why));
        };
        self.refuse_locked(layer)?;
        let layers = self.recording.layers().to_vec();
        let region = self.mask_bounds(&layers, layer)?;
        let mut pages = RecordingPages::new(self.recording)?;
        let selection = pages.selection()?.unwrap_or(NO_FIELD);
        let live = Live::new(procedure, &mut pages)?;
        let nodes = self.compositor.nodes(&layers, &mut pages)?;
        let below = nodes.get(..num_below(&layers, &nodes, layer.id)).unwrap_or_default();
        // What the last time left beyond the region goes.
        let mut stale = self.recording.page_keys(layer.heights)?;
        let canvas = Canvas { selection, ..Canvas::heights(self.grid, self.layout, BELOW) };
        if !region.is_empty() {
            let mut pages = BelowPages {
                grid: self.grid,
                layout: self.layout,
                recording: self.recording,
                compositor: self.compositor,
                below,
                heights: layer.heights,
                written: Vec::new(),
                asked_for: Vec::new(),
            };
            let batch = plan_fill(&live.brush, live.seed, canvas, live.resources, region, &mut pages)?;
            let run = run(batch, self.layout, self.executor, &mut pages, self.observer);
            let BelowPages { written, mut asked_for, .. } = pages;
            asked_for.sort_unstable();
            asked_for.dedup();
            match run {
                Ok(()) => self.executor.forget(&asked_for),
                Err(err) => {
                    self.executor.cancel();
                    return Err(err);
                }
            }
            stale.retain(|key| !written.contains(key));
            self.written.extend(written);
        }
        let zero = Page::constant(self.layout, 0.0);
        self.write(stale.into_iter().map(|key| (key, zero.clone())).collect())?;
        let entry = self.recording.with_transaction(|transaction| Ok(transaction.entry()))?;
        let made_of = MadeOf {
            entry: entry.0,
            region: [region.x0, region.z0, region.x1, region.z1],
            layers: hash_below(&layers, layer)?,
        };
        Ok(self.recording.set_layer(Layer { made_of: Some(made_of), ..layer.clone() })?)
    }

    /// The samples where a layer's painted mask, and those of its groups, may let it count.
    fn mask_bounds(&mut self, layers: &[Layer], layer: &Layer) -> Result<SampleRect> {
        let mut bounds = self.grid.bounds();
        for masked in with_groups(layers, layer) {
            if let Some(mask) = masked.mask.filter(|_| masked.mask_constant == 0.0) {
                let painted = self.recording.page_keys(mask)?;
                bounds = bounds.intersection(&painted_bounds(self.layout, &painted));
            }
        }
        Ok(bounds)
    }
}

fn painted_bounds(layout: PageLayout, keys: &[PageKey]) -> SampleRect {
    keys.iter().fold(SampleRect::EMPTY, |bounds, key| bounds.bounds_with(&layout.page_rect(key)))
}

fn run(
    batch: orogeny_brush::Batch,
    layout: PageLayout,
    executor: &mut dyn orogeny_brush::Executor,
    pages: &mut BelowPages<'_, '_>,
    observer: &mut dyn Observer,
) -> Result<()> {
    let total = batch.pages.len() as u64;
    let mut done = 0;
    report(observer, "working out", done, total)?;
    for piece in batch.split(layout, BATCH_PAGES) {
        let num_pages = piece.pages.len() as u64;
        let mut told = Ok(());
        let mut watch = |share: f64| {
            told = report(observer, "working out", done + (share * num_pages as f64) as u64, total);
            told.is_ok()
        };
        let run = executor.run_watched(&piece, pages, &mut watch);
        told?;
        run?;
        done += num_pages;
        report(observer, "working out", done, total)?;
    }
    executor.finish(pages)?;
    Ok(())
}

/// What is below a layer, as an executor sees it, and where the difference that is made to it goes.
struct BelowPages<'a, 'recorder> {
    grid: TerrainGrid,
    layout: PageLayout,
    recording: &'a mut Recording<'recorder>,
    compositor: &'a mut Compositor,
    below: &'a [Node],
    heights: FieldId,
    written: Vec<PageKey>,
    asked_for: Vec<PageKey>,
}

impl BelowPages<'_, '_> {
    fn below(&mut self, key: &PageKey) -> Result<Page> {
        let rect = self.layout.page_rect(key);
        let mut pages = RecordingPages::new(self.recording)?;
        let mut look = Look::new(self.grid, 0, &mut pages)?;
        let plane = self.compositor.heights(&mut look, self.below, rect.intersection(&self.grid.bounds()))?;
        Ok(composite::page_of(&plane, self.layout, rect, 0.0))
    }
}

impl PageStore for BelowPages<'_, '_> {
    fn layout(&self) -> PageLayout {
        self.layout
    }

    fn constant(&self, _field: FieldId) -> f32 {
        0.0
    }

    fn load(&mut self, key: &PageKey) -> std::result::Result<Option<Page>, BoxError> {
        let mut page = match self.load_before(key)? {
            Some(page) => page,
            None => return Ok(None),
        };
        let place = PageKey { field: self.heights, ..*key };
        if key.field == BELOW
            && self.written.contains(&place)
            && let Some(difference) = self.recording.load_page(&place)?
        {
            add(&mut page, &difference, 1.0);
        }
        Ok(Some(page))
    }

    fn load_before(&mut self, key: &PageKey) -> std::result::Result<Option<Page>, BoxError> {
        self.asked_for.push(*key);
        if key.field == BELOW {
            return Ok(Some(self.below(key)?));
        }
        Ok(self.recording.load_page(key)?.map(std::sync::Arc::unwrap_or_clone))
    }

    fn save(&mut self, pages: Vec<(PageKey, Page)>) -> std::result::Result<(), BoxError> {
        let mut differences = Vec::with_capacity(pages.len());
        for (key, mut page) in pages {
            let below = self.below(&key)?;
            add(&mut page, &below, -1.0);
            let key = PageKey { field: self.heights, ..key };
            self.written.push(key);
            differences.push((key, page));
        }
        Ok(self.recording.write_pages(differences)?)
    }
}

/// Adds a page to another one, times a factor.
fn add(page: &mut Page, other: &Page, factor: f32) {
    for (height, other) in page.samples_mut().iter_mut().zip(other.samples()) {
        *height = orogeny_field::sanitized_height(*height + factor * other);
    }
}

/// The visible layers below another one, each with the groups that it is in.
fn below<'a>(layers: &'a [Layer], layer: &Layer) -> Vec<&'a Layer> {
    let lower = layers.iter().take_while(|other| other.id != layer.id);
    let is_counted = |other: &&Layer| {
        let is_visible = with_groups(layers, other).all(|layer| layer.visible);
        is_visible && other.content != LayerContent::Group
    };
    lower.filter(is_counted).flat_map(|other| with_groups(layers, other)).collect()
}

/// The layers that masks of these look at, wherever those lie.
fn looked_at<'a>(layers: &'a [Layer], by: &[&Layer]) -> Vec<&'a Layer> {
    let references = by.iter().flat_map(|layer| &layer.mask_terms).filter_map(|term| term.source.layer());
    references.filter_map(|reference| find_layer(layers, Some(reference)).ok()).collect()
}

/// Stands for a layer's brush, all visible layers below it with their settings, and the layers that masks of these look at.
fn hash_below(layers: &[Layer], layer: &Layer) -> Result<String> {
    // It counts by what it is made of, not by how much it counts.
    let own = Layer { made_of: None, blend: Blend::default(), mask: None, ..held(layer) };
    let below = below(layers, layer);
    let looked_at = looked_at(layers, &below);
    let basis: Vec<Layer> = std::iter::once(own)
        .chain(below.into_iter().map(without_name))
        .chain(looked_at.into_iter().map(held))
        .collect();
    let text = serde_json::to_vec(&basis).map_err(|err| Error::Operation {
        place: "a layer of the terrain".to_owned(),
        detail: err.to_string(),
    })?;
    Ok(BlobHash::of(&text).to_string())
}

/// A layer without what is no matter of what it holds: how much that counts, and where it lies in the stack.
fn held(layer: &Layer) -> Layer {
    Layer {
        opacity: 1.0,
        visible: true,
        blend: Blend::default(),
        group: None,
        mask_terms: Vec::new(),
        ..without_name(layer)
    }
}

fn without_name(layer: &Layer) -> Layer {
    Layer { name: String::new(), position: 0, locked: false, ..layer.clone() }
}

/// Whether an effect that is kept shows something else than what it would be made into now.
///
/// # Errors
/// [`Error::Store`] when the directory cannot be read.
pub(crate) fn is_stale(store: &Store, layer: &Layer) -> Result<bool> {
    if !layer.content.is_kept() {
        return Ok(false);
    }
    let Some(made_of) = &layer.made_of else { return Ok(true) };
    let layers = store.layers();
    if hash_below(layers, layer)? != made_of.layers {
        return Ok(true);
    }
    let [x0, z0, x1, z1] = made_of.region;
    let region = SampleRect::new(x0, z0, x1, z1);
    // Its mask may have been painted beyond what it was made for.
    let mut masked = store.grid().bounds();
    for outer in with_groups(layers, layer) {
        if let Some(mask) = outer.mask.filter(|_| outer.mask_constant == 0.0) {
            let painted = store.page_keys_in(mask, 0, &store.grid().bounds())?;
            masked = masked.intersection(&painted_bounds(store.layout(), &painted));
        }
    }
    if !masked.is_empty() && !region.contains(&masked) {
        return Ok(true);
    }
    let is_newer = |field: FieldId, rect: &SampleRect| -> Result<bool> {
        Ok(store.newest_revision(field, rect)?.is_some_and(|newest| newest.0 > made_of.entry))
    };
    let below = below(layers, layer);
    for other in below.iter().copied().chain(looked_at(layers, &below)) {
        // A moved layer's pages may lie anywhere.
        let rect = if other.transform.is_identity() { region } else { store.grid().bounds() };
        for field in [Some(other.heights), other.mask].into_iter().flatten() {
            if is_newer(field, &rect)? {
                return Ok(true);
            }
        }
    }
    let mut selections = store.fields().iter().filter(|(_, field)| field.kind == FieldKind::Selection);
    // Of its own mask no more counts than where it was painted.
    let is_by_selection = is_made_by_selection(layer)
        || below.into_iter().any(|other| is_made_by_selection(other) || is_masked_by_selection(other));
    match selections.next().filter(|_| is_by_selection) {
        Some((selection, _)) => is_newer(*selection, &region),
        None => Ok(false),
    }
}

fn is_made_by_selection(layer: &Layer) -> bool {
    layer.content.procedure().is_some_and(|procedure| crate::apply::needs_selection(&procedure.brush))
}

fn is_masked_by_selection(layer: &Layer) -> bool {
    let is_gate = |term: &MaskTerm| matches!(&term.source, MaskSource::Gate(gate) if gate.selection);
    layer.mask_terms.iter().any(is_gate)
}
