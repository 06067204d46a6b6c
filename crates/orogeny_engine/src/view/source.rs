//! The composite as the renderer asks for it: pages, and what is known of them without reading them.

use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap};

use orogeny_field::{FieldId, HeightBounds, Page, PageKey, PageLayout, SampleRect};
use orogeny_geomip::{PagePlace, PageSummaries, PageSummary};
use orogeny_store::{FieldKind, Store};

use crate::composite::{Composite, Compositor, Source, damage_notice, summary};
use crate::{Error, Result};

/// All of a page, in samples of its level, beyond the terrain's edge too.
pub(crate) fn page_rect(layout: PageLayout, PagePlace { level, z, x }: PagePlace) -> SampleRect {
    layout.page_rect(&PageKey { field: FieldId(0), level, z, x })
}

/// The name of the terrain's selection among masks.
pub(super) const SELECTION: &str = "selection";

/// A mask of the terrain: its field, where it was painted, and its value everywhere else.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Mask {
    field: Option<FieldId>,
    constant: f32,
}

impl Mask {
    fn key(&self, PagePlace { level, z, x }: PagePlace) -> Option<PageKey> {
        Some(PageKey { field: self.field?, level, z, x })
    }
}

/// A store's composite.
pub(crate) struct CompositeSource<'a> {
    store: &'a Store,
    compositor: &'a RefCell<Compositor>,
    /// What is shown over the ground, or asked for by materials.
    masks: Vec<Mask>,
    /// What it is compared with: the same terrain as it was.
    earlier: Option<Box<Self>>,
    known: RefCell<HashMap<PagePlace, PageSummary>>,
    /// Damaged pages of which a coarser level is shown.
    damaged: RefCell<BTreeSet<PageKey>>,
    /// The first thing that could not be read of the directory.
    failure: RefCell<Option<Error>>,
}

impl<'a> CompositeSource<'a> {
    pub(crate) fn new(store: &'a Store, compositor: &'a RefCell<Compositor>) -> Self {
        Self {
            store,
            compositor,
            masks: Vec::new(),
            earlier: None,
            known: RefCell::default(),
            damaged: RefCell::default(),
            failure: RefCell::default(),
        }
    }

    /// Is compared with an earlier state from now on: what is known of a page then holds for both.
    pub(crate) fn compare_with(&mut self, earlier: Self) {
        self.earlier = Some(Box::new(earlier));
        self.known.borrow_mut().clear();
    }

    /// A page of the earlier state, where there is one to compare with.
    pub(crate) fn earlier_page(&self, place: PagePlace) -> Result<Option<Page>> {
        self.earlier.as_ref().map(|earlier| earlier.page(place)).transpose()
    }

    /// The mask of a layer by its name, or the terrain's selection: `selection`.
    pub(crate) fn mask(&self, name: &str) -> Option<Mask> {
        let layer = self.store.layers().iter().find(|layer| layer.name == name);
        let field = match layer {
            // One that was never painted is 1 everywhere.
            Some(layer) => layer.mask,
            None if name == SELECTION => {
                let mut fields = self.store.fields().iter();
                fields.find(|(_, field)| field.kind == FieldKind::Selection).map(|(id, _)| *id)
            }
            None => return None,
        };
        let constant = field.and_then(|field| self.store.fields().get(&field)).map(|field| field.constant);
        Some(Mask { field, constant: constant.unwrap_or(if layer.is_some() { 1.0 } else { 0.0 }) })
    }

    /// Shows these masks, four at most, from now on; tells whether they are others than before.
    pub(crate) fn show(&mut self, masks: Vec<Mask>) -> bool {
        let is_new = self.masks != masks;
        if is_new {
            self.masks = masks;
            self.known.borrow_mut().clear();
        }
        is_new
    }

    /// What the masks are where nothing was painted.
    pub(crate) fn unpainted_masks(&self) -> [f32; 4] {
        let mut unpainted = [0.0; 4];
        for (to, mask) in unpainted.iter_mut().zip(&self.masks) {
            *to = mask.constant;
        }
        unpainted
    }

    /// The masks over a page; `None` where none is shown. A damaged one is as if it was never painted.
    pub(crate) fn masks_over(&self, place: PagePlace) -> Option<Vec<[u8; 4]>> {
        if self.masks.is_empty() {
            return None;
        }
        let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        let mut samples = vec![self.unpainted_masks().map(byte); self.store.layout().num_samples()];
        for (channel, mask) in self.masks.iter().enumerate() {
            let page = mask.key(place).and_then(|key| {
                let loaded = self.store.load_page(&key);
                loaded.unwrap_or_else(|_| {
                    self.damaged.borrow_mut().insert(key);
                    None
                })
            });
            for (sample, value) in samples.iter_mut().zip(page.iter().flat_map(|page| page.samples())) {
                if let Some(sample) = sample.get_mut(channel) {
                    *sample = byte(*value);
                }
            }
        }
        Some(samples)
    }

    pub(super) fn layout(&self) -> PageLayout {
        self.store.layout()
    }

    /// A page of the composite; where one is damaged, of what is left of it.
    pub(crate) fn page(&self, place: PagePlace) -> Result<Page> {
        let layout = self.store.layout();
        let page_rect = page_rect(layout, place);
        let rect = page_rect.intersection(&self.store.grid().bounds_at(place.level));
        let mut page = Page::constant(layout, 0.0);
        let mut rows = Composite::new(
            self.store,
            self.compositor,
            Source::Composite,
            place.level,
            rect,
            layout.size_in_bytes(),
        )
        .show_damage();
        for z in 0..rect.depth() {
            if let Some(row) = page.row_mut(z, 0, rect.width()) {
                rows.read_rows(row)?;
            }
        }
        self.damaged.borrow_mut().extend(rows.damaged());
        Ok(page)
    }

    fn surface(&self, key: &PageKey) -> Option<(HeightBounds, f32)> {
        self.store.page_surface(key).unwrap_or_else(|err| {
            self.failure.borrow_mut().get_or_insert(err.into());
            None
        })
    }

    /// Whether all of the directory could be read so far.
    pub(crate) fn check(&self) -> Result<()> {
        self.failure.borrow_mut().take().map_or(Ok(()), Err)?;
        self.earlier.as_ref().map_or(Ok(()), |earlier| earlier.check())
    }

    /// What of the pictures so far could not be shown as it is.
    pub(super) fn notices(&self) -> Vec<String> {
        let earlier = self.earlier.iter().flat_map(|earlier| earlier.notices());
        let notices: BTreeSet<_> = self.damaged.borrow().iter().map(damage_notice).chain(earlier).collect();
        notices.into_iter().collect()
    }

    /// What cannot be read or worked out counts as constant, and is told by [`Self::check`].
    fn read_summary(&self, place: PagePlace) -> PageSummary {
        let found = summary(self.store, &mut self.compositor.borrow_mut(), place);
        let summary = found.unwrap_or_else(|err| {
            self.failure.borrow_mut().get_or_insert(err);
            PageSummary { bounds: HeightBounds::of(0.0), error_m: 0.0, is_constant: true }
        });
        let is_masked = |mask: &Mask| mask.key(place).is_some_and(|key| self.surface(&key).is_some());
        let summary =
            PageSummary { is_constant: summary.is_constant && !self.masks.iter().any(is_masked), ..summary };
        let Some(earlier) = &self.earlier else { return summary };
        let earlier = earlier.summary(place);
        PageSummary {
            bounds: summary.bounds.with(earlier.bounds),
            error_m: summary.error_m.max(earlier.error_m),
            is_constant: summary.is_constant && earlier.is_constant,
        }
    }
}

impl PageSummaries for CompositeSource<'_> {
    fn summary(&self, place: PagePlace) -> PageSummary {
        *self.known.borrow_mut().entry(place).or_insert_with(|| self.read_summary(place))
    }
}
