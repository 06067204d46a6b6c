//! One preset: what its file holds, read and written.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use orogeny_field::{Brush, BrushType};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::sample::Sample;
use super::{name, thumbnail};
use crate::{Error, Result, whole_file};

/// The longest file, in bytes.
const MAX_FILE_BYTES: u64 = 1 << 20;
/// The longest description, in characters; tags, and the longest of them.
const MAX_DESCRIPTION_CHARACTERS: usize = 500;
const MAX_TAGS: usize = 16;
const MAX_TAG_CHARACTERS: usize = 32;

/// A brush under a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Its name: 1 to 64 characters.
    #[serde(rename = "preset")]
    pub name: String,
    /// What it is for, in a sentence.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// Words to find it by.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// The brush object as it was written: fields that it leaves out follow their defaults.
    pub brush: Map<String, Value>,
    /// What its thumbnail shows, where that is not a stroke over flat ground.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sample: Option<Sample>,
    /// A picture of it: a PNG as a `data:` URL.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thumbnail: Option<String>,
}

impl Preset {
    /// A brush under a name, with nothing else.
    ///
    /// # Errors
    /// [`Error::Preset`] naming what cannot be used.
    pub fn new(name: &str, brush: Map<String, Value>) -> Result<Self> {
        let preset = Self {
            name: name.to_owned(),
            description: String::new(),
            tags: Vec::new(),
            brush,
            sample: None,
            thumbnail: None,
        };
        preset.check()?;
        Ok(preset)
    }

    /// Reads a preset from JSON text.
    ///
    /// # Errors
    /// [`Error::Preset`] naming the field.
    pub fn from_json_text(text: &str) -> Result<Self> {
        let refused = |err: serde_json::Error| unusable("the preset".to_owned(), err.to_string());
        let preset: Self = serde_json::from_str(text).map_err(refused)?;
        preset.check()?;
        Ok(preset)
    }

    /// Reads a preset's file.
    ///
    /// # Errors
    /// [`Error::Read`], or [`Error::Preset`] naming the file and the field.
    pub fn read(path: &Path) -> Result<Self> {
        let failed = |source| Error::Read { path: path.to_owned(), source };
        let refused = |detail| unusable(format!("`{}`", path.display()), detail);
        // Anything else could keep the reader waiting.
        if !std::fs::metadata(path).map_err(failed)?.is_file() {
            return Err(refused("it is not a file".to_owned()));
        }
        let mut bytes = Vec::new();
        File::open(path).map_err(failed)?.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
        if bytes.len() as u64 > MAX_FILE_BYTES {
            return Err(refused(format!(
                "it is longer than {MAX_FILE_BYTES} bytes: make its thumbnail smaller"
            )));
        }
        let text = String::from_utf8(bytes).map_err(|_| refused("it is not UTF-8".to_owned()))?;
        Self::from_json_text(&text).map_err(|err| match err {
            Error::Preset { detail, .. } => refused(detail),
            other => refused(other.to_string()),
        })
    }

    /// Writes a preset's file, which appears whole or not at all and takes the place of one that is there.
    ///
    /// # Errors
    /// [`Error::Write`]; [`Error::Preset`] as in [`Self::check`].
    pub fn write(&self, path: &Path) -> Result<()> {
        whole_file::write(path, self.to_json_text()?.as_bytes())
    }

    /// As its file holds it.
    ///
    /// # Errors
    /// [`Error::Preset`] as in [`Self::check`].
    pub fn to_json_text(&self) -> Result<String> {
        self.check()?;
        let refused = |detail: String| unusable(format!("`{}`", self.name), detail);
        let mut text = serde_json::to_string_pretty(self).map_err(|err| refused(err.to_string()))?;
        text.push('\n');
        if text.len() as u64 > MAX_FILE_BYTES {
            let detail = format!("it is longer than {MAX_FILE_BYTES} bytes: make its thumbnail smaller");
            return Err(refused(detail));
        }
        Ok(text)
    }

    /// Looks at everything that its type does not already hold.
    ///
    /// # Errors
    /// [`Error::Preset`] naming what cannot be used.
    pub fn check(&self) -> Result<()> {
        name::check(&self.name).map_err(|detail| unusable("the preset".to_owned(), detail))?;
        self.check_words()
            .and_then(|()| Brush::from_json(&self.brush).map(drop).map_err(|err| err.to_string()))
            .and_then(|()| self.sample.as_ref().map_or(Ok(()), Sample::check))
            .and_then(|()| self.thumbnail.as_deref().map_or(Ok(()), thumbnail::check_data_url))
            .map_err(|detail| unusable(format!("the preset `{}`", self.name), detail))
    }

    fn check_words(&self) -> Result<(), String> {
        let length = self.description.chars().count();
        if length > MAX_DESCRIPTION_CHARACTERS {
            return Err(format!(
                "`description` has {length} characters, the limit is {MAX_DESCRIPTION_CHARACTERS}"
            ));
        }
        if self.description.chars().any(char::is_control) {
            return Err("`description` holds a control character: leave it out".to_owned());
        }
        if self.tags.len() > MAX_TAGS {
            return Err(format!("`tags` are {}, the limit is {MAX_TAGS}", self.tags.len()));
        }
        let is_bad = |tag: &&String| {
            let length = tag.chars().count();
            !(1..=MAX_TAG_CHARACTERS).contains(&length) || tag.chars().any(char::is_control)
        };
        match self.tags.iter().find(is_bad) {
            Some(tag) => {
                Err(format!("the tag {tag:?} must have 1 to {MAX_TAG_CHARACTERS} printable characters"))
            }
            None => Ok(()),
        }
    }

    /// The brush with its defaults.
    ///
    /// # Errors
    /// [`Error::Field`] naming the field.
    pub fn brush(&self) -> Result<Brush> {
        Ok(Brush::from_json(&self.brush)?)
    }

    /// The brush's type.
    ///
    /// # Errors
    /// [`Error::Field`] naming the field.
    pub fn brush_type(&self) -> Result<BrushType> {
        Ok(self.brush()?.brush_type)
    }
}

/// What cannot be used, and why.
pub(super) const fn unusable(place: String, detail: String) -> Error {
    Error::Preset { place, detail }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(fields: &str) -> String {
        format!(r#"{{"preset": "Hill", "brush": {{"type": "raise", "radius": 40}}{fields}}}"#)
    }

    #[test]
    fn what_is_written_reads_back() {
        let text =
            with(r#", "description": "Soft", "tags": ["a"], "sample": {"kind": "dab", "height_m": 5}"#);
        let preset = Preset::from_json_text(&text).unwrap();
        assert_eq!(Preset::from_json_text(&preset.to_json_text().unwrap()).unwrap(), preset);
        // The brush stays as it was written, so that what it leaves out can still follow.
        assert_eq!(preset.brush.len(), 2);
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let long = format!(r#", "description": "{}""#, "x".repeat(501));
        for (text, words) in [
            (String::new(), &["the preset"][..]),
            ("[]".to_owned(), &["the preset"]),
            (r#"{"preset": "Hill"}"#.to_owned(), &["brush"]),
            (r#"{"brush": {"type": "raise"}}"#.to_owned(), &["preset"]),
            (r#"{"preset": "a/b", "brush": {"type": "raise"}}"#.to_owned(), &["a/b", "`/`"]),
            (r#"{"preset": "Hill", "brush": {"type": "raze"}}"#.to_owned(), &["Hill", "raze"]),
            (
                r#"{"preset": "Hill", "brush": {"type": "raise", "radios": 1}}"#.to_owned(),
                &["Hill", "radios"],
            ),
            (r#"{"preset": "Hill", "brush": {"preset": "Hill"}}"#.to_owned(), &["Hill"]),
            (with(r#", "colour": 1"#), &["colour"]),
            (with(r#", "tags": [""]"#), &["tag"]),
            (with(r#", "description": "a\u001bb""#), &["description", "control"]),
            (with(&long), &["501", "500"]),
            (with(r#", "sample": {"kind": "swirl"}"#), &["swirl"]),
            (with(r#", "sample": {"depth": 1}"#), &["depth"]),
            (with(r#", "sample": {"height_m": 1e30}"#), &["height_m"]),
            (with(r#", "thumbnail": "http://example.org""#), &["thumbnail", "data:image/png"]),
            (with(r#", "thumbnail": "data:image/png;base64,AAAA""#), &["thumbnail", "PNG"]),
        ] {
            let err = Preset::from_json_text(&text).unwrap_err().to_string();
            for word in words {
                assert!(err.contains(word), "{text}: {err}");
            }
        }
    }
}
