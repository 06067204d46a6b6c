//! A set of materials, as its file holds it.

use serde::{Deserialize, Serialize};

use super::MaterialLayer;

/// The most layers of a set.
pub const MAX_LAYERS: usize = 16;

/// What ground looks like: layers, of which each covers those before it by its weight.
///
/// The first is the base: it shows where no other has weight, and takes no rules.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialSet {
    /// Its name: 1 to 64 characters.
    pub name: String,
    /// What it is for, in a sentence.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// Brightness and hue that change over long ways, so that repeats are not seen.
    #[serde(default)]
    pub macro_variation: MacroVariation,
    /// How far the reliefs of two layers reach into each other where they meet, 0.02 to 1: the less, the sharper their border.
    #[serde(default = "default_blend_depth")]
    pub blend_depth: f64,
    /// How much borders follow relief, 0 to 1: at 0 layers just fade.
    #[serde(default = "default_blend_contrast")]
    pub blend_contrast: f64,
    /// The layers, 1 to [`MAX_LAYERS`], the lowest first.
    pub layers: Vec<MaterialLayer>,
}

/// Brightness and hue that change over long ways.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MacroVariation {
    /// The size of its features, metres, 1 to 100000.
    pub feature_m: f64,
    /// How far brightness goes up and down, 0 to 1: by this share of it.
    pub amount: f64,
}

impl Default for MacroVariation {
    fn default() -> Self {
        Self { feature_m: 150.0, amount: 0.2 }
    }
}

const fn default_blend_depth() -> f64 {
    0.2
}

const fn default_blend_contrast() -> f64 {
    0.75
}

impl MaterialSet {
    /// A set of layers with the documented defaults.
    #[must_use]
    pub fn new(name: &str, layers: Vec<MaterialLayer>) -> Self {
        Self {
            name: name.to_owned(),
            description: String::new(),
            macro_variation: MacroVariation::default(),
            blend_depth: default_blend_depth(),
            blend_contrast: default_blend_contrast(),
            layers,
        }
    }
}
