//! Simulated erosion from JSON.

use super::fields::Fields;
use crate::brush::BrushType;
use crate::{Pipes, Result, RockLayer, Thermal};

pub(super) fn read_thermal(fields: &Fields<'_>) -> Result<Thermal> {
    if fields.brush_type() != BrushType::ErodeThermal {
        return Ok(Thermal::default());
    }
    let rock = |fields: &Fields<'_>, from_m| -> Result<RockLayer> {
        let (talus_angle_deg, rate) = (fields.number("talus_angle")?, fields.number("rate")?);
        Ok(RockLayer { from_m, talus_angle_deg, rate })
    };
    let mut layers = vec![rock(fields, 0.0)?];
    let mut lowest_m = f64::MIN;
    for layer in fields.list("layers")? {
        let from_m = layer.number("from")?;
        if from_m < lowest_m {
            let limit = format!("it must not be below the layer before it, {lowest_m} m");
            return Err(layer.refused("from", from_m, limit));
        }
        lowest_m = from_m;
        layers.push(rock(&layer, from_m)?);
    }
    Ok(Thermal { layers, iterations: fields.integer("iterations")? })
}

pub(super) fn read_pipes(fields: &Fields<'_>) -> Result<Pipes> {
    if !matches!(fields.brush_type(), BrushType::ErodeFluvial | BrushType::RainMask) {
        return Ok(Pipes::default());
    }
    Ok(Pipes {
        rain_m_per_s: fields.number("rain")?,
        evaporation_per_s: fields.number("evaporation")?,
        capacity_s_per_m: fields.number("capacity")?,
        dissolving_per_s: fields.number("dissolving")?,
        deposition_per_s: fields.number("deposition")?,
        min_slope_deg: fields.number("min_slope")?,
        friction_per_s: fields.number("friction")?,
        iterations: fields.integer("iterations")?,
        ..Pipes::default()
    })
}
