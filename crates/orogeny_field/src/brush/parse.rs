//! Brushes to and from JSON, by the table of parameters.

use serde_json::{Map, Value};

use super::{
    Blending, Brush, BrushType, LedgeDirection, LevelOnly, Parameter, ParameterKind, PressureTarget, Profile,
    ProfileShape,
};
use crate::{Error, Result};

impl Brush {
    /// A brush with the documented defaults.
    #[must_use]
    pub fn new(brush_type: BrushType, radius_m: f64, strength: f64) -> Self {
        Self {
            brush_type,
            radius_m,
            shape: ProfileShape::Smooth,
            falloff_m: radius_m,
            strength,
            spacing: 0.25,
            pressure: PressureTarget::Strength,
            blending: Blending::Wash,
            height_m: None,
            direction: LedgeDirection::Raise,
            only: LevelOnly::Both,
        }
    }

    /// Reads a brush object: `{"type": "raise", "radius": 40, …}`. Missing fields take their defaults.
    ///
    /// # Errors
    /// [`Error::BrushType`], [`Error::BrushField`], [`Error::BrushValue`] or [`Error::MissingField`], naming the field,
    /// its value and what is allowed.
    pub fn from_json(object: &Map<String, Value>) -> Result<Self> {
        let brush_type = brush_type_of(object)?;
        let fields = Fields { brush_type, object };
        fields.refuse_unknown()?;
        let radius_m = fields.number("radius")?;
        let falloff_m = fields.optional_number("falloff")?.unwrap_or(radius_m);
        if falloff_m > radius_m {
            return Err(fields.refused(
                "falloff",
                falloff_m,
                format!("it must be within 0 to the radius, {radius_m} m"),
            ));
        }
        for (parameter, profile) in [("power", "power"), ("steepness", "sigmoid")] {
            if let Some(value) = object.get(parameter)
                && fields.word("profile")? != profile
            {
                return Err(fields.refused(
                    parameter,
                    value,
                    format!("it needs `\"profile\": \"{profile}\"`"),
                ));
            }
        }
        let shape = match fields.word("profile")? {
            "power" => ProfileShape::Power { power: fields.number("power")? },
            "linear" => ProfileShape::Linear,
            "sphere" => ProfileShape::Sphere,
            "tip" => ProfileShape::Tip,
            "gauss" => ProfileShape::Gauss,
            "sigmoid" => ProfileShape::Sigmoid { steepness: fields.number("steepness")? },
            _ => ProfileShape::Smooth,
        };
        let brush = Self {
            brush_type,
            radius_m,
            shape,
            falloff_m,
            strength: fields.number("strength")?,
            spacing: fields.number("spacing")?,
            pressure: match fields.word("pressure")? {
                "none" => PressureTarget::None,
                "radius" => PressureTarget::Radius,
                "both" => PressureTarget::Both,
                _ => PressureTarget::Strength,
            },
            blending: match fields.word("blending")? {
                "build_up" => Blending::BuildUp,
                _ => Blending::Wash,
            },
            height_m: fields.optional_number("height")?.map(|height_m| height_m as f32),
            direction: match fields.word("direction")? {
                "lower" => LedgeDirection::Lower,
                _ => LedgeDirection::Raise,
            },
            only: match fields.word("only")? {
                "cut" => LevelOnly::Cut,
                "fill" => LevelOnly::Fill,
                _ => LevelOnly::Both,
            },
        };
        if brush_type == BrushType::SetHeight && brush.height_m.is_none() {
            let why = "it is the height that the ground is set to";
            return Err(Error::MissingField { brush: brush_type.name(), field: "height", why });
        }
        Ok(brush)
    }

    /// Accepts a brush that was made by its fields.
    ///
    /// # Errors
    /// As [`Self::from_json`]: a number that is not finite or out of its range is named.
    pub fn check(&self) -> Result<()> {
        Self::from_json(&self.to_json()).map(drop)
    }

    /// Writes all parameters that the brush has, so that reading them back gives the same brush.
    #[must_use]
    pub fn to_json(&self) -> Map<String, Value> {
        let mut object = Map::new();
        let mut put = |name: &str, value: Value| {
            if name == "type" || Parameter::find(self.brush_type, name).is_some() {
                object.insert(name.to_owned(), value);
            }
        };
        put("type", self.brush_type.name().into());
        put("radius", self.radius_m.into());
        put("falloff", self.falloff_m.into());
        let profile = match self.shape {
            ProfileShape::Power { power } => {
                put("power", power.into());
                "power"
            }
            ProfileShape::Linear => "linear",
            ProfileShape::Smooth => "smooth",
            ProfileShape::Sphere => "sphere",
            ProfileShape::Tip => "tip",
            ProfileShape::Gauss => "gauss",
            ProfileShape::Sigmoid { steepness } => {
                put("steepness", steepness.into());
                "sigmoid"
            }
        };
        put("profile", profile.into());
        put("strength", self.strength.into());
        put("spacing", self.spacing.into());
        let word = |value: Result<Value, serde_json::Error>| value.unwrap_or(Value::Null);
        put("pressure", word(serde_json::to_value(self.pressure)));
        put("blending", word(serde_json::to_value(self.blending)));
        put("direction", word(serde_json::to_value(self.direction)));
        put("only", word(serde_json::to_value(self.only)));
        if let Some(height_m) = self.height_m {
            put("height", f64::from(height_m).into());
        }
        object
    }

    /// Weight over the distance from the centre.
    #[must_use]
    pub fn profile(&self) -> Profile {
        Profile { shape: self.shape, falloff_ratio: self.falloff_m / self.radius_m }
    }
}

fn brush_type_of(object: &Map<String, Value>) -> Result<BrushType> {
    let known = || {
        let names: Vec<_> = BrushType::ALL.iter().map(|brush_type| brush_type.name()).collect();
        format!("there are {}", names.join(", "))
    };
    let unknown = |name: String| Error::BrushType { name, known: known() };
    match object.get("type") {
        Some(Value::String(name)) => BrushType::from_name(name).ok_or_else(|| unknown(name.clone())),
        Some(other) => Err(unknown(other.to_string())),
        None => Err(unknown(String::new())),
    }
}

/// The fields of a brush object beside the table.
struct Fields<'a> {
    brush_type: BrushType,
    object: &'a Map<String, Value>,
}

impl Fields<'_> {
    fn refuse_unknown(&self) -> Result<()> {
        let unknown = |name: &&String| *name != "type" && Parameter::find(self.brush_type, name).is_none();
        match self.object.keys().find(unknown) {
            None => Ok(()),
            Some(field) => {
                let known: Vec<_> = Parameter::of(self.brush_type).map(|parameter| parameter.name).collect();
                Err(Error::BrushField {
                    brush: self.brush_type.name(),
                    field: field.clone(),
                    known: format!("it has {}", known.join(", ")),
                })
            }
        }
    }

    /// A number with a default; 0 for a parameter that the brush does not have.
    fn number(&self, name: &'static str) -> Result<f64> {
        Ok(self.optional_number(name)?.unwrap_or_default())
    }

    fn optional_number(&self, name: &'static str) -> Result<Option<f64>> {
        let Some(parameter) = Parameter::find(self.brush_type, name) else { return Ok(None) };
        let ParameterKind::Number { min, max, default } = parameter.kind else { return Ok(None) };
        let unit = if parameter.unit.is_empty() { "" } else { " " };
        let limit = || {
            let lowest = if min > 0.0 && min < 1.0e-300 { "above 0".to_owned() } else { format!("{min}") };
            format!("it must be a number, {lowest} to {max}{unit}{}", parameter.unit)
        };
        match self.object.get(name) {
            None => Ok(default),
            Some(value) => match value.as_f64().filter(|number| (min..=max).contains(number)) {
                Some(number) => Ok(Some(number)),
                None => Err(self.refused(name, value, limit())),
            },
        }
    }

    /// A word; the default for a parameter that the brush does not have.
    fn word(&self, name: &'static str) -> Result<&'static str> {
        let Some(parameter) = Parameter::find(self.brush_type, name) else { return Ok("") };
        let ParameterKind::Choice { words } = parameter.kind else { return Ok("") };
        let Some(value) = self.object.get(name) else {
            return Ok(words.first().copied().unwrap_or_default());
        };
        let found = value.as_str().and_then(|given| words.iter().find(|word| **word == given));
        found
            .copied()
            .ok_or_else(|| self.refused(name, value, format!("it must be one of {}", words.join(", "))))
    }

    fn refused(&self, field: &'static str, value: impl ToString, limit: String) -> Error {
        Error::BrushValue { brush: self.brush_type.name(), field, value: value.to_string(), limit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Brush> {
        Brush::from_json(&serde_json::from_str(text).unwrap())
    }

    #[test]
    fn every_brush_survives_writing_and_reading() {
        for brush_type in BrushType::ALL {
            for profile in ["power", "linear", "smooth", "sphere", "tip", "gauss", "sigmoid"] {
                let text = format!(
                    r#"{{"type": "{}", "profile": "{profile}", "radius": 37.5, "falloff": 12.5, "strength": 0.75,
                        "height": 3}}"#,
                    brush_type.name()
                );
                let mut object: Map<String, Value> = serde_json::from_str(&text).unwrap();
                if Parameter::find(brush_type, "height").is_none() {
                    object.remove("height");
                }
                let brush = Brush::from_json(&object).unwrap();
                assert_eq!(Brush::from_json(&brush.to_json()).unwrap(), brush);
            }
        }
    }

    #[test]
    fn bad_fields_are_named() {
        for (text, word) in [
            (r#"{"type": "raze"}"#, "raze"),
            (r#"{}"#, "no brush type"),
            (r#"{"type": "raise", "radios": 3}"#, "radios"),
            (r#"{"type": "raise", "height": 3}"#, "height"),
            (r#"{"type": "raise", "radius": 0}"#, "above 0"),
            (r#"{"type": "raise", "radius": -1}"#, "radius"),
            (r#"{"type": "raise", "radius": 1e10}"#, "radius"),
            (r#"{"type": "raise", "radius": "4"}"#, "radius"),
            (r#"{"type": "raise", "strength": -1}"#, "strength"),
            (r#"{"type": "raise", "strength": null}"#, "strength"),
            (r#"{"type": "level", "strength": 1.5}"#, "strength"),
            (r#"{"type": "raise", "falloff": 51}"#, "falloff"),
            (r#"{"type": "raise", "profile": "cone"}"#, "cone"),
            (r#"{"type": "set_height"}"#, "height"),
            (r#"{"type": "raise", "power": 3}"#, "profile"),
            (r#"{"type": "raise", "profile": "power", "steepness": 3}"#, "sigmoid"),
        ] {
            let err = parse(text).unwrap_err().to_string();
            assert!(err.contains(word), "{text}: {err}");
        }
    }

    #[test]
    fn a_brush_made_by_its_fields_is_checked_like_one_that_was_read() {
        let good = Brush::new(BrushType::Level, 50.0, 0.5);
        assert_eq!(good.check(), Ok(()));
        for bad in [f64::NAN, f64::INFINITY, -1.0] {
            for (brush, field) in [
                (Brush { radius_m: bad, ..good.clone() }, "radius"),
                (Brush { falloff_m: bad, ..good.clone() }, "falloff"),
                (Brush { strength: bad, ..good.clone() }, "strength"),
                (Brush { spacing: bad, ..good.clone() }, "spacing"),
                (Brush { shape: ProfileShape::Power { power: bad }, ..good.clone() }, "power"),
                (Brush { height_m: Some((bad * 1.0e30) as f32), ..good.clone() }, "height"),
            ] {
                let err = brush.check().unwrap_err().to_string();
                assert!(err.contains(field), "{bad}: {err}");
            }
        }
    }

    #[test]
    fn defaults_of_the_table_are_the_defaults_of_new() {
        assert_eq!(parse(r#"{"type": "raise"}"#).unwrap(), Brush::new(BrushType::Raise, 50.0, 10.0));
        assert_eq!(parse(r#"{"type": "level"}"#).unwrap(), Brush::new(BrushType::Level, 50.0, 1.0));
    }
}
