//! What a picture of a terrain is asked to show.

use orogeny_geomip::{Cursor, Metric, Mode};

use super::Materials;

/// A height of the eye or of what it looks at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HeightAt {
    /// Metres.
    Absolute(f64),
    /// Metres above the ground there.
    AboveGround(f64),
}

/// A place to look from or at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Metres to the east.
    pub x_m: f64,
    /// How high.
    pub height: HeightAt,
    /// Metres to the south.
    pub z_m: f64,
}

/// What a picture shows, and how. The default is the whole terrain, from the south-west.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewRequest {
    /// Pixels along x and y, each up to 8192.
    pub size_px: [u32; 2],
    /// Where the eye is; `None`: far enough off for the whole terrain.
    pub eye: Option<Place>,
    /// What it looks at; `None`: the middle of the terrain.
    pub target: Option<Place>,
    /// The picture's height, degrees of the eye's sight, 1 to 150.
    pub fov_degrees: f64,
    /// What is shown.
    pub mode: Mode,
    /// In [`Mode::Overlay`]: the name of the layer whose mask is shown, or `selection`.
    pub mask: String,
    /// What the ground is made of, in [`Mode::Textured`].
    pub materials: Materials,
    /// Where the sun stands: degrees from north, clockwise.
    pub sun_azimuth_degrees: f64,
    /// Its height above the horizon, degrees, -5 to 90.
    pub sun_altitude_degrees: f64,
    /// So many times the usual haze, 0 to 20.
    pub haze: f64,
    /// How many times as steep slopes are for light, 0 to 100; 1: as they are.
    pub slope_exaggeration: f32,
    /// Brightness of light before the tone curve, in steps of twice as much; 0: as it is.
    pub exposure_stops: f32,
    /// Whether there are shadows.
    pub has_shadows: bool,
    /// Brushes' rings on the ground, 32 at most.
    pub cursors: Vec<Cursor>,
    /// Height of a plane of water, metres.
    pub water_level_m: Option<f32>,
    /// Heights of the first and the last colour, metres; `None`: those of the terrain. In [`Mode::Difference`]: differences, of which the larger
    /// one, up or down, has the full colour; `None`: the largest that is looked at.
    pub range_m: Option<[f32; 2]>,
    /// From contour line to contour line, metres; `None`: about 25 lines.
    pub contour_m: Option<f32>,
    /// How many pixels the ground may be off, 0.1 to 100.
    pub max_error_px: f64,
    /// By what that is measured.
    pub metric: Metric,
}

impl Default for ViewRequest {
    fn default() -> Self {
        Self {
            size_px: [1280, 720],
            eye: None,
            target: None,
            fov_degrees: 45.0,
            mode: Mode::Textured,
            mask: super::source::SELECTION.to_owned(),
            materials: Materials::default(),
            sun_azimuth_degrees: 300.0,
            sun_altitude_degrees: 32.0,
            haze: 1.0,
            slope_exaggeration: 1.0,
            exposure_stops: 0.0,
            has_shadows: true,
            cursors: Vec::new(),
            water_level_m: None,
            range_m: None,
            contour_m: None,
            max_error_px: 2.0,
            metric: Metric::Roughness,
        }
    }
}
