//! Clone brushes to and from JSON.

use serde_json::{Map, Value, json};

use super::fields::Fields;
use super::write::{source, word};
use crate::brush::{Alignment, BrushType, CloneBlend, CloneSource, Cloning};
use crate::{Error, Result};

pub(super) fn read(fields: &Fields<'_>) -> Result<Cloning> {
    if fields.brush_type() != BrushType::Clone {
        return Ok(Cloning::default());
    }
    let missing = |field, why| Error::MissingField { brush: fields.brush_type().name(), field, why };
    let given = fields.object("source")?;
    let given = given.ok_or_else(|| missing("source", "it says where the ground comes from"))?;
    let from = read_source(&given)?;
    let blend = fields.choice("blend", CloneBlend::Laplacian)?;
    if from.alignment == Alignment::Aligned && from.to_m.is_none() {
        return Err(missing("source.to", "an aligned source comes to lie there"));
    }
    if from.alignment == Alignment::Fixed && matches!(blend, CloneBlend::Laplacian | CloneBlend::MeanShifted)
    {
        let limit = "a fixed source is blended in instance by instance: it needs `feathered` or `plain`";
        return Err(fields.refused("blend", fields.word("blend")?, limit.to_owned()));
    }
    let levels = fields.integer("levels")?;
    Ok(Cloning {
        source: from,
        blend,
        num_levels: (levels > 0).then_some(levels),
        level_weights: fields.number_list("level_weights")?,
    })
}

fn read_source(fields: &Fields<'_>) -> Result<CloneSource> {
    let has_data = fields.has("file") || fields.has("blake3");
    for (field, needs_data) in [("spacing", true), ("range", true), ("layer", false), ("selection", false)] {
        if let Some(value) = fields.raw(field)
            && needs_data != has_data
        {
            let limit = if needs_data { "it needs a `file`" } else { "a `file` has none" };
            return Err(fields.refused(field, value, limit.to_owned()));
        }
    }
    let range_m = some_numbers(fields, "range", "two numbers [low, high]")?;
    let region_m: Option<[f64; 4]> = some_numbers(fields, "region", "four numbers [x, z, width, depth]")?;
    if let (Some([.., width_m, depth_m]), Some(given)) = (region_m, fields.raw("region"))
        && !(width_m > 0.0 && depth_m > 0.0)
    {
        return Err(fields.refused("region", given, "its width and its depth must be above 0".to_owned()));
    }
    let at_m = match region_m {
        Some([x, z, width_m, depth_m]) if !fields.has("at") => [x + 0.5 * width_m, z + 0.5 * depth_m],
        _ => fields.numbers("at")?,
    };
    Ok(CloneSource {
        data: if has_data { Some(fields.source("it is the source")?) } else { None },
        layer: fields.layer("layer")?,
        region_m,
        feather_m: fields.number("feather")?,
        at_m,
        alignment: fields.choice("alignment", Alignment::Stroke)?,
        to_m: if fields.has("to") { Some(fields.numbers("to")?) } else { None },
        rotation_deg: fields.number("rotation")?,
        scale: fields.number("scale")?,
        is_mirrored: fields.flag("mirrored")?,
        height_scale: fields.number("height_scale")?,
        height_offset_m: fields.number("height_offset")?,
        is_selected_only: fields.flag("selection")?,
        spacing_m: fields.optional_number("spacing")?,
        range_m,
    })
}

/// Numbers of a fixed count, where they are given.
fn some_numbers<const N: usize>(
    fields: &Fields<'_>,
    name: &'static str,
    what: &str,
) -> Result<Option<[f64; N]>> {
    let Some(given) = fields.raw(name) else { return Ok(None) };
    let numbers = fields.number_list(name)?.try_into();
    numbers.map(Some).map_err(|_| fields.refused(name, given, format!("it must be {what}")))
}

/// The fields that only a clone brush has.
pub(super) fn write(cloning: &Cloning) -> Map<String, Value> {
    let from = &cloning.source;
    let mut object = Map::new();
    let mut put = |name: &str, value: Value| drop(object.insert(name.to_owned(), value));
    if let Some(region_m) = from.region_m {
        put("region", json!(region_m));
        put("feather", from.feather_m.into());
    }
    put("at", json!(from.at_m));
    put("alignment", word(&from.alignment));
    put("rotation", from.rotation_deg.into());
    put("scale", from.scale.into());
    put("mirrored", from.is_mirrored.into());
    put("height_scale", from.height_scale.into());
    put("height_offset", from.height_offset_m.into());
    if let Some(to_m) = from.to_m {
        put("to", json!(to_m));
    }
    if let Some(layer) = &from.layer {
        put("layer", word(layer));
    }
    match &from.data {
        Some(data) => {
            let (name, text) = source(data);
            put(name, text.into());
            if let Some(spacing_m) = from.spacing_m {
                put("spacing", spacing_m.into());
            }
            if let Some(range_m) = from.range_m {
                put("range", json!(range_m));
            }
        }
        None => put("selection", from.is_selected_only.into()),
    }
    let mut whole = Map::new();
    whole.insert("source".to_owned(), Value::Object(object));
    whole.insert("blend".to_owned(), word(&cloning.blend));
    whole.insert("levels".to_owned(), cloning.num_levels.unwrap_or_default().into());
    if !cloning.level_weights.is_empty() {
        whole.insert("level_weights".to_owned(), json!(cloning.level_weights));
    }
    whole
}
