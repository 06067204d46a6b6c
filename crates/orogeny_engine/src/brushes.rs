//! What brushes there are, for people and as JSON Schema.

use orogeny_brush::Spacing;
use orogeny_field::{BrushType, Coverage, MAX_CURVE_POINTS, Parameter, ParameterKind, Profile, ProfileShape};
use serde_json::{Map, Value, json};

/// A brush type with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct BrushDescription {
    /// The type.
    pub brush_type: BrushType,
    /// In the order in which they are listed.
    pub parameters: Vec<&'static Parameter>,
}

/// How evenly a straight pass of a profile comes out at the default spacing.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ProfileRipple {
    /// The profile's name.
    pub profile: &'static str,
    /// The falloff as a fraction of the radius.
    pub falloff_ratio: f64,
    /// The spacing that is used for it, as a fraction of the radius.
    pub spacing: f64,
    /// The largest difference of the centre line from the strength: 0.01 is 1 %.
    pub ripple: f64,
}

impl ProfileRipple {
    /// All profiles at their default parameters, as a slope over the whole radius and over a tenth of it.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let shapes = [
            ("smooth", ProfileShape::Smooth),
            ("power", ProfileShape::Power { power: 1.0 }),
            ("linear", ProfileShape::Linear),
            ("sphere", ProfileShape::Sphere),
            ("tip", ProfileShape::Tip),
            ("gauss", ProfileShape::Gauss),
            ("sigmoid", ProfileShape::Sigmoid { steepness: 3.0 }),
        ];
        let of = |(profile, shape): (&'static str, ProfileShape)| {
            [1.0, 0.1].map(|falloff_ratio| {
                // Large enough that the half sample under which no spacing goes plays no part.
                let radius = 1000.0;
                let spacing = Spacing::new(&Profile { shape: shape.clone(), falloff_ratio }, radius, 0.25);
                Self { profile, falloff_ratio, spacing: spacing.distance / radius, ripple: spacing.ripple }
            })
        };
        shapes.into_iter().flat_map(of).collect()
    }
}

/// The brush types, in the order in which they are listed.
#[must_use]
pub fn brush_descriptions() -> Vec<BrushDescription> {
    let describe =
        |brush_type| BrushDescription { brush_type, parameters: Parameter::of(brush_type).collect() };
    BrushType::ALL.into_iter().map(describe).collect()
}

/// The JSON Schema (2020-12) of a brush object of one type.
#[must_use]
pub fn brush_schema(brush_type: BrushType) -> Value {
    let mut properties = Map::new();
    properties.insert("type".to_owned(), json!({ "const": brush_type.name() }));
    for parameter in Parameter::of(brush_type) {
        properties.insert(parameter.name.to_owned(), parameter_schema(parameter));
    }
    let required = match brush_type {
        BrushType::SetHeight => json!(["type", "height"]),
        BrushType::Stamp => json!(["type", "alpha"]),
        BrushType::Custom => json!(["type", "file"]),
        _ => json!(["type"]),
    };
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": brush_type.name(),
        "description": brush_type.summary(),
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
        "x-strength-is": match brush_type.coverage() {
            Coverage::Additive => "metres",
            Coverage::Blending => "share",
        },
    })
}

fn object_schema(parameters: &[Parameter]) -> Value {
    let properties: Map<String, Value> =
        parameters.iter().map(|parameter| (parameter.name.to_owned(), parameter_schema(parameter))).collect();
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}

fn parameter_schema(parameter: &Parameter) -> Value {
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" ({})", parameter.unit) };
    let mut schema = match parameter.kind {
        ParameterKind::Number { min, max, default } => {
            let mut schema = json!({ "type": "number", "maximum": max });
            if let Some(object) = schema.as_object_mut() {
                // The smallest positive number stands for "above 0".
                let (name, value) =
                    if min == f64::MIN_POSITIVE { ("exclusiveMinimum", 0.0) } else { ("minimum", min) };
                object.insert(name.to_owned(), value.into());
                if let Some(default) = default {
                    object.insert("default".to_owned(), default.into());
                }
            }
            schema
        }
        ParameterKind::Integer { min, max, default } => {
            json!({ "type": "integer", "minimum": min, "maximum": max, "default": default })
        }
        ParameterKind::Flag { default } => json!({ "type": "boolean", "default": default }),
        ParameterKind::Choice { words } => json!({ "enum": words, "default": words.first() }),
        ParameterKind::Numbers { min, max, default } => json!({
            "type": "array",
            "items": { "type": "number", "minimum": min, "maximum": max },
            "minItems": default.len(),
            "maxItems": default.len(),
            "default": default,
        }),
        ParameterKind::NumberList { min, max, max_count } => json!({
            "type": "array",
            "items": { "type": "number", "minimum": min, "maximum": max },
            "maxItems": max_count,
        }),
        ParameterKind::Layer => json!({ "type": ["string", "integer"] }),
        ParameterKind::Curve { y: (low, high), .. } => json!({
            "type": "array",
            "minItems": 2,
            "maxItems": MAX_CURVE_POINTS,
            "items": {
                "type": "array",
                "prefixItems": [{ "type": "number" }, { "type": "number", "minimum": low, "maximum": high }],
                "minItems": 2,
                "maxItems": 2,
            },
        }),
        ParameterKind::Text => json!({ "type": "string" }),
        ParameterKind::List { parameters, max } => {
            json!({ "type": "array", "items": object_schema(parameters), "maxItems": max })
        }
        ParameterKind::Object { parameters } => object_schema(parameters),
        ParameterKind::Values => json!({ "type": "object", "additionalProperties": { "type": "number" } }),
        ParameterKind::Normalization => json!({
            "anyOf": [
                { "type": "boolean" },
                { "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 },
            ],
            "default": true,
        }),
    };
    if let Some(object) = schema.as_object_mut() {
        object.insert("description".to_owned(), format!("{}{unit}", parameter.meaning).into());
    }
    schema
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_brush_has_a_schema_with_its_parameters() {
        for description in brush_descriptions() {
            let schema = brush_schema(description.brush_type);
            let properties = schema["properties"].as_object().unwrap();
            assert_eq!(properties.len(), description.parameters.len() + 1);
            assert!(properties.contains_key("radius") && properties.contains_key("strength"));
        }
    }
}
