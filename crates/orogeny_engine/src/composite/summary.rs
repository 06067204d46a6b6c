//! What is known of a page of the composite: from the directory where the stack is stored, else from what it comes to.

use orogeny_field::{Blend, HeightBounds, PageKey, SampleRect, TerrainGrid};
use orogeny_geomip::{PagePlace, PageSummary};
use orogeny_store::Store;

use super::node::{Content, Stored};
use super::{Compositor, Look, Node, StorePages};
use crate::Result;

/// See [`usual_error_m`].
const USUAL_ROUGHNESS: f64 = 0.125;

/// Bounds, error and whether it is constant, of a page of a terrain's stack. Strict where all layers are stored where they lie and
/// are joined sample by sample; estimated, from the page itself, where something is worked out.
pub(crate) fn summary(store: &Store, compositor: &mut Compositor, place: PagePlace) -> Result<PageSummary> {
    let mut pages = StorePages::showing_damage(store);
    let nodes = compositor.nodes(store.layers(), &mut pages)?;
    if !nodes.iter().all(is_in_directory) {
        return estimated(store, compositor, &nodes, place);
    }
    let mut bounds = HeightBounds::of(0.0);
    let (mut error_m, mut is_constant) = (0.0, true);
    for node in nodes.iter() {
        let (Content::Heights(heights) | Content::Kept(heights)) = &node.content else { continue };
        let surface = |stored: &Stored| {
            let PagePlace { level, z, x } = place;
            store.page_surface(&PageKey { field: stored.field, level, z, x })
        };
        let found = surface(heights)?;
        is_constant &= found.is_none();
        let (of_layer, layer_error_m) = found.unwrap_or((HeightBounds::of(heights.constant), 0.0));
        let mut weight = HeightBounds::of(node.opacity);
        for painted in node.masks.iter().filter_map(|mask| mask.painted.as_ref()) {
            let found = surface(painted)?;
            is_constant &= found.is_none();
            let (of_mask, _) = found.unwrap_or((HeightBounds::of(painted.constant), 0.0));
            weight =
                HeightBounds { min_m: weight.min_m * of_mask.min_m, max_m: weight.max_m * of_mask.max_m };
        }
        bounds = joined(&bounds, &of_layer, &weight, node.blend);
        error_m += weight.max_m * layer_error_m;
    }
    if !nodes.iter().all(Node::is_unmasked) {
        // The directory tells how far masks are from full resolution, but not what of that meets what heights.
        error_m = usual_error_m(store.grid().spacing_m(), place.level);
    }
    Ok(PageSummary { bounds, error_m, is_constant })
}

/// How far a coarser level is from full resolution where nothing tells it: a share of the distance between its samples, which is
/// about that of mountains. It more than doubles from level to level, so levels change with the distance alone.
pub(crate) fn usual_error_m(spacing_m: f64, level: u8) -> f32 {
    (USUAL_ROUGHNESS * spacing_m * f64::from((1_u32 << level.min(31)) - 1)) as f32
}

/// Whether the directory tells all of a layer.
fn is_in_directory(node: &Node) -> bool {
    let is_stored = matches!(node.content, Content::Heights(_) | Content::Kept(_));
    let is_plain =
        matches!(node.blend, Blend::Add | Blend::Subtract | Blend::Max | Blend::Min | Blend::Replace);
    is_stored && is_plain && !node.is_barrier() && node.fields().all(|stored| stored.transform.is_identity())
}

/// Bounds of a layer joined to what is below it.
fn joined(below: &HeightBounds, layer: &HeightBounds, weight: &HeightBounds, blend: Blend) -> HeightBounds {
    let sum = |sign: f32| {
        let ends = [layer.min_m, layer.max_m].into_iter().flat_map(|height_m| {
            [weight.min_m, weight.max_m].into_iter().map(move |weight| sign * weight * height_m)
        });
        let added = ends.fold(HeightBounds::of(f32::NAN), |bounds, end| HeightBounds {
            min_m: bounds.min_m.min(end),
            max_m: bounds.max_m.max(end),
        });
        HeightBounds { min_m: below.min_m + added.min_m, max_m: below.max_m + added.max_m }
    };
    match blend {
        Blend::Add => sum(1.0),
        Blend::Subtract => sum(-1.0),
        // It lies between what is below and what it is pulled to, all of which lies within both.
        _ => below.with(*layer),
    }
}

/// From the page itself, and as much beyond as it is usually from full resolution.
fn estimated(
    store: &Store,
    compositor: &mut Compositor,
    nodes: &[Node],
    place: PagePlace,
) -> Result<PageSummary> {
    let mut pages = StorePages::showing_damage(store);
    let mut look = Look::new(store.grid(), place.level, &mut pages)?;
    let layout = look.pages.layout();
    let PagePlace { level, z, x } = place;
    let page = layout.page_rect(&PageKey { field: orogeny_field::FieldId(0), level, z, x });
    let grid: TerrainGrid = look.grid;
    let rect: SampleRect = page.intersection(&grid.bounds());
    let plane = compositor.heights(&mut look, nodes, rect)?;
    let rows = plane.samples().chunks(rect.width().max(1) as usize);
    let bounds = rows.filter_map(HeightBounds::of_row).reduce(HeightBounds::with);
    let bounds = bounds.unwrap_or(HeightBounds::of(0.0));
    let error_m = usual_error_m(store.grid().spacing_m(), level);
    let bounds = HeightBounds { min_m: bounds.min_m - error_m, max_m: bounds.max_m + error_m };
    Ok(PageSummary { bounds, error_m, is_constant: false })
}
