//! Answers those who look: pages of the composite, of what is on disk or of a stroke on its way.

use std::cell::RefCell;

use orogeny_field::{PageLayout, SampleRect, TerrainGrid};
use orogeny_geomip::{PagePlace, PageSummaries as _, PageSummary};
use orogeny_gpu::Gpu;
use orogeny_store::{Layer, Recording, Store};

use super::{Earlier, PageData, PageRequest};
use crate::composite::{self, Change, Compositor, Look, RecordingPages, Source, StorePages};
use crate::view::{CompositeSource, page_rect};
use crate::{Result, Settings, Terrain};

/// Works out what is looked at. Its own of everything, as what it keeps is of another moment than what brushes see.
pub(super) struct Looker {
    pub(super) compositor: RefCell<Compositor>,
    /// The device that is drawn on, where brushes are to work on it too.
    pub(super) drawn_on: Option<Gpu>,
    /// Names of the masks that come with pages.
    masks: Vec<String>,
    /// The terrain as it was, that comes with pages.
    past: Option<Past>,
}

/// An earlier state of the terrain.
struct Past {
    terrain: Terrain,
    /// Its height where nothing is painted, metres.
    unpainted_m: f32,
}

impl Looker {
    pub(super) fn new(settings: &Settings) -> Self {
        let compositor = RefCell::new(Compositor::new(settings));
        Self { compositor, drawn_on: settings.adapter.shared().cloned(), masks: Vec::new(), past: None }
    }

    pub(super) fn show_masks(&mut self, names: Vec<String>) {
        self.masks = names;
    }

    /// Whether more is shown than heights.
    pub(super) const fn shows_masks(&self) -> bool {
        !self.masks.is_empty()
    }

    pub(super) fn open_past(&mut self, terrain: Terrain) -> Result<()> {
        let unpainted_m = terrain.unpainted_height_m()?;
        self.past = Some(Past { terrain, unpainted_m });
        Ok(())
    }

    /// The file is read by no one else then.
    pub(super) fn close_past(&mut self) {
        self.past = None;
    }

    pub(super) fn past(&self) -> Option<&Terrain> {
        self.past.as_ref().map(|past| &past.terrain)
    }

    /// What is on disk, and what it is compared with.
    fn source<'a>(&'a self, store: &'a Store) -> Result<CompositeSource<'a>> {
        let mut source = CompositeSource::new(store, &self.compositor);
        if let Some(past) = self.past() {
            source.compare_with(CompositeSource::new(past.settled()?, past.compositor()));
        }
        Ok(source)
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
        let source = self.source(store)?;
        let summary = source.summary(place);
        source.check()?;
        Ok((place, summary))
    }

    /// Pages of what is on disk.
    pub(super) fn pages(&self, terrain: &Terrain, requests: &[PageRequest]) -> Result<Vec<PageData>> {
        let store = terrain.settled()?;
        let (grid, layout) = (terrain.grid(), store.layout());
        let mut source = self.source(store)?;
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
                on_device: None,
                bounds: None,
                masks: source.masks_over(place),
                unpainted_masks: Some(source.unpainted_masks()),
                earlier: self.earlier(&grid, layout, place, rect)?,
                summaries: known.map(|place| (place, source.summary(place))).collect(),
            })
        };
        let pages = requests.iter().map(page).collect::<Result<_>>()?;
        source.check()?;
        Ok(pages)
    }

    /// A page as it was, if all of the page is asked for.
    fn earlier(
        &self,
        grid: &TerrainGrid,
        layout: PageLayout,
        place: PagePlace,
        rect: SampleRect,
    ) -> Result<Option<Earlier>> {
        let whole = rect_of(grid, layout, &PageRequest { place, rect: None });
        let Some(Past { terrain, unpainted_m }) = self.past.as_ref().filter(|_| rect == whole) else {
            return Ok(None);
        };
        let source = CompositeSource::new(terrain.settled()?, terrain.compositor());
        Ok(Some(Earlier { page: source.page(place)?, unpainted_m: *unpainted_m }))
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
        let mut page = |request: &PageRequest| {
            let rect = rect_of(grid, layout, request);
            let mut compositor = self.compositor.borrow_mut();
            let heights = heights(grid, &mut compositor, &layers, &mut pages, request.place, rect)?;
            Ok(PageData {
                place: request.place,
                rect,
                heights,
                on_device: None,
                bounds: None,
                masks: None,
                unpainted_masks: None,
                earlier: self.earlier(grid, layout, request.place, rect)?,
                summaries: Vec::new(),
            })
        };
        requests.iter().map(&mut page).collect()
    }
}

/// What of a page is asked for, within the terrain.
pub(super) fn rect_of(grid: &TerrainGrid, layout: PageLayout, request: &PageRequest) -> SampleRect {
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
