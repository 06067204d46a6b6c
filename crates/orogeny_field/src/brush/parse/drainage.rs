//! The brushes that work on a whole region at once, to and from JSON.

use serde_json::{Map, Value, json};

use super::fields::Fields;
use super::only_with;
use super::write::word;
use crate::brush::{Brush, BrushType};
use crate::{Droplets, FillPits, FlowMask, FlowRouting, RainMask, RainShows, Result};

pub(super) fn read_droplets(fields: &Fields<'_>) -> Result<Droplets> {
    if fields.brush_type() != BrushType::ErodeDroplets {
        return Ok(Droplets::default());
    }
    Ok(Droplets {
        per_sample: fields.number("droplets")?,
        inertia: fields.number("inertia")?,
        capacity: fields.number("capacity")?,
        erosion: fields.number("erosion")?,
        deposition: fields.number("deposition")?,
        min_slope_deg: fields.number("min_slope")?,
        evaporation: fields.number("evaporation")?,
        gravity: fields.number("gravity")?,
        radius: fields.integer("erosion_radius")?,
        max_steps: fields.integer("max_steps")?,
        ..Droplets::default()
    })
}

pub(super) fn read_fill_pits(fields: &Fields<'_>) -> Result<FillPits> {
    if fields.brush_type() != BrushType::FillPits {
        return Ok(FillPits::default());
    }
    let max_depth_m = fields.optional_number("max_depth")?;
    Ok(FillPits {
        slope_m: fields.number("slope")? as f32,
        max_depth_m: max_depth_m.map(|depth_m| depth_m as f32),
    })
}

pub(super) fn read_routing(fields: &Fields<'_>) -> Result<FlowRouting> {
    if fields.brush_type() != BrushType::FlowMask {
        return Ok(FlowRouting::default());
    }
    only_with(fields, "routing", &[("exponent", "shared")])?;
    Ok(match fields.word("routing")? {
        "shared" => FlowRouting::Shared { exponent: fields.number("exponent")? as f32 },
        _ => FlowRouting::Steepest,
    })
}

pub(super) fn read_flow_mask(fields: &Fields<'_>) -> Result<FlowMask> {
    if fields.brush_type() != BrushType::FlowMask {
        return Ok(FlowMask::default());
    }
    let (from, to) = (fields.number("from")?, fields.number("to")?);
    let mask = FlowMask { from_m2: from as f32, to_m2: to as f32 };
    if mask.from_m2 >= mask.to_m2 {
        return Err(fields.refused("from", from, format!("it must be below `to`, {to} m²")));
    }
    Ok(mask)
}

pub(super) fn read_rain_mask(fields: &Fields<'_>) -> Result<RainMask> {
    if fields.brush_type() != BrushType::RainMask {
        return Ok(RainMask::default());
    }
    let (from_m, to_m) = (fields.number("from")?, fields.number("to")?);
    if from_m >= to_m {
        return Err(fields.refused("from", from_m, format!("it must be below `to`, {to_m} m")));
    }
    Ok(RainMask { shows: fields.choice("shows", RainShows::Water)?, from_m, to_m })
}

/// The fields that only these brushes have.
pub(super) fn write(brush: &Brush) -> Map<String, Value> {
    let fields = match brush.brush_type {
        BrushType::ErodeDroplets => {
            let droplets = &brush.droplets;
            json!({
                "droplets": droplets.per_sample,
                "inertia": droplets.inertia,
                "capacity": droplets.capacity,
                "erosion": droplets.erosion,
                "deposition": droplets.deposition,
                "min_slope": droplets.min_slope_deg,
                "evaporation": droplets.evaporation,
                "gravity": droplets.gravity,
                "erosion_radius": droplets.radius,
                "max_steps": droplets.max_steps,
            })
        }
        BrushType::FillPits => match brush.fill_pits.max_depth_m {
            Some(max_depth_m) => {
                json!({ "slope": f64::from(brush.fill_pits.slope_m), "max_depth": f64::from(max_depth_m) })
            }
            None => json!({ "slope": f64::from(brush.fill_pits.slope_m) }),
        },
        BrushType::FlowMask => {
            let FlowMask { from_m2, to_m2 } = brush.flow_mask;
            let (from, to) = (f64::from(from_m2), f64::from(to_m2));
            match brush.flow_routing {
                FlowRouting::Steepest => json!({ "routing": "steepest", "from": from, "to": to }),
                FlowRouting::Shared { exponent } => {
                    json!({ "routing": "shared", "exponent": f64::from(exponent), "from": from, "to": to })
                }
            }
        }
        BrushType::RainMask => {
            let RainMask { shows, from_m, to_m } = brush.rain_mask;
            json!({ "shows": word(&shows), "from": from_m, "to": to_m })
        }
        _ => Value::Null,
    };
    match fields {
        Value::Object(fields) => fields,
        _ => Map::new(),
    }
}
