//! Fills: a brush applied once, at full weight, without a stroke.

use orogeny_field::{Brush, BrushType, Footprint, Instance, SampleRect, WeightMode};
use orogeny_pages::PageStore;

use super::checked_num_pages;
use super::prepared::{Plan, missing};
use crate::Result;
use crate::canvas::{Canvas, Resources};
use crate::filter::Weights;
use crate::frames::Frames;
use crate::kernels::{Rule, Stage};
use crate::plan::Batch;
use crate::symmetry::Image;

/// Plans a brush applied once at full weight to `region`, which is clipped to the terrain.
///
/// # Errors
/// [`crate::Error::Field`] for a brush with a number that it cannot use, and with [`orogeny_field::Error::MissingField`] for one that
/// needs a stroke: `ramp`, `stamp`, one with a bitmap, `level` and `ledge` without a height; [`crate::Error::TooManyPages`] for a region beyond what one operation may change.
pub fn plan_fill(
    brush: &Brush,
    seed: u32,
    canvas: Canvas,
    resources: Resources,
    region: SampleRect,
    store: &mut dyn PageStore,
) -> Result<Batch> {
    let stage = Stage::of(brush.brush_type);
    if stage.has_goal_of_instance() {
        return Err(missing(brush, "points", "it needs a stroke, and a fill has none"));
    }
    if matches!(brush.brush_type, BrushType::Smear | BrushType::Grab) {
        return Err(missing(brush, "points", "it takes the ground along with a stroke, and a fill has none"));
    }
    let needs_height = stage.needs_reference_height() || stage.needs_target_height();
    if needs_height && brush.height_m.is_none() {
        return Err(missing(brush, "height", "a fill has no stroke whose ground could give it"));
    }
    if brush.alpha.is_some() {
        return Err(missing(
            brush,
            "points",
            "its bitmap lies about the places of a stroke, and a fill has none",
        ));
    }
    let plan = Plan::new(brush, seed, canvas, resources)?;
    let region = region.intersection(&canvas.grid.bounds());
    checked_num_pages(canvas.layout, region)?;
    if brush.brush_type == BrushType::Clone {
        let to_m = plan.given_place()?;
        let everywhere = Instance { amplitude: brush.strength as f32, ..Instance::EVERYWHERE };
        let footprint = Footprint { weight_mode: WeightMode::Wash, ..Footprint::EVERYWHERE };
        let gate = plan.gate.clone();
        let weights = Weights { footprint, instances: vec![everywhere], bounds: vec![region], gate };
        return plan.cloned(to_m, vec![(Image::IDENTITY, weights)], store);
    }
    let height_m = brush.height_m.unwrap_or_default();
    let mut everywhere = Instance {
        amplitude: (stage.sign(brush) * brush.strength) as f32,
        reference_height_m: height_m,
        // Finite for the smallest radius too: 0 m above the reference times infinity would be no number.
        inverse_radius_m: (1.0 / brush.radius_m).min(f64::from(f32::MAX)) as f32,
        ..Instance::EVERYWHERE
    };
    let mut frames = plan.frames([0.0, 0.0])?;
    if let Some(frames) = &mut frames {
        frames.assign(&mut everywhere, 0, [0.0, 0.0], [1.0, 0.0]);
    }
    let mut rule = plan.rule(height_m, [0.0, 0.0], frames.as_ref())?;
    if let Some(filter) = plan.of_region(region)? {
        rule = Rule::Filter(filter);
    } else if let Rule::Filter(filter) = &mut rule {
        // There is one instance only, and the ground before it lets the fill go on piece by piece.
        filter.is_sequential = false;
    }
    let batch =
        Batch::new(plan.pass(rule, Footprint::EVERYWHERE), canvas.layout, vec![everywhere], vec![region]);
    Ok(batch.with_frames(frames.as_mut().map(Frames::take).unwrap_or_default()))
}
