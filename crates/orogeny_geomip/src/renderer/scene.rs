//! What a picture shows of the ground, and in which light.

use crate::{DetailRule, Sky};

/// What is shown of the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Mode {
    /// One plain material, to see shapes by.
    Shaded,
    /// The material set.
    Textured,
    /// The triangles, over plain material.
    Wireframe,
    /// How steep it is.
    Slope,
    /// Which way it falls.
    Aspect,
    /// Bands of colour by height.
    HeightBands,
    /// Lines of equal height.
    Contours,
    /// The normals as colours: east, north, up.
    Normals,
    /// How finely each tile is drawn.
    Details,
    /// A mask over the ground.
    Overlay,
    /// By how much it is higher than it was, red, or lower, blue.
    Difference,
}

impl Mode {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Shaded,
        Self::Textured,
        Self::Wireframe,
        Self::Slope,
        Self::Aspect,
        Self::HeightBands,
        Self::Contours,
        Self::Normals,
        Self::Details,
        Self::Overlay,
        Self::Difference,
    ];

    /// What users call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shaded => "shaded",
            Self::Textured => "textured",
            Self::Wireframe => "wireframe",
            Self::Slope => "slope",
            Self::Aspect => "aspect",
            Self::HeightBands => "height-bands",
            Self::Contours => "contours",
            Self::Normals => "normals",
            Self::Details => "details",
            Self::Overlay => "mask",
            Self::Difference => "difference",
        }
    }

    /// Its number in `shaders/terrain/analysis.wgsl`.
    pub(super) const fn analysis(self) -> u32 {
        match self {
            Self::Shaded | Self::Textured | Self::Wireframe => 0,
            Self::Slope => 1,
            Self::Aspect => 2,
            Self::HeightBands => 3,
            Self::Contours => 4,
            Self::Normals => 5,
            Self::Details => 6,
            // Both are colours of what lies over the ground, from blue by grey to red.
            Self::Overlay | Self::Difference => 7,
        }
    }
}

/// What lies over the ground of a page, sample by sample. A picture shows one kind of it alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Overlay<'a> {
    /// Four masks, a byte each, where 255 is 1: the first is what [`Mode::Overlay`] shows, and they are the masks of a material set, in its order.
    Masks(&'a [[u8; 4]]),
    /// What [`Mode::Difference`] shows: by how much the ground is higher than it was, metres.
    Difference(&'a [f32]),
}

/// How light meets the ground and the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// How many times as steep slopes are for light alone: 1 as they are, more where flat land is to show its shape.
    pub slope_exaggeration: f32,
    /// What light is multiplied by before the tone curve, where there is one.
    pub exposure: f32,
    /// How much hollows lose of the sky's light, 0..=1.
    pub ambient_occlusion: f32,
    /// Whether there are shadows.
    pub has_shadows: bool,
}

impl Default for Light {
    fn default() -> Self {
        Self { slope_exaggeration: 1.0, exposure: 4.0, ambient_occlusion: 1.0, has_shadows: true }
    }
}

/// Haze that thins out with height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fog {
    /// How much of it there is at its base, 1/m; 0: none.
    pub density: f32,
    /// How fast it thins out, 1/m.
    pub falloff: f32,
    /// The height of its base, metres.
    pub base_m: f32,
}

/// A brush's ring on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cursor {
    /// Its middle, x and z in metres.
    pub centre_m: [f64; 2],
    /// Its radius, metres.
    pub radius_m: f32,
    /// The share of the radius over which the brush acts wholly, 0..=1.
    pub hardness: f32,
}

/// All that a picture depends on beside the terrain and the camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// What is shown.
    pub mode: Mode,
    /// How finely.
    pub detail: DetailRule,
    /// Sun and sky.
    pub sky: Sky,
    /// How their light is shown.
    pub light: Light,
    /// Haze.
    pub fog: Fog,
    /// The height of a plane of water, metres; `None`: there is none.
    pub water_level_m: Option<f32>,
    /// Heights of the first and the last colour, metres.
    pub range_m: [f32; 2],
    /// From contour line to contour line, metres.
    pub contour_m: f32,
    /// Values of the first and the last colour of the overlay.
    pub overlay_range: [f32; 2],
    /// What lies over the ground where nothing was painted: four masks, 0..=1, or in the first the difference, metres.
    pub unpainted_overlay: [f32; 4],
    /// Brushes' rings.
    pub cursors: Vec<Cursor>,
}
