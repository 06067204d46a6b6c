//! What is looked at without leaving the device that it was painted on.
//!
//! Where a terrain is seen as one field is, on the device that its brushes work on, parts of pages that have changed are handed over as
//! they lie there. Whoever draws copies them, and nothing goes through memory.

use orogeny_brush::{Executor, Levels};
use orogeny_field::{FieldId, PageLayout, SampleRect, TerrainGrid};
use orogeny_store::Layer;

use super::looker::{Looker, rect_of};
use super::{PageData, PageRequest};
use crate::composite::{FieldPages, RecordingPages, StorePages};
use crate::hand::SoFar;
use crate::{Result, Terrain};

impl Looker {
    /// Parts of pages as a stroke has left them so far; `None` where that has to be worked out in memory.
    pub(super) fn parts_in(
        &mut self,
        grid: &TerrainGrid,
        so_far: &mut SoFar<'_, '_, '_>,
        requests: &[PageRequest],
    ) -> Result<Option<Vec<PageData>>> {
        if !self.is_drawn_on(so_far.executor) {
            return Ok(None);
        }
        let recording = so_far.pages.recording();
        let layers = recording.layers().to_vec();
        let mut pages = RecordingPages::new(recording)?;
        let layout = pages.layout();
        if self.only_field(&layers, &mut pages)? != Some(so_far.field) {
            return Ok(None);
        }
        let wanted = wanted(grid, layout, requests);
        let levels = so_far.executor.levels(so_far.field, grid, &wanted, so_far.pages)?;
        let part = |levels: &Levels, request: &PageRequest| {
            Some(PageData {
                place: request.place,
                rect: rect_of(grid, layout, request),
                heights: Vec::new(),
                on_device: Some(levels.planes.get(usize::from(request.place.level))?.clone()?),
                bounds: Some(levels.bounds),
                masks: None,
                unpainted_masks: None,
                earlier: None,
                summaries: Vec::new(),
            })
        };
        Ok(levels.and_then(|levels| requests.iter().map(|request| part(&levels, request)).collect()))
    }

    /// Has parts of pages of what is on disk come as they lie on the device, too, where they still do.
    pub(super) fn add_parts(
        &self,
        terrain: &mut Terrain,
        requests: &[PageRequest],
        pages: &mut [PageData],
    ) -> Result<()> {
        if self.shows_masks() || !requests.iter().any(PageRequest::is_part) {
            return Ok(());
        }
        if !terrain.executor().is_some_and(|executor| self.is_drawn_on(executor)) {
            return Ok(());
        }
        let (grid, store) = (terrain.grid(), terrain.settled()?);
        let layout = store.layout();
        let Some(field) = self.only_field(store.layers(), &mut StorePages::new(store))? else {
            return Ok(());
        };
        let parts: Vec<_> = requests.iter().copied().filter(PageRequest::is_part).collect();
        let Some(levels) = terrain.levels(field, &wanted(&grid, layout, &parts))? else { return Ok(()) };
        for (request, page) in requests.iter().zip(pages).filter(|(request, _)| request.is_part()) {
            page.on_device = levels.planes.get(usize::from(request.place.level)).cloned().flatten();
        }
        Ok(())
    }

    /// Whether an executor's device is that of whoever looks, at what is there now.
    fn is_drawn_on(&self, executor: &dyn Executor) -> bool {
        self.past().is_none() && self.drawn_on.is_some() && executor.device() == self.drawn_on.as_ref()
    }

    /// The field that is seen as it is, if nothing else is.
    fn only_field(&self, layers: &[Layer], pages: &mut dyn FieldPages) -> Result<Option<FieldId>> {
        let nodes = self.compositor.borrow_mut().nodes(layers, pages)?;
        let [only] = nodes.as_slice() else { return Ok(None) };
        let field = layers.iter().find(|layer| layer.id == only.id).map(|layer| layer.heights);
        Ok(field.filter(|field| only.is_field(*field)))
    }
}

/// All that is asked for of each level.
fn wanted(grid: &TerrainGrid, layout: PageLayout, requests: &[PageRequest]) -> Vec<SampleRect> {
    let mut wanted = Vec::new();
    for request in requests {
        let level = usize::from(request.place.level);
        if wanted.len() <= level {
            wanted.resize(level + 1, SampleRect::EMPTY);
        }
        if let Some(all) = wanted.get_mut(level) {
            *all = all.bounds_with(&rect_of(grid, layout, request));
        }
    }
    wanted
}
