//! One layer of a set, as its file holds it.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::Surface;

/// Two limits, the lower first; `null` in a file leaves a side open.
pub(super) type Range = [Option<f64>; 2];

/// One kind of ground and where it lies. A rule that is left out holds everywhere; all that are given are multiplied.
///
/// On a limit of a range a layer has half its weight; it fades over the whole of the `…_fade`, half of it on either side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialLayer {
    /// Its name: 1 to 64 characters, another one for each layer.
    pub name: String,
    /// What it shows.
    pub surface: LayerSurface,
    /// Metres of one repeat of its texture, 0.25 to 1000; that of the surface where it is left out, 4 for files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tile_m: Option<f64>,
    /// Heights, metres, that it lies between.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<Range>,
    /// Metres over which it fades at the limits of `height_m`, 0 to 10000.
    #[serde(default = "default_height_fade_m", skip_serializing_if = "is_default_height_fade")]
    pub height_fade_m: f64,
    /// Heights that it lies between as shares of the terrain's: 0 is its lowest, 1 its highest ground. In place of `height_m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_share: Option<Range>,
    /// The share over which it fades at the limits of `height_share`, 0 to 1.
    #[serde(default = "default_height_fade_share", skip_serializing_if = "is_default_share_fade")]
    pub height_fade_share: f64,
    /// Slopes that it lies on, degrees from level ground, 0 to 90.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slope_degrees: Option<Range>,
    /// Degrees over which it fades at the limits of `slope_degrees`, 0 to 90.
    #[serde(default = "default_slope_fade_degrees", skip_serializing_if = "is_default_slope_fade")]
    pub slope_fade_degrees: f64,
    /// Curvatures that it lies on, 1/m: above 0 on ridges, below 0 in hollows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curvature: Option<Range>,
    /// 1/m over which it fades at the limits of `curvature`, 0 to 10.
    #[serde(default = "default_curvature_fade", skip_serializing_if = "is_default_curvature_fade")]
    pub curvature_fade: f64,
    /// What breaks its borders up, or leaves it in patches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<LayerNoise>,
    /// A painted mask by its name: the weight is multiplied by it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mask: Option<String>,
    /// Its greatest weight, 0 to 1.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub strength: f64,
}

/// What breaks a layer up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayerNoise {
    /// The size of its features, metres, 0.1 to 100000.
    pub feature_m: f64,
    /// How far it moves borders to and fro, 0 to 1: at 1 over all of the fade.
    #[serde(default = "half")]
    pub amount: f64,
    /// The share of the ground that the layer lies on, in patches, 0 to 1.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub coverage: f64,
    /// Other numbers give other patches.
    #[serde(default)]
    pub seed: u32,
}

/// What a layer shows. In a file: `"grass"`, `{"procedural": "grass", "tint": [1, 0.9, 0.8]}` or `{"albedo": "a.png", …}`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum LayerSurface {
    /// A surface that ships with the program.
    Procedural(ProceduralSurface),
    /// Pictures.
    Files(SurfaceFiles),
}

/// A surface that ships with the program.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProceduralSurface {
    /// Which.
    #[serde(rename = "procedural")]
    pub surface: Surface,
    /// Its albedo is multiplied by this, in linear light: 0 to 4 by channel.
    #[serde(default = "white", skip_serializing_if = "is_white")]
    pub tint: [f32; 3],
    /// Other numbers give other textures of the kind.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub seed: u32,
}

/// The pictures of a surface, as paths from the folder of the set's file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceFiles {
    /// Albedo, sRGB; the relief's height in alpha, where it has one.
    pub albedo: String,
    /// Tangent-space normals, x to the right and y down.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<String>,
    /// Roughness, linear, in the first channel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roughness: Option<String>,
}

impl MaterialLayer {
    /// A layer that lies everywhere.
    #[must_use]
    pub fn new(name: &str, surface: Surface) -> Self {
        Self {
            name: name.to_owned(),
            surface: LayerSurface::Procedural(ProceduralSurface { surface, tint: white(), seed: 0 }),
            tile_m: None,
            height_m: None,
            height_fade_m: default_height_fade_m(),
            height_share: None,
            height_fade_share: default_height_fade_share(),
            slope_degrees: None,
            slope_fade_degrees: default_slope_fade_degrees(),
            curvature: None,
            curvature_fade: default_curvature_fade(),
            noise: None,
            mask: None,
            strength: 1.0,
        }
    }

    /// Metres of one repeat of its texture.
    #[must_use]
    pub fn tile_m(&self) -> f64 {
        self.tile_m.unwrap_or(match &self.surface {
            LayerSurface::Procedural(procedural) => f64::from(procedural.surface.tile_m()),
            LayerSurface::Files(_) => 4.0,
        })
    }
}

// By hand: of an untagged enum serde would say only that nothing matched.
impl<'de> Deserialize<'de> for LayerSurface {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        use serde::de::Error as _;
        let value = Value::deserialize(deserializer)?;
        let read = match value {
            Value::String(name) => {
                let surface = Surface::from_name(&name).map_err(D::Error::custom)?;
                return Ok(Self::Procedural(ProceduralSurface { surface, tint: white(), seed: 0 }));
            }
            Value::Object(object) if object.contains_key("albedo") => {
                serde_json::from_value(Value::Object(object)).map(Self::Files)
            }
            Value::Object(object) if object.contains_key("procedural") => procedural(object),
            other => {
                return Err(D::Error::custom(format!(
                    "`surface` cannot be {other}: give a surface's name, an object with `procedural`, or one with `albedo`"
                )));
            }
        };
        read.map_err(|err| D::Error::custom(format!("`surface`: {err}")))
    }
}

fn procedural(object: Map<String, Value>) -> serde_json::Result<LayerSurface> {
    serde_json::from_value(Value::Object(object)).map(LayerSurface::Procedural)
}

const fn default_height_fade_m() -> f64 {
    40.0
}

const fn default_height_fade_share() -> f64 {
    0.08
}

const fn default_slope_fade_degrees() -> f64 {
    8.0
}

const fn default_curvature_fade() -> f64 {
    0.02
}

const fn one() -> f64 {
    1.0
}

const fn half() -> f64 {
    0.5
}

const fn white() -> [f32; 3] {
    [1.0; 3]
}

fn is_default_height_fade(value: &f64) -> bool {
    *value == default_height_fade_m()
}

fn is_default_share_fade(value: &f64) -> bool {
    *value == default_height_fade_share()
}

fn is_default_slope_fade(value: &f64) -> bool {
    *value == default_slope_fade_degrees()
}

fn is_default_curvature_fade(value: &f64) -> bool {
    *value == default_curvature_fade()
}

fn is_one(value: &f64) -> bool {
    *value == 1.0
}

fn is_white(value: &[f32; 3]) -> bool {
    *value == white()
}

const fn is_zero(value: &u32) -> bool {
    *value == 0
}
