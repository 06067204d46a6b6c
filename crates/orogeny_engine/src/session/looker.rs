//! Answers those who look: pages of the composite, of what is on disk or of a stroke on its way.

use std::cell::RefCell;

use orogeny_field::{PageLayout, SampleRect, TerrainGrid};
use orogeny_geomip::{PagePlace, PageSummaries as _, PageSummary};
use orogeny_store::{Layer, Recording};

use super::{PageData, PageRequest};
use crate::composite::{self, Change, Compositor, Look, RecordingPages, Source, StorePages};
use crate::view::{CompositeSource, page_rect};
use crate::{Result, Settings, Terrain};

/// Works out what is looked at. Its own of everything, as what it keeps is of another moment than what brushes see.
pub(super) struct Looker {
    compositor: RefCell<Compositor>,
    /// Names of the masks that come with pages.
    masks: Vec<String>,
}

impl Looker {
    pub(super) fn new(settings: &Settings) -> Self {
        Self { compositor: RefCell::new(Compositor::new(settings)), masks: Vec::new() }
    }

    pub(super) fn show_masks(&mut self, names: Vec<String>) {
        self.masks = names;
    }

    /// Whether more is shown than heights.
    pub(super) const fn shows_masks(&self) -> bool {
        !self.masks.is_empty()
    }

    /// Fields were changed; gives what changed by that of what is seen, for each level.
    pub(super) fn forget(
        &mut self,
        grid: &TerrainGrid,
        layout: PageLayout,
        changes: &[Change],
    ) -> Vec<SampleRect> {
        self.compositor.get_mut().forget(grid, layout, changes)
    }

    pub(super) fn forget_all(&mut self) {
        self.compositor.get_mut().forget_all();
    }

    /// What is known of all of the terrain.
    pub(super) fn root(&self, terrain: &Terrain) -> Result<(PagePlace, PageSummary)> {
        let store = terrain.settled()?;
        let place = PagePlace::root(&terrain.grid(), store.layout());
        Ok((place, composite::summary(store, &mut self.compositor.borrow_mut(), place)?))
    }

    /// Pages of what is on disk.
    pub(super) fn pages(&self, terrain: &Terrain, requests: &[PageRequest]) -> Result<Vec<PageData>> {
        let store = terrain.settled()?;
        let (grid, layout) = (terrain.grid(), store.layout());
        let mut source = CompositeSource::new(store, &self.compositor);
        // A layer that is no longer there has nothing to show.
        source.show(self.masks.iter().map(|name| source.mask(name).unwrap_or_default()).collect());
        let page = |request: &PageRequest| {
            let place = request.place;
            let mut pages = StorePages::showing_damage(store);
            let rect = rect_of(&grid, layout, request);
            let heights =
                heights(&grid, &mut self.compositor.borrow_mut(), store.layers(), &mut pages, place, rect)?;
            let known = std::iter::once(place).chain(place.children(&grid, layout));
            Ok(PageData {
                place,
                rect,
                heights,
                masks: source.masks_over(place),
                unpainted_masks: Some(source.unpainted_masks()),
                summaries: known.map(|place| (place, source.summary(place))).collect(),
            })
        };
        let pages = requests.iter().map(page).collect::<Result<_>>()?;
        source.check()?;
        Ok(pages)
    }

    /// Pages as a stroke has left them so far. What it paints on a mask or on the selection is not among them.
    pub(super) fn pages_in(
        &mut self,
        grid: &TerrainGrid,
        recording: &mut Recording<'_>,
        requests: &[PageRequest],
    ) -> Result<Vec<PageData>> {
        let layers = recording.layers().to_vec();
        let mut pages = RecordingPages::new(recording)?;
        let layout = composite::FieldPages::layout(&pages);
        let compositor = self.compositor.get_mut();
        let mut page = |request: &PageRequest| {
            let rect = rect_of(grid, layout, request);
            let heights = heights(grid, compositor, &layers, &mut pages, request.place, rect)?;
            Ok(PageData {
                place: request.place,
                rect,
                heights,
                masks: None,
                unpainted_masks: None,
                summaries: Vec::new(),
            })
        };
        requests.iter().map(&mut page).collect()
    }
}

/// What of a page is asked for, within the terrain.
fn rect_of(grid: &TerrainGrid, layout: PageLayout, request: &PageRequest) -> SampleRect {
    let page = page_rect(layout, request.place).intersection(&grid.bounds_at(request.place.level));
    request.rect.map_or(page, |rect| rect.intersection(&page))
}

fn heights(
    grid: &TerrainGrid,
    compositor: &mut Compositor,
    layers: &[Layer],
    pages: &mut dyn composite::FieldPages,
    place: PagePlace,
    rect: SampleRect,
) -> Result<Vec<f32>> {
    if rect.is_empty() {
        return Ok(Vec::new());
    }
    let mut look = Look::new(*grid, place.level, pages)?;
    let plane = composite::read(compositor, layers, &mut look, Source::Composite, rect)?;
    Ok(plane.samples().to_vec())
}
