//! The stack worked out: layers joined from the bottom, over the rectangle of a level that is looked at.

use std::sync::Arc;

use orogeny_brush::Executor;
use orogeny_field::{
    Blend, FieldId, MAX_SPACING_M, Page, PageKey, PageLayout, Plane, SampleRect, TerrainGrid, rect_above,
};
use orogeny_store::Layer;
use rayon::prelude::*;

use super::cache::{Cache, CacheKey, Kind};
use super::content::{cropped, cut, patch, samples, stored};
use super::live::{self, BELOW, GROUND, HEIGHTS, WEIGHTS};
use super::node::{Content, Node, nodes};
use super::samples::{Part, Samples, Weights, joined};
use super::stale::Stale;
use super::weights::{self, weights};
use super::{FieldPages, Live};
use crate::Result;
use crate::access::Shares;
use crate::backend::{self, Settings};

/// Pages that are worked out at once where a barrier lacks them: their halo is looked at once.
const BLOCK_PAGES: u32 = 8;

/// Pages of layers that are read before they are joined, in bytes: all of them at once, but of a large rectangle a few layers at a time.
const MAX_JOINED_BYTES: u64 = 16 << 20;

/// Where and how the stack is looked at.
pub(crate) struct Look<'a> {
    /// The terrain at full resolution.
    pub(crate) terrain: TerrainGrid,
    /// Its samples at the level.
    pub(crate) grid: TerrainGrid,
    pub(crate) layout: PageLayout,
    pub(crate) level: u8,
    /// What is stored.
    pub(crate) pages: &'a mut dyn FieldPages,
}

impl<'a> Look<'a> {
    /// At a level of a terrain.
    pub(crate) fn new(terrain: TerrainGrid, level: u8, pages: &'a mut dyn FieldPages) -> Result<Self> {
        let bounds = terrain.bounds_at(level);
        let spacing_m = terrain.spacing_m() * f64::from(1_u32 << level.min(31));
        let grid =
            TerrainGrid::new(bounds.width().into(), bounds.depth().into(), spacing_m.min(MAX_SPACING_M))?;
        Ok(Self { terrain, grid, layout: pages.layout(), level, pages })
    }
}

/// Works out the stack, and keeps what took long.
pub(crate) struct Compositor {
    settings: Settings,
    /// The layers that `nodes` were made of.
    layers: Vec<Layer>,
    nodes: Arc<Vec<Node>>,
    cache: Cache,
    /// Made when the first brush is to be worked out.
    executor: Option<Box<dyn Executor>>,
}

impl std::fmt::Debug for Compositor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Compositor").field("layers", &self.layers).finish_non_exhaustive()
    }
}

impl Compositor {
    pub(crate) fn new(settings: &Settings) -> Self {
        let shares = Shares::of(settings.page_budget_in_bytes);
        Self {
            settings: settings.clone(),
            layers: Vec::new(),
            nodes: Arc::default(),
            cache: Cache::new(shares.composite_in_bytes),
            executor: None,
        }
    }

    /// The visible layers, as they count. What is kept of those that changed, and of all above them, is dropped.
    pub(crate) fn nodes(&mut self, layers: &[Layer], pages: &mut dyn FieldPages) -> Result<Arc<Vec<Node>>> {
        if self.layers != layers {
            let new = nodes(layers, pages)?;
            let num_same = new.iter().zip(self.nodes.iter()).take_while(|(a, b)| a.is_same(b)).count();
            let same: Vec<u32> = new.iter().take(num_same).map(|node| node.id).collect();
            let is_same = |layer: u32, old: &[Node]| {
                let find = |nodes: &[Node]| nodes.iter().position(|node| node.id == layer);
                let (Some(a), Some(b)) = (find(&new), find(old)) else { return false };
                new.get(a).zip(old.get(b)).is_some_and(|(a, b)| a.is_same(b))
            };
            let old = Arc::clone(&self.nodes);
            self.cache.drop_where(|key| match key.kind {
                Kind::Result => !same.contains(&key.layer),
                Kind::Content => !is_same(key.layer, &old),
            });
            self.nodes = Arc::new(new);
            self.layers = layers.to_vec();
        }
        Ok(Arc::clone(&self.nodes))
    }

    /// Another program may have changed any page.
    pub(crate) fn forget_results(&mut self) {
        self.cache.drop_where(|key| key.kind == Kind::Result);
    }

    /// Nothing that is kept can be trusted.
    pub(crate) fn forget_all(&mut self) {
        self.cache.drop_where(|_| true);
    }

    /// Samples of fields were changed, at full resolution: what was worked out of them, at any level, is noted as stale. Gives what of the
    /// stack may have changed by that, for each level, in its samples.
    pub(crate) fn forget(
        &mut self,
        terrain: &TerrainGrid,
        layout: PageLayout,
        changes: &[Change],
    ) -> Vec<SampleRect> {
        // What was worked out of layers that are hidden, for a brush on one of them, is not kept up with what changes.
        let nodes = Arc::clone(&self.nodes);
        let is_hidden = |layer: u32| nodes.iter().all(|node| node.id != layer);
        self.cache.drop_where(|key| key.kind == Kind::Result && is_hidden(key.layer));
        let top = layout.top_level(terrain);
        // For each level what changed of what is below the node.
        let mut changed = vec![SampleRect::EMPTY; usize::from(top) + 1];
        if changes.is_empty() {
            return changed;
        }
        for node in nodes.iter() {
            for stored in node.fields() {
                let mut rect = rect_of(changes, |field| field == stored.field);
                for (level, changed) in (0..).zip(&mut changed) {
                    if rect.is_empty() {
                        break;
                    }
                    let here = if stored.transform.is_identity() {
                        rect
                    } else {
                        let spacing_m = terrain.spacing_m() * f64::from(1_u32 << level);
                        let placement = stored.transform.placement(spacing_m);
                        // It may be looked at on coarser levels, whose samples reach further.
                        let reach = 4.0 * placement.samples_between().max(1.0);
                        placement.terrain_rect(&rect.grown(reach.ceil() as i32)).grown(1)
                    };
                    *changed = changed.bounds_with(&here);
                    rect = rect_above(&rect);
                }
            }
            if node.looks_at_selection() {
                // Which field the selection is does not stand in the node; it is none of its own.
                let mut rect = rect_of(changes, |field| node.fields().all(|stored| stored.field != field));
                for changed in &mut changed {
                    *changed = changed.bounds_with(&rect);
                    rect = if rect.is_empty() { rect } else { rect_above(&rect) };
                }
            }
            if !node.is_barrier() {
                continue;
            }
            let halos = self.halos(node, terrain, layout, top);
            for (changed, halo) in changed.iter_mut().zip(halos) {
                if !changed.is_empty() {
                    *changed = changed.grown(halo);
                }
            }
            self.cache.note_stale(|key| {
                let changed = changed.get(usize::from(key.level)).filter(|_| key.layer == node.id);
                let changed = changed.filter(|_| key.kind == Kind::Result);
                changed.map_or(SampleRect::EMPTY, |changed| changed.intersection(&page_rect(layout, key)))
            });
        }
        changed
    }

    /// How far a node looks around, at each level.
    fn halos(&self, node: &Node, terrain: &TerrainGrid, layout: PageLayout, top: u8) -> Vec<i32> {
        let mut none = NoPages(layout);
        let mut halo_at = |level| -> Result<i32> {
            let look = &mut Look::new(*terrain, level, &mut none)?;
            halo(look, node)
        };
        // What cannot be planned was never worked out; all of it would go.
        (0..=top).map(|level| halo_at(level).unwrap_or(1 << 20)).collect()
    }

    /// What keeping pages and working out brushes takes, in bytes.
    pub(crate) fn memory_in_bytes(&self) -> u64 {
        let executor = self.executor.as_ref().map(|executor| executor.memory());
        self.cache.size_in_bytes() + executor.map_or(0, |memory| memory.host_in_bytes)
    }

    /// What layers, from the lowest, come to in a rectangle, which lies within the terrain.
    pub(crate) fn heights(&mut self, look: &mut Look<'_>, nodes: &[Node], rect: SampleRect) -> Result<Plane> {
        let num_above = nodes.iter().rev().take_while(|node| !node.is_barrier()).count();
        let (below, above) = nodes.split_at(nodes.len() - num_above);
        let mut below = match below.split_last() {
            None => Samples::constant(0.0),
            Some((barrier, below)) => self.barrier(look, below, barrier, rect)?,
        };
        let (mut parts, mut size_in_bytes) = (Vec::with_capacity(above.len()), 0);
        for node in above {
            let heights = self.content(look, node, rect)?;
            let part = Part { heights, weights: weights::painted(look, node, rect)?, blend: node.blend };
            size_in_bytes += part.size_in_bytes();
            parts.push(part);
            if size_in_bytes > MAX_JOINED_BYTES {
                below = Samples::Plane(joined(&below, &parts, look.layout, self.plane(rect)));
                parts.clear();
                size_in_bytes = 0;
            }
        }
        Ok(if parts.is_empty() {
            below.into_plane(look.layout, rect)
        } else {
            joined(&below, &parts, look.layout, self.plane(rect))
        })
    }

    /// What a layer alone is made of, in a rectangle; of an effect what it makes of what is below.
    pub(crate) fn layer_heights(
        &mut self,
        look: &mut Look<'_>,
        below: &[Node],
        node: &Node,
        rect: SampleRect,
    ) -> Result<Plane> {
        match &node.content {
            Content::Heights(heights) | Content::Kept(heights) => stored(look, heights, rect),
            Content::Procedural(live) | Content::Effect(live) => {
                let wide = live::plan(look, live, rect)?.map_or(rect, |planned| planned.needs);
                let below = self.heights(look, below, wide)?;
                self.made(look, node, live, &below, rect)
            }
        }
    }

    /// How much a layer counts in a rectangle: its opacity times its masks.
    pub(crate) fn layer_weights(
        &mut self,
        look: &mut Look<'_>,
        below: &[Node],
        node: &Node,
        rect: SampleRect,
    ) -> Result<Plane> {
        let needs = weights::needs(look, node, rect)?;
        let below = if needs.is_empty() { None } else { Some(self.heights(look, below, needs)?) };
        weights(look, self.executor(look.layout)?, node, below.as_ref(), rect)
    }

    /// What the stack comes to with a barrier, whose pages are kept.
    fn barrier(
        &mut self,
        look: &mut Look<'_>,
        below: &[Node],
        node: &Node,
        rect: SampleRect,
    ) -> Result<Samples> {
        self.kept(look, node, Kind::Result, rect, |this, look, rect| {
            let inner = match node.blend {
                Blend::Laplacian => live::plan_blend(look, rect).needs,
                _ => rect,
            };
            let by_weights = weights::needs(look, node, inner)?;
            let by_heights = content_needs(look, node, inner)?;
            let plane = this.heights(look, below, inner.bounds_with(&by_weights).bounds_with(&by_heights))?;
            let heights = match &node.content {
                Content::Heights(_) | Content::Kept(_) => this.content(look, node, inner)?,
                Content::Procedural(live) | Content::Effect(live) => {
                    Samples::Plane(this.made(look, node, live, &plane, inner)?)
                }
            };
            if node.blend == Blend::Laplacian {
                let heights = heights.into_plane(look.layout, inner);
                let weights = weights(look, this.executor(look.layout)?, node, Some(&plane), inner)?;
                let planned = live::plan_blend(look, rect);
                let planes = vec![(GROUND, &plane), (HEIGHTS, &heights), (WEIGHTS, &weights)];
                let mut joined = live::run(look, this.executor(look.layout)?, planned, planes, rect)?;
                joined.samples_mut().iter_mut().for_each(|height| {
                    *height = orogeny_field::sanitized_height(*height);
                });
                return Ok(joined);
            }
            let weights = if node.has_painted_masks_only() {
                weights::painted(look, node, rect)?
            } else {
                Weights::Plane(weights(look, this.executor(look.layout)?, node, Some(&plane), rect)?)
            };
            let (below, part) = (Samples::Plane(plane), Part { heights, weights, blend: node.blend });
            let joined = joined(&below, std::slice::from_ref(&part), look.layout, this.plane(rect));
            part.into_planes().chain(below.into_plane_there()).for_each(|plane| this.give_back(plane));
            Ok(joined)
        })
    }

    /// What a layer is made of that does not look at what is below it.
    fn content(&mut self, look: &mut Look<'_>, node: &Node, rect: SampleRect) -> Result<Samples> {
        match &node.content {
            Content::Heights(heights) | Content::Kept(heights) => samples(look, heights, rect),
            Content::Procedural(live) | Content::Effect(live) => {
                self.kept(look, node, Kind::Content, rect, |this, look, rect| {
                    let flat = Plane::constant(rect, 0.0);
                    this.made(look, node, live, &flat, rect)
                })
            }
        }
    }

    /// What a layer's brush makes in a rectangle, with what is below it as far as it looks.
    fn made(
        &mut self,
        look: &mut Look<'_>,
        node: &Node,
        live: &Live,
        below: &Plane,
        rect: SampleRect,
    ) -> Result<Plane> {
        let is_effect = matches!(node.content, Content::Effect(_));
        let Some(planned) = live::plan(look, live, rect)? else {
            return Ok(if is_effect { cropped(below.clone(), rect) } else { Plane::constant(rect, 0.0) });
        };
        let flat;
        let ground = if is_effect {
            below
        } else {
            flat = Plane::constant(planned.needs, 0.0);
            &flat
        };
        let planes = vec![(GROUND, ground), (BELOW, below)];
        live::run(look, self.executor(look.layout)?, planned, planes, rect)
    }

    /// A rectangle of pages that are kept; those that are missing are worked out in blocks, and what of others is stale.
    fn kept(
        &mut self,
        look: &mut Look<'_>,
        node: &Node,
        kind: Kind,
        rect: SampleRect,
        mut work_out: impl FnMut(&mut Self, &mut Look<'_>, SampleRect) -> Result<Plane>,
    ) -> Result<Samples> {
        let (layout, level) = (look.layout, look.level);
        let bounds = look.grid.bounds();
        let key_of = |(x, z)| CacheKey { layer: node.id, kind, level, z, x };
        let (mut pages, mut missing, mut stale) = (Vec::new(), Vec::new(), SampleRect::EMPTY);
        let mut partly_stale = Vec::new();
        for place in layout.pages_in(rect) {
            match self.cache.get(&key_of(place)) {
                Some((page, of_page)) => {
                    let wanted = of_page.within(&rect);
                    if wanted.is_empty() {
                        pages.push((page_rect(layout, &key_of(place)), page));
                    } else {
                        stale = stale.bounds_with(&wanted);
                        partly_stale.push((key_of(place), page, of_page));
                    }
                }
                None => missing.push(place),
            }
        }
        let stale = stale.intersection(&bounds);
        if !partly_stale.is_empty() {
            let made =
                if stale.is_empty() { Plane::constant(stale, 0.0) } else { work_out(self, look, stale)? };
            // Pages that no one else has are changed where they are.
            partly_stale.iter().for_each(|(key, ..)| self.cache.drop_page(key));
            let patched = partly_stale.into_par_iter().map(|(key, page, mut of_page)| {
                let (mut page, of_terrain) = (Arc::unwrap_or_clone(page), page_rect(layout, &key));
                patch(&mut page, of_terrain, &stale.intersection(&of_terrain), &made);
                of_page.remove(&stale);
                (key, Arc::new(page), of_page)
            });
            for (key, page, still_stale) in patched.collect::<Vec<_>>() {
                pages.push((page_rect(layout, &key), Arc::clone(&page)));
                self.cache.put(key, page, still_stale);
            }
            self.give_back(made);
        }
        while let Some((first_x, first_z)) = missing.first().copied() {
            // A block of pages side by side, as far as they are missing.
            let in_block = |(x, z): &(u32, u32)| {
                x.wrapping_sub(first_x) < BLOCK_PAGES && z.wrapping_sub(first_z) < BLOCK_PAGES
            };
            let (block, rest): (Vec<_>, Vec<_>) = missing.into_iter().partition(in_block);
            missing = rest;
            let rects = block.iter().map(|place| page_rect(layout, &key_of(*place)));
            let whole =
                rects.fold(SampleRect::EMPTY, |whole, rect| whole.bounds_with(&rect)).intersection(&bounds);
            let made = work_out(self, look, whole)?;
            for place in layout.pages_in(whole) {
                let key = key_of(place);
                let of_page = page_rect(layout, &key);
                let page = Arc::new(cut(&made, layout, of_page));
                if block.contains(&place) {
                    pages.push((of_page, Arc::clone(&page)));
                }
                self.cache.put(key, page, Stale::default());
            }
        }
        Ok(Samples::Pages { pages, constant: 0.0 })
    }

    /// A plane whose values are to be written.
    fn plane(&mut self, rect: SampleRect) -> Plane {
        self.executor.as_mut().map_or_else(|| Plane::constant(rect, 0.0), |executor| executor.plane(rect))
    }

    /// Takes the memory of a plane that is no longer needed.
    fn give_back(&mut self, plane: Plane) {
        if let Some(executor) = &mut self.executor {
            executor.give_back(plane);
        }
    }

    fn executor(&mut self, layout: PageLayout) -> Result<&mut dyn Executor> {
        let executor = match &mut self.executor {
            Some(executor) => executor,
            none => none.insert(backend::composite_executor(&self.settings, layout)?),
        };
        Ok(executor.as_mut())
    }
}

/// The samples of what is below that what a layer is made of looks at.
fn content_needs(look: &mut Look<'_>, node: &Node, rect: SampleRect) -> Result<SampleRect> {
    match &node.content {
        Content::Procedural(live) | Content::Effect(live) => {
            Ok(live::plan(look, live, rect)?.map_or(rect, |planned| planned.needs))
        }
        Content::Heights(_) | Content::Kept(_) => Ok(rect),
    }
}

/// How far around a rectangle a node looks at what is below it, wherever that is, at most.
fn halo(look: &mut Look<'_>, node: &Node) -> Result<i32> {
    let one = SampleRect::new(0, 0, 1, 1);
    let blend = if node.blend == Blend::Laplacian { live::plan_blend(look, one).halo() } else { 0 };
    let content = match &node.content {
        Content::Procedural(live) | Content::Effect(live) => {
            live::plan(look, live, one)?.map_or(0, |planned| planned.halo())
        }
        Content::Heights(_) | Content::Kept(_) => 0,
    };
    Ok(blend + content.max(weights::halo(look, node)?))
}

/// How far around what a brush makes of layers, with all that these look at themselves, it depends on samples, at most.
pub(crate) fn reach(look: &mut Look<'_>, below: &[Node], live: &Live) -> Result<i32> {
    let own = live::plan(look, live, SampleRect::new(0, 0, 1, 1))?.map_or(0, |planned| planned.halo());
    let mut barriers = below.iter().filter(|node| node.is_barrier()).map(|node| halo(look, node));
    barriers.try_fold(own, |reach, halo| Ok(reach + halo?))
}

/// Samples of a field that were changed, at full resolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Change {
    pub(crate) field: FieldId,
    pub(crate) rect: SampleRect,
}

impl Change {
    /// All of each page.
    pub(crate) fn of_pages(layout: PageLayout, keys: &[PageKey]) -> Vec<Self> {
        keys.iter().map(|key| Self { field: key.field, rect: layout.page_rect(key) }).collect()
    }
}

/// What of some fields was changed.
fn rect_of(changes: &[Change], is_of: impl Fn(FieldId) -> bool) -> SampleRect {
    let of_field = changes.iter().filter(|change| is_of(change.field));
    of_field.fold(SampleRect::EMPTY, |rect, change| rect.bounds_with(&change.rect))
}

fn page_rect(layout: PageLayout, key: &CacheKey) -> SampleRect {
    layout.page_rect(&PageKey { field: FieldId(0), level: key.level, z: key.z, x: key.x })
}

/// For planning alone, which looks at no page.
struct NoPages(PageLayout);

impl FieldPages for NoPages {
    fn layout(&self) -> PageLayout {
        self.0
    }

    fn selection(&mut self) -> Result<Option<FieldId>> {
        Ok(None)
    }

    fn load(&mut self, keys: &[PageKey]) -> Result<Vec<Option<Arc<Page>>>> {
        Ok(vec![None; keys.len()])
    }

    fn blob(&mut self, hash: orogeny_store::BlobHash) -> Result<Vec<u8>> {
        Err(orogeny_store::Error::UnknownBlob { hash: hash.to_string() }.into())
    }
}
