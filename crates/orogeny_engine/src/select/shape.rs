//! What a shape selects, at each sample of a rectangle.

use std::sync::Arc;

use orogeny_field::{Bitmap, Gate, LayerTransform, PageKey, Plane, SampleRect, SelectShape, Selecting};
use orogeny_reference::select::lasso::Lasso;
use orogeny_store::Layer;

use super::Ground;
use super::extent::Extent;
use crate::Result;
use crate::composite::{self, Look, Stored};
use crate::terrain::find_layer;

/// A shape on the samples of a terrain, with all that it needs.
pub(super) enum Shape {
    Keep,
    Rectangle(SampleRect),
    Lasso(Lasso, SampleRect),
    Gate {
        gate: Box<Gate>,
        image: Option<Arc<Bitmap>>,
        region: SampleRect,
    },
    Mask {
        /// `None`: it was never painted, and is 1 everywhere.
        mask: Option<Stored>,
        region: SampleRect,
    },
}

impl Shape {
    pub(super) fn new(selecting: &Selecting, look: &mut Look<'_>, layers: &[Layer]) -> Result<Self> {
        let (grid, bounds) = (look.grid, look.grid.bounds());
        let region = |region_m: &Option<[f64; 4]>| {
            region_m.map_or(Ok(bounds), |region_m| grid.samples_in_region(region_m))
        };
        Ok(match &selecting.shape {
            SelectShape::All => Self::Rectangle(bounds),
            SelectShape::Nothing => Self::Rectangle(SampleRect::EMPTY),
            SelectShape::Keep => Self::Keep,
            SelectShape::Rectangle(rectangle_m) => Self::Rectangle(grid.samples_in_region(*rectangle_m)?),
            SelectShape::Lasso(_) => {
                let lasso = Lasso::new(&selecting.lasso(&grid)?);
                let inside = lasso.bounds().intersection(&bounds);
                Self::Lasso(lasso, inside)
            }
            SelectShape::Gate { gate, region_m } => Self::Gate {
                gate: gate.clone(),
                image: composite::image_of(gate, look.pages)?,
                region: region(region_m)?,
            },
            SelectShape::Mask { layer, region_m } => Self::Mask {
                mask: composite::painted_mask(find_layer(layers, Some(layer))?),
                region: region(region_m)?,
            },
        })
    }

    /// Where it may select anything; `mask_pages` are those of its layer's mask.
    pub(super) fn extent(&self, mask_pages: &[PageKey]) -> Extent {
        match self {
            Self::Keep => Extent::Selected,
            Self::Rectangle(rect) | Self::Lasso(_, rect) => Extent::Rect(*rect),
            Self::Mask { mask: Some(mask), region } if is_bounded(mask) => {
                Extent::Pages(mask_pages.to_vec(), *region)
            }
            Self::Gate { region, .. } | Self::Mask { region, .. } => Extent::Rect(*region),
        }
    }

    /// How much it selects of each sample of a rectangle, of which `before` is what was selected.
    pub(super) fn plane(&self, ground: &mut Ground<'_, '_>, before: &Plane) -> Result<Plane> {
        let rect = before.rect();
        match self {
            Self::Keep => Ok(before.clone()),
            Self::Rectangle(inside) => inside_of(rect, inside, |rect| Ok(Plane::constant(rect, 1.0))),
            Self::Lasso(lasso, _) => {
                let mut plane = Plane::constant(rect, 0.0);
                lasso.fill(&mut plane);
                Ok(plane)
            }
            Self::Gate { gate, image, region } => inside_of(rect, region, |rect| {
                let Ground { look, compositor, nodes } = ground;
                let around = rect.grown(1).intersection(&look.grid.bounds());
                let heights =
                    if gate.needs_heights() { Some(compositor.heights(look, nodes, around)?) } else { None };
                composite::gated(look, gate, image.as_ref(), heights.as_ref(), Plane::constant(rect, 0.0))
            }),
            Self::Mask { mask, region } => inside_of(rect, region, |rect| match mask {
                Some(mask) => composite::stored(&mut ground.look, mask, rect),
                None => Ok(Plane::constant(rect, 1.0)),
            }),
        }
    }
}

/// Whether a mask is nothing wherever it has no page.
fn is_bounded(mask: &Stored) -> bool {
    mask.constant == 0.0 && mask.transform == LayerTransform::default()
}

/// A rectangle with what is worked out within another one, and nothing beyond it.
fn inside_of(
    rect: SampleRect,
    inside: &SampleRect,
    work_out: impl FnOnce(SampleRect) -> Result<Plane>,
) -> Result<Plane> {
    let both = rect.intersection(inside);
    if both == rect {
        return work_out(rect);
    }
    let mut plane = Plane::constant(rect, 0.0);
    if both.is_empty() {
        return Ok(plane);
    }
    let part = work_out(both)?;
    let columns = both.x0.abs_diff(rect.x0) as usize..both.x1.abs_diff(rect.x0) as usize;
    for z in both.z0..both.z1 {
        let to = plane.row_mut(z).and_then(|row| row.get_mut(columns.clone()));
        if let (Some(to), Some(from)) = (to, part.row(z)) {
            to.copy_from_slice(from);
        }
    }
    Ok(plane)
}
