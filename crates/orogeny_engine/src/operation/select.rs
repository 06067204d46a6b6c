//! Changes of the selection as operations.

use orogeny_field::Selecting;
use serde_json::Value;

use super::not_understood;
use crate::Result;

/// The `op` that it reads.
pub(crate) const NAME: &str = "select";

/// Reads one.
///
/// # Errors
/// [`crate::Error::Operation`], naming the field.
pub(super) fn from_json(mut value: Value) -> Result<Selecting> {
    if let Some(object) = value.as_object_mut() {
        object.remove("op");
    }
    serde_json::from_value(value).map_err(|err| not_understood("the operation", &err))
}

/// Writes one as the history records it.
///
/// # Errors
/// [`crate::Error::Operation`] should a number in it have no JSON form.
pub(crate) fn to_json(selecting: &Selecting) -> Result<String> {
    let mut value = serde_json::to_value(selecting).map_err(|err| not_understood("the operation", &err))?;
    if let Some(object) = value.as_object_mut() {
        object.insert("op".to_owned(), NAME.into());
    }
    Ok(value.to_string())
}

#[cfg(test)]
mod tests {
    use crate::{Operation, Presets};

    use super::*;

    #[test]
    fn what_is_recorded_reads_back() {
        let text = r#"{"op": "select", "shape": {"mask": 3}, "combine": "add", "grow": 2.5, "invert": true}"#;
        let Operation::Select(selecting) = Operation::from_json_text(text).unwrap() else { panic!("{text}") };
        let recorded = to_json(&selecting).unwrap();
        assert_eq!(Operation::from_json_text(&recorded).unwrap(), Operation::Select(selecting));
    }

    #[test]
    fn a_bad_selection_is_refused_by_its_field() {
        for (text, word) in [
            (r#"{"op": "select"}"#, "shape"),
            (r#"{"op": "select", "shape": {"all": true}, "layer": 1}"#, "layer"),
            (r#"{"op": "select", "shape": {"all": true}, "feather": -1}"#, "`feather`"),
        ] {
            let value = serde_json::from_str(text).unwrap();
            let err = Operation::from_json_with(value, Presets::factory()).unwrap_err().to_string();
            assert!(err.contains(word), "{text}: {err}");
        }
    }
}
