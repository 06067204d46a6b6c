//! How much a layer counts where: its opacity times its masks.

use std::sync::Arc;

use orogeny_brush::filter::MAX_WIDTH_SAMPLES;
use orogeny_brush::{Executor, GatePlan};
use orogeny_field::{Bitmap, Gate, MaskCombine, MaskSource, MaskTerm, Plane, SampleRect, TerrainGrid};
use orogeny_reference::field::compose;
use rayon::prelude::*;

use super::Look;
use super::content::{cropped, samples, stored};
use super::live::{self, BELOW, GROUND, Planned};
use super::node::{Mask, Node, Term, TermSource, selection};
use super::samples::Weights;
use crate::Result;

/// Rows that a thread takes at once.
const MIN_ROWS: usize = 16;

/// Refuses a term of a mask that cannot be worked out on the terrain: the composite could not be looked at with it.
///
/// # Errors
/// [`crate::Error::Field`] or [`crate::Error::Brush`], naming what is wrong.
pub(crate) fn check_term(grid: TerrainGrid, term: &MaskTerm) -> Result<()> {
    let high = MAX_WIDTH_SAMPLES * grid.spacing_m();
    if term.blur_m > high {
        let (field, value) = ("blur", term.blur_m);
        return Err(orogeny_field::Error::LayerValue { field, value, low: 0.0, high }.into());
    }
    if let MaskSource::Gate(gate) = &term.source {
        GatePlan::new(gate, grid, BELOW, BELOW, None)?;
    }
    Ok(())
}

/// The samples of what is below that a node's weights within a rectangle look at; none where they do not.
pub(super) fn needs(look: &mut Look<'_>, node: &Node, rect: SampleRect) -> Result<SampleRect> {
    let mut needs = SampleRect::EMPTY;
    for term in node.masks.iter().flat_map(|mask| &mask.terms) {
        if looks_below(term) {
            let blurred = blur(look, term, rect)?.map_or(rect, |blur| blur.needs);
            needs = needs.bounds_with(&blurred.grown(1));
        }
    }
    Ok(needs.intersection(&look.grid.bounds()))
}

/// How far around a rectangle a node's weights look at what is below, wherever that is, at most.
pub(super) fn halo(look: &mut Look<'_>, node: &Node) -> Result<i32> {
    let mut halo = 0;
    for term in node.masks.iter().flat_map(|mask| &mask.terms) {
        let blur = blur(look, term, SampleRect::new(0, 0, 1, 1))?;
        halo = halo.max(1 + blur.map_or(0, |blur| blur.halo()));
    }
    Ok(halo)
}

fn looks_below(term: &Term) -> bool {
    matches!(&term.source, TermSource::Gate { gate, .. } if gate.needs_heights())
}

fn blur(look: &mut Look<'_>, term: &Term, rect: SampleRect) -> Result<Option<Planned>> {
    if term.blur_m > 0.0 { live::plan_blur(look, term.blur_m, rect) } else { Ok(None) }
}

/// The weights of a node whose masks are stored, all of them.
pub(super) fn painted(look: &mut Look<'_>, node: &Node, rect: SampleRect) -> Result<Weights> {
    let painted = node.masks.iter().filter_map(|mask| mask.painted.as_ref());
    let masks = painted.map(|painted| samples(look, painted, rect)).collect::<Result<_>>()?;
    Ok(Weights::Masks { masks, opacity: node.opacity })
}

/// A node's weights within a rectangle, over what is below it, which has what [`needs`] says.
pub(super) fn weights(
    look: &mut Look<'_>,
    executor: &mut dyn Executor,
    node: &Node,
    below: Option<&Plane>,
    rect: SampleRect,
) -> Result<Plane> {
    let mut weights: Option<Plane> = None;
    for mask in &node.masks {
        let mask = work_out(look, executor, mask, below, rect)?;
        weights = Some(match weights {
            None => mask,
            Some(mut weights) => {
                for_each_row(&mut weights, &mask, |weights, mask| {
                    compose::combine_row(weights, mask, MaskCombine::Multiply);
                });
                weights
            }
        });
    }
    let mut weights = weights.unwrap_or_else(|| Plane::constant(rect, 1.0));
    if node.opacity != 1.0 {
        weights.samples_mut().par_iter_mut().with_min_len(1 << 14).for_each(|weight| *weight *= node.opacity);
    }
    Ok(weights)
}

fn work_out(
    look: &mut Look<'_>,
    executor: &mut dyn Executor,
    mask: &Mask,
    below: Option<&Plane>,
    rect: SampleRect,
) -> Result<Plane> {
    let mut plane = match &mask.painted {
        Some(painted) => Some(stored(look, painted, rect)?),
        None => None,
    };
    for term in &mask.terms {
        let mut values = source(look, executor, term, below, rect)?;
        let shape = |row: &mut [f32]| compose::shape_row(row, term.is_inverted, term.curve.as_deref());
        let width = rect.width().max(1) as usize;
        let rows = values.samples_mut().par_chunks_mut(width).with_min_len(MIN_ROWS);
        match &mut plane {
            // The first one multiplies what is 1 everywhere.
            None if term.combine == MaskCombine::Multiply => {
                rows.for_each(shape);
                plane = Some(values);
            }
            before => {
                let plane = before.get_or_insert_with(|| Plane::constant(rect, 1.0));
                let rows = plane.samples_mut().par_chunks_mut(width).zip(rows);
                rows.for_each(|(mask, values)| {
                    shape(values);
                    compose::combine_row(mask, values, term.combine);
                });
                executor.give_back(values);
            }
        }
    }
    Ok(plane.unwrap_or_else(|| Plane::constant(rect, 1.0)))
}

/// What a term is worked out from, blurred.
fn source(
    look: &mut Look<'_>,
    executor: &mut dyn Executor,
    term: &Term,
    below: Option<&Plane>,
    rect: SampleRect,
) -> Result<Plane> {
    let blur = blur(look, term, rect)?;
    let wide = blur.as_ref().map_or(rect, |blur| blur.needs);
    let values = match &term.source {
        TermSource::Heights { heights, low, high } => {
            let mut values = stored(look, heights, wide)?;
            compose::range_row(values.samples_mut(), *low, *high);
            values
        }
        TermSource::Mask(None) => Plane::constant(wide, 1.0),
        TermSource::Mask(Some(mask)) => stored(look, mask, wide)?,
        TermSource::Gate { gate, image } => {
            let plane = executor.plane(wide);
            gated(look, gate, image.as_ref(), below, plane)?
        }
    };
    match blur {
        Some(blur) => live::run(look, executor, blur, vec![(GROUND, &values)], rect),
        None => Ok(cropped(values, rect)),
    }
}

/// What a gate lets through within the rectangle of a plane, whatever that holds, of ground of which a sample more on each side is known.
pub(crate) fn gated(
    look: &mut Look<'_>,
    gate: &Gate,
    image: Option<&Arc<Bitmap>>,
    ground: Option<&Plane>,
    plane: Plane,
) -> Result<Plane> {
    let rect = plane.rect();
    let plan = match GatePlan::new(gate, look.grid, BELOW, BELOW, image.cloned()) {
        // A noise that is too fine to be seen at this level is its mean: nothing.
        Err(orogeny_brush::Error::Field(orogeny_field::Error::FeatureSize { .. })) if look.level > 0 => {
            return Ok(Plane::constant(rect, if gate.is_inverted { 1.0 } else { 0.0 }));
        }
        plan => plan?,
    };
    let selected = match look.pages.selection()? {
        _ if !gate.selection => None,
        Some(field) => Some(stored(look, &selection(field), rect)?),
        None => Some(Plane::constant(rect, 0.0)),
    };
    Ok(plan.plane(look.layout, plane, ground, selected.as_ref()))
}

/// Changes a plane by another of the same rectangle, row by row.
fn for_each_row(plane: &mut Plane, by: &Plane, change: impl Fn(&mut [f32], &[f32]) + Sync) {
    let width = plane.rect().width().max(1) as usize;
    let rows = plane.samples_mut().par_chunks_mut(width).zip(by.samples().par_chunks(width));
    rows.for_each(|(row, by)| change(row, by));
}
