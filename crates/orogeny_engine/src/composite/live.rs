//! What a brush makes of a rectangle of ground that no file has: a fill over planes in memory.

use std::collections::{BTreeSet, HashMap};

use orogeny_brush::filter::{self, Step};
use orogeny_brush::{Batch, Canvas, Executor, Pass, Resources, Rule, plan_fill};
use orogeny_field::{
    Brush, BrushType, FieldId, Footprint, Instance, LAYER_PYRAMID_LEVELS, Page, PageKey, PageLayout, Plane,
    Procedure, SampleRect, SmoothMethod, Smoothing, TerrainGrid,
};
use orogeny_pages::{BoxError, MemoryPages, PageStore};

use super::content::cut;
use super::node::Live;
use super::{FieldPages, Look};
use crate::{Error, Result};

/// The planes, as fields; no terrain has one of these numbers.
pub(super) const GROUND: FieldId = FieldId(u32::MAX - 1);
pub(super) const BELOW: FieldId = FieldId(u32::MAX - 2);
pub(super) const HEIGHTS: FieldId = FieldId(u32::MAX - 3);
pub(super) const WEIGHTS: FieldId = FieldId(u32::MAX - 4);
const NO_FIELD: FieldId = FieldId(u32::MAX);

/// Pages that are run at once.
const BATCH_PAGES: usize = 64;

/// Planes as an executor sees them.
pub(super) struct PlanePages<'a> {
    planes: Vec<(FieldId, &'a Plane)>,
    level: u8,
    layout: PageLayout,
    /// For the selection.
    pages: &'a mut dyn FieldPages,
    /// What became of the ground.
    saved: HashMap<PageKey, Page>,
    asked_for: BTreeSet<PageKey>,
}

impl<'a> PlanePages<'a> {
    pub(super) fn new(look: &'a mut Look<'_>, planes: Vec<(FieldId, &'a Plane)>) -> Self {
        Self {
            planes,
            level: look.level,
            layout: look.layout,
            pages: look.pages,
            saved: HashMap::new(),
            asked_for: BTreeSet::new(),
        }
    }
}

impl PageStore for PlanePages<'_> {
    fn layout(&self) -> PageLayout {
        self.layout
    }

    fn constant(&self, _field: FieldId) -> f32 {
        0.0
    }

    fn load(&mut self, key: &PageKey) -> std::result::Result<Option<Page>, BoxError> {
        match self.saved.get(key) {
            Some(page) => Ok(Some(page.clone())),
            None => self.load_before(key),
        }
    }

    fn load_before(&mut self, key: &PageKey) -> std::result::Result<Option<Page>, BoxError> {
        self.asked_for.insert(*key);
        let plane = self.planes.iter().find(|(field, _)| *field == key.field);
        if let Some((_, plane)) = plane {
            return Ok(Some(cut(plane, self.layout, self.layout.page_rect(key))));
        }
        // What looks at a stored field takes it of the level that is looked at.
        let loaded = self.pages.load(&[PageKey { level: self.level, ..*key }])?;
        Ok(loaded.into_iter().next().flatten().map(|page| (*page).clone()))
    }

    fn save(&mut self, pages: Vec<(PageKey, Page)>) -> std::result::Result<(), BoxError> {
        self.saved.extend(pages);
        Ok(())
    }
}

/// A batch, and the samples that it looks at, within the terrain.
pub(super) struct Planned {
    pub(super) batch: Batch,
    pub(super) needs: SampleRect,
}

impl Planned {
    fn new(look: &Look<'_>, batch: Batch, rect: SampleRect) -> Self {
        let looks_around = batch.pass.gate.is_some() || batch.pass.roughness.is_some();
        let mut needs = rect.grown(i32::from(looks_around));
        if let Rule::Filter(filter) = &batch.pass.rule {
            for (node, rect) in filter.graph.nodes().iter().zip(filter.graph.plan(rect)) {
                match node.step {
                    Step::Heights | Step::Field(_) => needs = needs.bounds_with(&rect),
                    Step::Gate(_) => needs = needs.bounds_with(&rect.grown(1)),
                    _ => {}
                }
            }
        }
        Self { batch, needs: needs.intersection(&look.grid.bounds()) }
    }

    /// How far around a rectangle it looks, wherever that is, at most.
    pub(super) fn halo(&self) -> i32 {
        match &self.batch.pass.rule {
            // Where a grid of a pyramid lies otherwise to the rectangle, up to a sample of its coarsest level more: of which a halo has
            // four at least.
            Rule::Filter(filter) => {
                let halo = filter.graph.halo().cast_signed();
                halo + halo / 4 + 2
            }
            _ => 1,
        }
    }
}

/// Plans what a brush makes of a rectangle at the level that is looked at; `None` where the level is too coarse to show any of it.
pub(super) fn plan(look: &mut Look<'_>, live: &Live, rect: SampleRect) -> Result<Option<Planned>> {
    let selection = look.pages.selection()?.unwrap_or(NO_FIELD);
    let heights = Canvas::heights(look.grid, look.layout, GROUND);
    let canvas = Canvas { heights: BELOW, selection, ..heights };
    plan_on(look, &live.brush, live.seed, canvas, live.resources.clone(), rect)
}

/// Plans a Gaussian blur of a mask, whose standard deviation is `blur_m` metres; `None` where it is too narrow to show.
pub(super) fn plan_blur(look: &mut Look<'_>, blur_m: f64, rect: SampleRect) -> Result<Option<Planned>> {
    if blur_m < 0.25 * look.grid.spacing_m() {
        return Ok(None);
    }
    let smoothing =
        Smoothing { method: SmoothMethod::Gaussian, width_m: Some(blur_m), ..Smoothing::default() };
    let brush = Brush { smoothing, ..Brush::new(BrushType::Smooth, 1.0, 1.0) };
    let heights = Canvas::heights(look.grid, look.layout, GROUND);
    let canvas = Canvas { is_mask: true, ..heights };
    plan_on(look, &brush, 0, canvas, Resources::default(), rect)
}

/// Plans a Laplacian blend of `HEIGHTS` into the ground, by `WEIGHTS`.
pub(super) fn plan_blend(look: &Look<'_>, rect: SampleRect) -> Planned {
    let bounds = look.grid.bounds();
    let filter =
        filter::blend_fields([bounds.width(), bounds.depth()], HEIGHTS, WEIGHTS, LAYER_PYRAMID_LEVELS);
    let pass = Pass::new(Rule::Filter(filter), Footprint::EVERYWHERE, GROUND);
    Planned::new(look, Batch::new(pass, look.layout, vec![Instance::EVERYWHERE], vec![rect]), rect)
}

/// Refuses a layer's brush that cannot be worked out on the terrain, or by the back end: the composite could not be looked at with it.
///
/// # Errors
/// [`Error::Brush`], naming its field.
pub(crate) fn check(
    grid: TerrainGrid,
    layout: PageLayout,
    procedure: &Procedure,
    resources: Resources,
    executor: &mut dyn Executor,
) -> Result<()> {
    let canvas = Canvas::heights(grid, layout, GROUND);
    let mut pages = MemoryPages::new(layout, 0.0);
    let rect = SampleRect::new(0, 0, 1, 1);
    let batch = plan_fill(&procedure.brush, procedure.seed, canvas, resources, rect, &mut pages)?;
    if matches!(batch.pass.rule, Rule::Custom(_)) {
        let run = executor.run(&batch, &mut pages).and_then(|()| executor.finish(&mut pages));
        executor.forget(&[PageKey::full_resolution(GROUND, 0, 0)]);
        run?;
    }
    Ok(())
}

fn plan_on(
    look: &mut Look<'_>,
    brush: &Brush,
    seed: u32,
    canvas: Canvas,
    resources: Resources,
    rect: SampleRect,
) -> Result<Option<Planned>> {
    // A plan looks at no page: what it needs of the ground it says.
    let mut none = PlanePages::new(look, Vec::new());
    let batch = match plan_fill(brush, seed, canvas, resources, rect, &mut none) {
        // Its octaves are all narrower than two samples here.
        Err(orogeny_brush::Error::Field(orogeny_field::Error::FeatureSize { .. })) if look.level > 0 => {
            return Ok(None);
        }
        planned => planned?,
    };
    Ok(Some(Planned::new(look, batch, rect)))
}

/// Runs what was planned; gives what became of the ground within a rectangle.
pub(super) fn run(
    look: &mut Look<'_>,
    executor: &mut dyn Executor,
    planned: Planned,
    planes: Vec<(FieldId, &Plane)>,
    rect: SampleRect,
) -> Result<Plane> {
    if let Some(plane) = executor.run_over_planes(&planned.batch, &planes, rect)? {
        return Ok(plane);
    }
    let ground = planes.iter().find(|(field, _)| *field == GROUND).map(|(_, plane)| *plane);
    let mut result = Plane::constant(rect, 0.0);
    let layout = look.layout;
    let mut pages = PlanePages::new(look, planes);
    let run = planned
        .batch
        .split(layout, BATCH_PAGES)
        .try_for_each(|piece| executor.run(&piece, &mut pages))
        .and_then(|()| executor.finish(&mut pages));
    match run {
        // The next run has other ground under the same keys.
        Ok(_) => executor.forget(&pages.asked_for.iter().copied().collect::<Vec<_>>()),
        Err(err) => {
            executor.cancel();
            return Err(Error::from(err));
        }
    }
    for (x, z) in layout.pages_in(rect) {
        let key = PageKey::full_resolution(GROUND, x, z);
        let page_rect = layout.page_rect(&key);
        match (pages.saved.get(&key), ground) {
            (Some(page), _) => result.paste(page, &page_rect, &rect),
            // Nothing became of it.
            (None, Some(ground)) => result.paste(&cut(ground, layout, page_rect), &page_rect, &rect),
            (None, None) => {}
        }
    }
    Ok(result)
}
