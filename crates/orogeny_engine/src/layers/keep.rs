//! Effects that are kept: worked out over their mask's bounds when that is asked for, as the difference to what is below; and
//! whether what is below has changed since.

use orogeny_brush::{Canvas, plan_fill};
use orogeny_field::{
    Blend, FieldId, LayerContent, LayerTransform, MaskCombine, MaskSource, MaskTerm, Page, PageKey,
    PageLayout, Procedure, SampleRect, TerrainGrid,
};
use orogeny_pages::{BoxError, PageStore};
use orogeny_store::{BlobHash, FieldKind, Layer, MadeMask, MadeOf, Recording, Store};

use super::copy::num_below;
use super::{Stack, refused};
use crate::composite::{
    self, Compositor, FieldPages as _, Live, Look, Node, RecordingPages, StorePages, with_groups,
};
use crate::progress::report;
use crate::terrain::find_layer;
use crate::{Error, Observer, Result};

/// The field that is worked on, and that gates look at: what is below the layer. No terrain has one of this number.
const BELOW: FieldId = FieldId(u32::MAX - 1);
const NO_FIELD: FieldId = FieldId(u32::MAX);
/// Pages that are run at once: after each such piece the observer may cancel.
const BATCH_PAGES: usize = 64;

impl Stack<'_, '_, '_> {
    /// Works all that is kept of a layer out anew.
    pub(super) fn refresh_all(&mut self, layer: &Layer) -> Result<()> {
        if let Some(MadeMask { brush, invert, scale, .. }) = &layer.made_mask {
            self.make_mask(layer, brush, *invert, *scale)?;
            if !layer.content.is_kept() {
                return Ok(());
            }
        }
        self.refresh(layer)
    }

    /// What something is made of that is worked out now.
    pub(super) fn made_of(&mut self, layer: &Layer, region: SampleRect) -> Result<MadeOf> {
        let entry = self.recording.with_transaction(|transaction| Ok(transaction.entry()))?;
        Ok(MadeOf {
            entry: entry.0,
            region: [region.x0, region.z0, region.x1, region.z1],
            layers: hash_below(self.recording.layers(), layer)?,
        })
    }

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
        let nodes = self.site.compositor.nodes(&layers, &mut pages)?;
        let below = nodes.get(..num_below(&layers, &nodes, layer.id)).unwrap_or_default();
        // What the last time left beyond the region goes.
        let mut stale = self.recording.page_keys(layer.heights)?;
        let canvas = Canvas { selection, ..Canvas::heights(self.site.grid, self.site.layout, BELOW) };
        if !region.is_empty() {
            let mut pages = BelowPages {
                grid: self.site.grid,
                layout: self.site.layout,
                recording: self.recording,
                compositor: self.site.compositor,
                below,
                heights: layer.heights,
                written: Vec::new(),
                asked_for: Vec::new(),
            };
            let batch = plan_fill(&live.brush, live.seed, canvas, live.resources, region, &mut pages)?;
            let run = run(batch, self.site.layout, self.site.executor, &mut pages, self.site.observer);
            let BelowPages { written, mut asked_for, .. } = pages;
            asked_for.sort_unstable();
            asked_for.dedup();
            match run {
                Ok(()) => self.site.executor.forget(&asked_for),
                Err(err) => {
                    self.site.executor.cancel();
                    return Err(err);
                }
            }
            stale.retain(|key| !written.contains(key));
            self.written.extend(written);
        }
        let zero = Page::constant(self.site.layout, 0.0);
        self.write(stale.into_iter().map(|key| (key, zero.clone())).collect())?;
        let made_of = self.made_of(layer, region)?;
        Ok(self.recording.set_layer(Layer { made_of: Some(made_of), ..layer.clone() })?)
    }

    /// The samples where a layer's masks, and those of its groups, may let it count.
    fn mask_bounds(&mut self, layers: &[Layer], layer: &Layer) -> Result<SampleRect> {
        let (grid, layout) = (self.site.grid, self.site.layout);
        mask_bounds(layers, layer, &grid, layout, |field| Ok(self.recording.page_keys(field)?))
    }
}

/// The samples where a layer's masks, and those of its groups, may let it count, by the pages that they are made of.
fn mask_bounds(
    layers: &[Layer],
    layer: &Layer,
    grid: &TerrainGrid,
    layout: PageLayout,
    mut page_keys: impl FnMut(FieldId) -> Result<Vec<PageKey>>,
) -> Result<SampleRect> {
    let mut bounds = grid.bounds();
    let mut painted_bounds = |field: FieldId, transform: &LayerTransform| -> Result<SampleRect> {
        let keys = page_keys(field)?;
        let painted =
            keys.iter().fold(SampleRect::EMPTY, |rect, key| rect.bounds_with(&layout.page_rect(key)));
        if transform.is_identity() || painted.is_empty() {
            return Ok(painted);
        }
        let placement = transform.placement(grid.spacing_m());
        Ok(placement.terrain_rect(&painted.grown(4)))
    };
    for masked in with_groups(layers, layer) {
        if let Some(mask) = composite::painted_mask(masked).filter(|mask| mask.constant == 0.0) {
            bounds = bounds.intersection(&painted_bounds(mask.field, &mask.transform)?);
        }
        for term in &masked.mask_terms {
            let narrows = matches!(term.combine, MaskCombine::Multiply | MaskCombine::Min);
            if !narrows || term.is_inverted || term.curve.is_some() {
                // Something after it may let it count elsewhere.
                if matches!(term.combine, MaskCombine::Add | MaskCombine::Max) {
                    bounds = grid.bounds();
                }
                continue;
            }
            let seen = term.source.layer().and_then(|seen| find_layer(layers, Some(seen)).ok());
            // Where the other layer has nothing painted the term is 0.
            let nothing = seen.and_then(|seen| match term.source {
                MaskSource::Heights { low, high, .. } => {
                    let constant_m = f64::from(seen.constant_m) * seen.transform.height_scale;
                    (low < high && constant_m <= low).then_some((seen.heights, seen.transform))
                }
                MaskSource::Mask(_) => {
                    let mask = composite::painted_mask(seen).filter(|mask| mask.constant == 0.0)?;
                    Some((mask.field, mask.transform))
                }
                MaskSource::Gate(_) => None,
            });
            if let Some((field, transform)) = nothing {
                let blur = (4.0 * term.blur_m / grid.spacing_m()).ceil() as i32 + 1;
                let painted = painted_bounds(field, &transform)?;
                let painted = if painted.is_empty() { painted } else { painted.grown(blur) };
                bounds = bounds.intersection(&painted);
            }
        }
    }
    Ok(bounds)
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
    let own = Layer { made_of: None, made_mask: None, blend: Blend::default(), mask: None, ..held(layer) };
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

/// Whether what is kept of a layer, its effect or its mask, is something else than it would be made into now.
///
/// # Errors
/// [`Error::Store`] when the directory cannot be read.
pub(crate) fn is_stale(store: &Store, layer: &Layer) -> Result<bool> {
    let of_mask = match &layer.made_mask {
        Some(made) => is_changed_since(store, layer, &made.brush, &made.made_of)?,
        None => false,
    };
    Ok(of_mask || is_effect_stale(store, layer)?)
}

fn is_effect_stale(store: &Store, layer: &Layer) -> Result<bool> {
    let Some(procedure) = layer.content.procedure().filter(|_| layer.content.is_kept()) else {
        return Ok(false);
    };
    let Some(made_of) = &layer.made_of else { return Ok(true) };
    // Its mask may have been painted beyond what it was made for.
    let grid = store.grid();
    let masked = mask_bounds(store.layers(), layer, &grid, store.layout(), |field| {
        Ok(store.page_keys_in(field, 0, &grid.bounds())?)
    })?;
    let [x0, z0, x1, z1] = made_of.region;
    let is_beyond = !masked.is_empty() && !SampleRect::new(x0, z0, x1, z1).contains(&masked);
    Ok(is_beyond || is_changed_since(store, layer, procedure, made_of)?)
}

/// Whether anything that a brush made something of was changed since, within its region or as far around that as it looks.
fn is_changed_since(store: &Store, layer: &Layer, procedure: &Procedure, made_of: &MadeOf) -> Result<bool> {
    let layers = store.layers();
    if hash_below(layers, layer)? != made_of.layers {
        return Ok(true);
    }
    let [x0, z0, x1, z1] = made_of.region;
    let region = SampleRect::new(x0, z0, x1, z1);
    let region = if region.is_empty() { region } else { region.grown(reach(store, layer, procedure)?) };
    let is_newer = |field: FieldId, rect: &SampleRect| -> Result<bool> {
        Ok(store.newest_revision(field, rect)?.is_some_and(|newest| newest.0 > made_of.entry))
    };
    let below = below(layers, layer);
    let fields = below.iter().copied().chain(looked_at(layers, &below));
    let fields =
        fields.flat_map(|other| [Some((other, other.heights)), other.mask.map(|mask| (other, mask))]);
    // A mask looks at the layer's own heights, too.
    let own = (layer.content == LayerContent::Heights).then_some((layer, layer.heights));
    for (from, field) in fields.chain([own]).flatten() {
        // A moved layer's pages may lie anywhere.
        let rect = if from.transform.is_identity() { region } else { store.grid().bounds() };
        if is_newer(field, &rect)? {
            return Ok(true);
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

/// How far around a region what a brush makes of what is below a layer depends on that, in samples.
fn reach(store: &Store, layer: &Layer, procedure: &Procedure) -> Result<i32> {
    let mut pages = StorePages::new(store);
    let nodes = composite::nodes(store.layers(), &mut pages)?;
    let below = nodes.get(..num_below(store.layers(), &nodes, layer.id)).unwrap_or_default();
    let live = Live::new(procedure, &mut pages)?;
    composite::reach(&mut Look::new(store.grid(), 0, &mut pages)?, below, &live)
}

fn is_made_by_selection(layer: &Layer) -> bool {
    let of_mask = layer.made_mask.as_ref().map(|made| &made.brush);
    let brushes = layer.content.procedure().into_iter().chain(of_mask);
    brushes.into_iter().any(|procedure| crate::apply::needs_selection(&procedure.brush))
}

fn is_masked_by_selection(layer: &Layer) -> bool {
    let is_gate = |term: &MaskTerm| matches!(&term.source, MaskSource::Gate(gate) if gate.selection);
    layer.mask_terms.iter().any(is_gate)
}
