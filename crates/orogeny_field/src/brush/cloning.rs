//! What a clone brush copies, from where, and how it is blended in.

use super::DataSource;
use crate::Placing;

/// The most levels of a pyramid by which a clone is blended in: the coarsest changes over some 16,384 samples.
pub const MAX_PYRAMID_LEVELS: u32 = 12;

/// What a clone brush does.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloning {
    /// Where the ground comes from.
    pub source: CloneSource,
    /// How it is blended in.
    pub blend: CloneBlend,
    /// Of [`CloneBlend::Laplacian`]: levels below the finest; `None`: until the shorter side of what is painted is at most 8
    /// samples.
    pub num_levels: Option<u32>,
    /// Of [`CloneBlend::Laplacian`]: how much of each level is taken from the source, 0..1, the finest first; 1 for those that
    /// are not given.
    pub level_weights: Vec<f64>,
}

/// Where cloned ground comes from, and how it comes to lie.
#[derive(Debug, Clone, PartialEq)]
pub struct CloneSource {
    /// Data from outside; `None`: this terrain, as it was before the stroke.
    pub data: Option<DataSource>,
    /// Which layer of this terrain; `None`: the one that is painted on.
    pub layer: Option<LayerReference>,
    /// The part of it that is copied, `[x, z, width, depth]` in its metres, far edges outside; `None`: all of it.
    pub region_m: Option<[f64; 4]>,
    /// Over how many of its metres that part begins at its edges.
    pub feather_m: f64,
    /// A place on the source, in its metres.
    pub at_m: [f64; 2],
    /// Where that place comes to lie.
    pub alignment: Alignment,
    /// Of [`Alignment::Aligned`]: where, in metres.
    pub to_m: Option<[f64; 2]>,
    /// Degrees by which it is turned from x towards z.
    pub rotation_deg: f64,
    /// How much larger it becomes, above 0.
    pub scale: f64,
    /// Whether its left and right change places, before it is turned.
    pub is_mirrored: bool,
    /// What its heights are multiplied by.
    pub height_scale: f64,
    /// What is added to them then, in metres.
    pub height_offset_m: f64,
    /// Whether only what the selection holds there is copied.
    pub is_selected_only: bool,
    /// Of data from outside: metres between its samples, whatever it says; `None`: what it says, else the terrain's.
    pub spacing_m: Option<f64>,
    /// Of a file of 8 or 16 bits: what its lowest and its highest value stand for, in metres.
    pub range_m: Option<[f64; 2]>,
}

/// Which place the source's one comes to lie on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Alignment {
    /// The first point of each stroke.
    Stroke,
    /// The same place for all strokes.
    Aligned,
    /// The centre of each instance: all copy the same.
    Fixed,
}

/// How cloned ground is blended in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CloneBlend {
    /// Each scale over its own distance, by Laplacian pyramids (Burt & Adelson 1983).
    Laplacian,
    /// By the brush's falloff.
    Feathered,
    /// By the falloff, raised or lowered first so that the mean under the stroke stays.
    MeanShifted,
    /// As it is, with a hard edge.
    Plain,
}

/// A layer, by its id or its name.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(untagged)]
pub enum LayerReference {
    /// What a recorded operation holds: ids never change.
    Id(u32),
    /// What people write.
    Name(String),
}

impl Default for Cloning {
    fn default() -> Self {
        Self {
            source: CloneSource::default(),
            blend: CloneBlend::Laplacian,
            num_levels: None,
            level_weights: Vec::new(),
        }
    }
}

impl Default for CloneSource {
    fn default() -> Self {
        Self {
            data: None,
            layer: None,
            region_m: None,
            feather_m: 0.0,
            at_m: [0.0; 2],
            alignment: Alignment::Stroke,
            to_m: None,
            rotation_deg: 0.0,
            scale: 1.0,
            is_mirrored: false,
            height_scale: 1.0,
            height_offset_m: 0.0,
            is_selected_only: false,
            spacing_m: None,
            range_m: None,
        }
    }
}

impl Cloning {
    /// How much of a level is taken from the source; 0 is the finest.
    #[must_use]
    pub fn level_weight(&self, level: u32) -> f64 {
        self.level_weights.get(level as usize).copied().unwrap_or(1.0)
    }
}

impl CloneSource {
    /// How it lies on a terrain once its place lies at `to_m`.
    #[must_use]
    pub const fn placing(&self, to_m: [f64; 2], source_spacing_m: f64, spacing_m: f64) -> Placing {
        Placing {
            at_m: self.at_m,
            to_m,
            rotation_deg: self.rotation_deg,
            scale: self.scale,
            is_mirrored: self.is_mirrored,
            source_spacing_m,
            spacing_m,
        }
    }
}
