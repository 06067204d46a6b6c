//! A JSON object beside the table of what it may hold.

use serde_json::{Map, Value};

use crate::brush::{BrushType, DataSource, LayerReference, Parameter, ParameterKind};
use crate::noise::Normalization;
use crate::{Curve, Error, Result};

/// The fields of a brush, or of an object in one.
pub(super) struct Fields<'a> {
    brush_type: BrushType,
    /// What stands before the names of fields in errors: empty, or `gate.slope.`.
    path: String,
    /// `None`: the brush's own table.
    parameters: Option<&'static [Parameter]>,
    object: &'a Map<String, Value>,
}

impl<'a> Fields<'a> {
    pub(super) const fn of_brush(brush_type: BrushType, object: &'a Map<String, Value>) -> Self {
        Self { brush_type, path: String::new(), parameters: None, object }
    }

    /// Those of a gate alone, as a brush for masks has it.
    pub(super) const fn of_gate(object: &'a Map<String, Value>) -> Self {
        Self {
            brush_type: BrushType::PaintMask,
            path: String::new(),
            parameters: Some(crate::brush::GATE),
            object,
        }
    }

    pub(super) const fn brush_type(&self) -> BrushType {
        self.brush_type
    }

    fn find(&self, name: &str) -> Option<&'static Parameter> {
        match self.parameters {
            Some(parameters) => parameters.iter().find(|parameter| parameter.name == name),
            None => Parameter::find(self.brush_type, name),
        }
    }

    pub(super) fn refuse_unknown(&self) -> Result<()> {
        let is_type = |name: &str| self.parameters.is_none() && name == "type";
        let unknown = |name: &&String| !is_type(name) && self.find(name).is_none();
        match self.object.keys().find(unknown) {
            None => Ok(()),
            Some(field) => {
                let known: Vec<_> = match self.parameters {
                    Some(parameters) => parameters.iter().map(|parameter| parameter.name).collect(),
                    None => Parameter::of(self.brush_type).map(|parameter| parameter.name).collect(),
                };
                let it = if self.path.is_empty() {
                    "it".to_owned()
                } else {
                    format!("`{}`", self.path.trim_end_matches('.'))
                };
                Err(Error::BrushField {
                    brush: self.brush_type.name(),
                    field: format!("{}{field}", self.path),
                    known: format!("{it} has {}", known.join(", ")),
                })
            }
        }
    }

    /// Whether a field is given.
    pub(super) fn has(&self, name: &str) -> bool {
        self.object.contains_key(name)
    }

    /// A field as it was written.
    pub(super) fn raw(&self, name: &str) -> Option<&'a Value> {
        self.object.get(name)
    }

    /// The object of a field, with its own table; its fields are known ones.
    pub(super) fn object(&self, name: &'static str) -> Result<Option<Self>> {
        let Some(Parameter { kind: ParameterKind::Object { parameters }, .. }) = self.find(name) else {
            return Ok(None);
        };
        let Some(value) = self.object.get(name) else { return Ok(None) };
        let Value::Object(object) = value else {
            return Err(self.refused(name, value, "it must be an object".to_owned()));
        };
        let fields = Self {
            brush_type: self.brush_type,
            path: format!("{}{name}.", self.path),
            parameters: Some(parameters),
            object,
        };
        fields.refuse_unknown()?;
        Ok(Some(fields))
    }

    /// The objects of a list, each with its table; their fields are known ones.
    pub(super) fn list(&self, name: &'static str) -> Result<Vec<Self>> {
        let Some(Parameter { kind: ParameterKind::List { parameters, max }, .. }) = self.find(name) else {
            return Ok(Vec::new());
        };
        let Some(value) = self.object.get(name) else { return Ok(Vec::new()) };
        let refused = || self.refused(name, value, format!("it must be a list of at most {max} objects"));
        let list = value.as_array().filter(|list| list.len() <= *max).ok_or_else(refused)?;
        let fields = |(place, value): (usize, &'a Value)| {
            let fields = Self {
                brush_type: self.brush_type,
                path: format!("{}{name}[{place}].", self.path),
                parameters: Some(parameters),
                object: value.as_object().ok_or_else(refused)?,
            };
            fields.refuse_unknown().map(|()| fields)
        };
        list.iter().enumerate().map(fields).collect()
    }

    /// A number with a default; 0 for a parameter that there is not.
    pub(super) fn number(&self, name: &'static str) -> Result<f64> {
        Ok(self.optional_number(name)?.unwrap_or_default())
    }

    pub(super) fn optional_number(&self, name: &'static str) -> Result<Option<f64>> {
        let Some(parameter) = self.find(name) else { return Ok(None) };
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

    /// A whole number; 0 for a parameter that there is not.
    pub(super) fn integer(&self, name: &'static str) -> Result<u32> {
        let Some(Parameter { kind: ParameterKind::Integer { min, max, default }, .. }) = self.find(name)
        else {
            return Ok(0);
        };
        let Some(value) = self.object.get(name) else { return Ok(*default) };
        let number = value.as_u64().and_then(|number| u32::try_from(number).ok());
        number
            .filter(|number| (*min..=*max).contains(number))
            .ok_or_else(|| self.refused(name, value, format!("it must be a whole number, {min} to {max}")))
    }

    pub(super) fn flag(&self, name: &'static str) -> Result<bool> {
        let Some(Parameter { kind: ParameterKind::Flag { default }, .. }) = self.find(name) else {
            return Ok(false);
        };
        let Some(value) = self.object.get(name) else { return Ok(*default) };
        value.as_bool().ok_or_else(|| self.refused(name, value, "it must be true or false".to_owned()))
    }

    /// A word; the default for one that is not given, empty for a parameter that there is not.
    pub(super) fn word(&self, name: &'static str) -> Result<&'static str> {
        let Some(Parameter { kind: ParameterKind::Choice { words }, .. }) = self.find(name) else {
            return Ok("");
        };
        let Some(value) = self.object.get(name) else {
            return Ok(words.first().copied().unwrap_or_default());
        };
        let found = value.as_str().and_then(|given| words.iter().find(|word| **word == given));
        found
            .copied()
            .ok_or_else(|| self.refused(name, value, format!("it must be one of {}", words.join(", "))))
    }

    /// A word as the value that serialises to it; `fallback` for a parameter that there is not.
    pub(super) fn choice<T: serde::de::DeserializeOwned>(
        &self,
        name: &'static str,
        fallback: T,
    ) -> Result<T> {
        let word = self.word(name)?;
        if word.is_empty() {
            return Ok(fallback);
        }
        // The table lists the words of the type, which a test compares.
        Ok(serde_json::from_value(Value::String(word.to_owned())).unwrap_or(fallback))
    }

    /// Text, where it is given.
    pub(super) fn text(&self, name: &'static str) -> Result<Option<String>> {
        let Some(value) = self.object.get(name) else { return Ok(None) };
        match value.as_str().filter(|text| !text.is_empty() && text.len() <= 4096) {
            Some(text) => Ok(Some(text.to_owned())),
            None => Err(self.refused(name, value, "it must be a name".to_owned())),
        }
    }

    /// Numbers of a fixed count.
    pub(super) fn numbers<const N: usize>(&self, name: &'static str) -> Result<[f64; N]> {
        let Some(Parameter { kind: ParameterKind::Numbers { min, max, default }, .. }) = self.find(name)
        else {
            return Ok([0.0; N]);
        };
        let Some(value) = self.object.get(name) else {
            return Ok(std::array::from_fn(|index| default.get(index).copied().unwrap_or_default()));
        };
        let refused = || self.refused(name, value, format!("it must be {N} numbers, each {min} to {max}"));
        let list = value.as_array().filter(|list| list.len() == N).ok_or_else(refused)?;
        let mut numbers = [0.0; N];
        for (number, value) in numbers.iter_mut().zip(list) {
            *number = value.as_f64().filter(|number| (*min..=*max).contains(number)).ok_or_else(refused)?;
        }
        Ok(numbers)
    }

    /// Any numbers up to a count; none where they are not given.
    pub(super) fn number_list(&self, name: &'static str) -> Result<Vec<f64>> {
        let Some(Parameter { kind: ParameterKind::NumberList { min, max, max_count }, .. }) = self.find(name)
        else {
            return Ok(Vec::new());
        };
        let Some(value) = self.object.get(name) else { return Ok(Vec::new()) };
        let limit = || format!("it must be a list of at most {max_count} numbers, each {min} to {max}");
        let refused = || self.refused(name, value, limit());
        let list = value.as_array().filter(|list| list.len() <= *max_count).ok_or_else(refused)?;
        let number = |value: &Value| value.as_f64().filter(|number| (*min..=*max).contains(number));
        list.iter().map(|value| number(value).ok_or_else(refused)).collect()
    }

    /// A layer, where it is given.
    pub(super) fn layer(&self, name: &'static str) -> Result<Option<LayerReference>> {
        let Some(value) = self.object.get(name) else { return Ok(None) };
        let layer = serde_json::from_value(value.clone());
        layer
            .map(Some)
            .map_err(|_| self.refused(name, value, "it must be a layer's name or its id".to_owned()))
    }

    /// A curve, where it is given.
    pub(super) fn curve(&self, name: &'static str) -> Result<Option<Curve>> {
        let Some(Parameter { kind: ParameterKind::Curve { y: (low, high), .. }, .. }) = self.find(name)
        else {
            return Ok(None);
        };
        let Some(value) = self.object.get(name) else { return Ok(None) };
        let limit = || format!("it must be points [[x, y], …] with rising x, y within {low} to {high}");
        let points: Vec<[f64; 2]> =
            serde_json::from_value(value.clone()).map_err(|_| self.refused(name, value, limit()))?;
        if points.iter().any(|[_, y]| !(*low..=*high).contains(y)) {
            return Err(self.refused(name, value, limit()));
        }
        Curve::new(&format!("`{}{name}` of the brush `{}`", self.path, self.brush_type.name()), points)
            .map(Some)
    }

    /// `true`, `false`, or `[offset, scale]`.
    pub(super) fn normalization(&self, name: &'static str) -> Result<Normalization> {
        let Some(value) = self.object.get(name) else { return Ok(Normalization::Wanted) };
        let given = match value {
            Value::Bool(true) => Some(Normalization::Wanted),
            Value::Bool(false) => Some(Normalization::Off),
            _ => serde_json::from_value::<[f64; 2]>(value.clone())
                .ok()
                .filter(|numbers| numbers.iter().all(|number| number.abs() <= 1.0e9))
                .map(|[offset, scale]| Normalization::Given { offset, scale }),
        };
        given.ok_or_else(|| {
            self.refused(
                name,
                value,
                "it must be true, false or two numbers [offset, scale] within ±1e9".to_owned(),
            )
        })
    }

    /// Numbers under any names.
    pub(super) fn values(&self, name: &'static str) -> Result<Vec<(String, f64)>> {
        let Some(value) = self.object.get(name) else { return Ok(Vec::new()) };
        let limit = || "it must be an object of numbers within ±1e30".to_owned();
        let object = value.as_object().ok_or_else(|| self.refused(name, value, limit()))?;
        let number = |(key, value): (&String, &Value)| {
            let number = value.as_f64().filter(|number| number.abs() <= 1.0e30);
            number.map(|number| (key.clone(), number)).ok_or_else(|| self.refused(name, value, limit()))
        };
        object.iter().map(number).collect()
    }

    /// Data from outside, by its file or by its content's name; at least one is given.
    pub(super) fn source(&self, why: &'static str) -> Result<DataSource> {
        match (self.text("file")?, self.text("blake3")?) {
            (Some(file), None) => Ok(DataSource::File(file)),
            (None, Some(hash)) => Ok(DataSource::Blake3(hash)),
            (Some(file), Some(_)) => {
                Err(self.refused("file", file, "give either `file` or `blake3`".to_owned()))
            }
            (None, None) => {
                let field = match self.path.as_str() {
                    "" => "file",
                    "alpha." => "alpha.file",
                    "source." => "source.file",
                    _ => "image.file",
                };
                Err(Error::MissingField { brush: self.brush_type.name(), field, why })
            }
        }
    }

    pub(super) fn refused(&self, field: &str, value: impl ToString, limit: String) -> Error {
        Error::BrushValue {
            brush: self.brush_type.name(),
            field: format!("{}{field}", self.path),
            value: value.to_string(),
            limit,
        }
    }
}
