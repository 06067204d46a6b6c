//! Sets to and from JSON, and what a usable one is.

use super::layer::Range;
use super::{LayerNoise, LayerSurface, MAX_LAYERS, MaterialLayer, MaterialSet};
use crate::{Error, Result};

/// The longest names and paths, in characters.
const MAX_NAME_CHARACTERS: usize = 64;
const MAX_PATH_CHARACTERS: usize = 1024;
/// Heights that a terrain can have, metres.
const HEIGHT_LIMIT_M: f64 = 1.0e6;

impl MaterialSet {
    /// Reads a set. Fields that are left out take their defaults.
    ///
    /// # Errors
    /// [`Error::MaterialJson`] for what is no JSON of a set, with its line; those of [`Self::check`].
    pub fn from_json(text: &str) -> Result<Self> {
        let refused = |err: serde_json::Error| Error::MaterialJson { reason: err.to_string() };
        let set: Self = serde_json::from_str(text).map_err(refused)?;
        set.check()?;
        Ok(set)
    }

    /// The set as its file holds it. [`Self::from_json`] reads it back.
    ///
    /// # Errors
    /// Those of [`Self::check`].
    pub fn to_json(&self) -> Result<String> {
        self.check()?;
        serde_json::to_string_pretty(self).map_err(|err| Error::MaterialJson { reason: err.to_string() })
    }

    /// Whether it can be used.
    ///
    /// # Errors
    /// [`Error::MaterialLayers`] for none or too many layers; [`Error::MaterialValue`], naming the layer, the field, its value
    /// and what is allowed.
    pub fn check(&self) -> Result<()> {
        if !(1..=MAX_LAYERS).contains(&self.layers.len()) {
            return Err(Error::MaterialLayers { num_layers: self.layers.len(), limit: MAX_LAYERS });
        }
        let place = Place { of: "the set".to_owned() };
        place.text("name", &self.name, MAX_NAME_CHARACTERS)?;
        place.number("macro_variation.feature_m", self.macro_variation.feature_m, 1.0, 1.0e5)?;
        place.number("macro_variation.amount", self.macro_variation.amount, 0.0, 1.0)?;
        place.number("blend_depth", self.blend_depth, 0.02, 1.0)?;
        place.number("blend_contrast", self.blend_contrast, 0.0, 1.0)?;
        for (index, layer) in self.layers.iter().enumerate() {
            let place = Place { of: format!("the layer {index} `{}`", layer.name) };
            layer.check(&place)?;
            if self.layers.iter().take(index).any(|other| other.name == layer.name) {
                return Err(place.refused("name", &layer.name, "give each layer a name of its own"));
            }
        }
        match self.layers.first() {
            Some(base) => base.check_base(&Place { of: format!("the layer 0 `{}`", base.name) }),
            None => Ok(()),
        }
    }
}

impl MaterialLayer {
    fn check(&self, place: &Place) -> Result<()> {
        place.text("name", &self.name, MAX_NAME_CHARACTERS)?;
        self.surface.check(place)?;
        place.number("tile_m", self.tile_m(), 0.25, 1000.0)?;
        if self.height_m.is_some() && self.height_share.is_some() {
            return Err(place.refused("height_share", "given", "give either `height_m` or `height_share`"));
        }
        place.range("height_m", self.height_m, -HEIGHT_LIMIT_M, HEIGHT_LIMIT_M)?;
        place.number("height_fade_m", self.height_fade_m, 0.0, 1.0e4)?;
        place.range("height_share", self.height_share, 0.0, 1.0)?;
        place.number("height_fade_share", self.height_fade_share, 0.0, 1.0)?;
        place.range("slope_degrees", self.slope_degrees, 0.0, 90.0)?;
        place.number("slope_fade_degrees", self.slope_fade_degrees, 0.0, 90.0)?;
        place.range("curvature", self.curvature, -100.0, 100.0)?;
        place.number("curvature_fade", self.curvature_fade, 0.0, 10.0)?;
        if let Some(LayerNoise { feature_m, amount, coverage, seed: _ }) = self.noise {
            place.number("noise.feature_m", feature_m, 0.1, 1.0e5)?;
            place.number("noise.amount", amount, 0.0, 1.0)?;
            place.number("noise.coverage", coverage, 0.0, 1.0)?;
        }
        if let Some(mask) = &self.mask {
            place.text("mask", mask, MAX_NAME_CHARACTERS)?;
        }
        place.number("strength", self.strength, 0.0, 1.0)
    }

    /// Rules of the base would say nothing: it shows wherever the others leave ground.
    fn check_base(&self, place: &Place) -> Result<()> {
        let given = [
            ("height_m", self.height_m.is_some()),
            ("height_share", self.height_share.is_some()),
            ("slope_degrees", self.slope_degrees.is_some()),
            ("curvature", self.curvature.is_some()),
            ("noise", self.noise.is_some()),
            ("mask", self.mask.is_some()),
            ("strength", self.strength != 1.0),
        ];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            Some((field, _)) => Err(place.refused(
                field,
                "given",
                "the first layer is the base and lies wherever no other does: leave the field out, or put a layer before it",
            )),
            None => Ok(()),
        }
    }
}

impl LayerSurface {
    fn check(&self, place: &Place) -> Result<()> {
        match self {
            Self::Procedural(procedural) => {
                for channel in procedural.tint {
                    place.number("surface.tint", f64::from(channel), 0.0, 4.0)?;
                }
                Ok(())
            }
            Self::Files(files) => {
                place.text("surface.albedo", &files.albedo, MAX_PATH_CHARACTERS)?;
                for (field, path) in
                    [("surface.normal", &files.normal), ("surface.roughness", &files.roughness)]
                {
                    if let Some(path) = path {
                        place.text(field, path, MAX_PATH_CHARACTERS)?;
                    }
                }
                Ok(())
            }
        }
    }
}

/// What a value belongs to, for errors.
struct Place {
    of: String,
}

impl Place {
    fn refused(&self, field: &str, value: impl ToString, limit: impl ToString) -> Error {
        Error::MaterialValue {
            of: self.of.clone(),
            field: field.to_owned(),
            value: value.to_string(),
            limit: limit.to_string(),
        }
    }

    fn number(&self, field: &str, value: f64, min: f64, max: f64) -> Result<()> {
        // Not a number is in no range.
        if (min..=max).contains(&value) {
            return Ok(());
        }
        Err(self.refused(field, value, format!("give {min} to {max}")))
    }

    fn range(&self, field: &str, range: Option<Range>, min: f64, max: f64) -> Result<()> {
        let Some([from, to]) = range else { return Ok(()) };
        for limit in [from, to].into_iter().flatten() {
            self.number(field, limit, min, max)?;
        }
        match (from, to) {
            (Some(from), Some(to)) if from >= to => Err(self.refused(
                field,
                format!("[{from}, {to}]"),
                "the first limit must be below the second",
            )),
            _ => Ok(()),
        }
    }

    fn text(&self, field: &str, text: &str, max: usize) -> Result<()> {
        let length = text.chars().count();
        if (1..=max).contains(&length) && !text.chars().any(char::is_control) {
            return Ok(());
        }
        Err(self.refused(field, format!("{text:?}"), format!("give 1 to {max} printable characters")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(layer: &str) -> String {
        format!(
            r#"{{"name": "Test", "layers": [{{"name": "ground", "surface": "soil"}},
                {{"name": "top", "surface": "grass"{layer}}}]}}"#
        )
    }

    #[test]
    fn what_is_written_reads_back() {
        let text = with(
            r#", "tile_m": 2, "height_m": [null, 300], "slope_degrees": [10, 40], "curvature": [0.1, null],
                "noise": {"feature_m": 30, "coverage": 0.5}, "mask": "paths", "strength": 0.5"#,
        );
        let set = MaterialSet::from_json(&text).unwrap();
        assert_eq!(MaterialSet::from_json(&set.to_json().unwrap()).unwrap(), set);
        let layer = &set.layers[1];
        assert_eq!((layer.height_m, layer.slope_fade_degrees), (Some([None, Some(300.0)]), 8.0));
        // What was left out stays so.
        assert!(!set.to_json().unwrap().contains("height_share"));

        for surface in [
            r#"{"procedural": "rock", "tint": [1, 0.5, 0.25], "seed": 4}"#,
            r#"{"albedo": "a.png", "normal": "n.png", "roughness": "r.png"}"#,
            r#"{"albedo": "a.png"}"#,
        ] {
            let set = MaterialSet::from_json(&with("").replace(r#""grass""#, surface)).unwrap();
            assert_eq!(MaterialSet::from_json(&set.to_json().unwrap()).unwrap(), set);
        }
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let surface = |surface: &str| with("").replace(r#""grass""#, surface);
        for (text, words) in [
            ("{".to_owned(), &["line 1"][..]),
            (r#"{"name": "a", "layers": []}"#.to_owned(), &["0 layers", "16"]),
            (with("").replace("Test", ""), &["the set", "name", "64"]),
            (with(r#", "slope": [0, 1]"#), &["slope", "slope_degrees", "line 2"]),
            (with(r#", "tile_m": 0.1"#), &["`top`", "layer 1", "tile_m", "0.1", "0.25", "1000"]),
            (with(r#", "height_m": [10, 5]"#), &["height_m", "[10, 5]", "below"]),
            (with(r#", "height_m": [0, 1], "height_share": [0, 1]"#), &["height_share", "either"]),
            (with(r#", "slope_degrees": [0, 100]"#), &["slope_degrees", "100", "90"]),
            (with(r#", "curvature": [0, 1, 2]"#), &["line 2"]),
            (with(r#", "noise": {"feature_m": 0}"#), &["noise.feature_m", "0.1"]),
            (with(r#", "noise": {"feature_m": 1, "octaves": 2}"#), &["octaves"]),
            (with(r#", "mask": """#), &["mask"]),
            (with(r#", "strength": 1.5"#), &["strength", "1.5"]),
            (with("").replace("\"top\"", "\"ground\""), &["ground", "name of its own"]),
            (
                with("").replace(r#""soil""#, r#""soil", "height_m": [0, 1]"#),
                &["layer 0", "height_m", "base"],
            ),
            (surface(r#""lawn""#), &["lawn", "forest_floor"]),
            (surface("3"), &["surface", "3", "procedural", "albedo"]),
            (surface(r#"{"procedural": "lawn"}"#), &["surface", "lawn", "forest_floor"]),
            (surface(r#"{"procedural": "rock", "colour": 1}"#), &["surface", "colour", "tint"]),
            (surface(r#"{"procedural": "rock", "tint": [9, 1, 1]}"#), &["surface.tint", "9", "4"]),
            (surface(r#"{"albedo": "a.png", "height": "h.png"}"#), &["surface", "height", "roughness"]),
            (surface(r#"{"albedo": ""}"#), &["surface.albedo"]),
        ] {
            let err = MaterialSet::from_json(&text).unwrap_err().to_string();
            for word in words {
                assert!(err.contains(word), "{text}: {err}");
            }
        }
    }

    #[test]
    fn a_number_that_is_none_is_refused() {
        let mut set = MaterialSet::from_json(&with("")).unwrap();
        set.layers[1].strength = f64::NAN;
        assert!(set.check().unwrap_err().to_string().contains("NaN"));
        assert!(set.to_json().is_err());
        set.layers = vec![set.layers[0].clone(); 17];
        assert!(set.check().unwrap_err().to_string().contains("17"));
    }
}
