//! `render`: the terrain as it is seen from somewhere.

use std::fmt;
use std::time::Instant;

use clap::{Args, ValueEnum};
use orogeny_engine::{
    Cursor, Drawn, EntryId, FrameReport, Materials, Metric, Mode, Place, Terrain, ViewRequest,
};
use serde::Serialize;

use super::Arguments;
use crate::output::{text_of, write_notices};
use crate::progress::ProgressWatch;
use crate::session::Session;
use crate::values;

/// From where, and how it is shown.
#[derive(Debug, Args)]
pub struct ViewArguments {
    /// Where the eye is, metres; Y as +Y is above the ground [default: far enough off for all of the terrain]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::view_place, allow_hyphen_values = true, conflicts_with = "map")]
    eye: Option<Place>,
    /// What it looks at; Y as +Y is above the ground [default: the middle of the terrain]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::view_place, allow_hyphen_values = true, conflicts_with = "map")]
    target: Option<Place>,
    /// How much is seen from the picture's top to its bottom, degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 45.0, conflicts_with = "map")]
    fov: f64,
    /// What is shown
    #[arg(long, value_enum, default_value_t = ModeName::Textured, conflicts_with = "map")]
    mode: ModeName,
    /// What the ground is made of: alpine, arctic, desert, volcanic, or a JSON file of a set of your own
    #[arg(long, value_name = "SET", default_value = "alpine", conflicts_with = "map")]
    materials: String,
    /// For --mode mask: the name of the layer whose mask is shown, or `selection`
    #[arg(long, value_name = "LAYER", default_value = "selection", conflicts_with = "map")]
    mask: String,
    /// For --mode difference: the entry of the history since when, as `log` numbers them; 0: since the terrain was made
    #[arg(long, value_name = "ENTRY", required_if_eq("mode", "difference"), conflicts_with = "map")]
    since: Option<u32>,
    /// Where the sun stands: degrees from north, clockwise, and above the horizon
    #[arg(long, value_name = "AZIMUTH,ALTITUDE", default_value = "300,32", value_parser = values::sun, allow_hyphen_values = true, conflicts_with = "map")]
    sun: [f64; 2],
    /// So many times the usual haze
    #[arg(long, value_name = "TIMES", default_value_t = 1.0, conflicts_with = "map")]
    haze: f64,
    /// Brightness, in steps of twice as much
    #[arg(
        long,
        value_name = "STOPS",
        default_value_t = 0.0,
        allow_hyphen_values = true,
        conflicts_with = "map"
    )]
    exposure: f32,
    /// How many times as steep slopes are for light, to see the shape of flat land
    #[arg(long, value_name = "TIMES", default_value_t = 1.0, conflicts_with = "map")]
    exaggerate: f32,
    /// Draw no shadows
    #[arg(long, conflicts_with = "map")]
    no_shadows: bool,
    /// A brush's ring on the ground: its middle and its radius in metres, and the share of that within which it acts wholly; repeatable
    #[arg(long, value_name = "X,Z,RADIUS,HARDNESS", value_parser = values::cursor, allow_hyphen_values = true, conflicts_with = "map")]
    cursor: Vec<Cursor>,
    /// Draw a plane of water at a height in metres
    #[arg(long, value_name = "HEIGHT", allow_hyphen_values = true, conflicts_with = "map")]
    water: Option<f32>,
    /// For --mode contours: metres from line to line [default: about 25 lines]
    #[arg(long, value_name = "METRES", conflicts_with = "map")]
    contour: Option<f32>,
    /// How many pixels the ground may be off
    #[arg(long, value_name = "PIXELS", default_value_t = 2.0, conflicts_with = "map")]
    max_error: f64,
    /// By what that is measured
    #[arg(long, value_enum, default_value_t = MetricName::Roughness, conflicts_with = "map")]
    metric: MetricName,
}

/// What is shown of the ground.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum ModeName {
    /// Materials in the light of sun and sky
    Textured,
    /// One plain material
    Shaded,
    /// The triangles
    Wireframe,
    /// How steep it is
    Slope,
    /// Which way it falls
    Aspect,
    /// Bands of colour by height
    HeightBands,
    /// Lines of equal height
    Contours,
    /// Normals as colours: east, north, up
    Normals,
    /// How finely each tile is drawn
    Details,
    /// A mask over the ground: see --mask
    Mask,
    /// By how much it is higher, red, or lower, blue, than it was: see --since and --range
    Difference,
}

impl From<ModeName> for Mode {
    fn from(name: ModeName) -> Self {
        match name {
            ModeName::Textured => Self::Textured,
            ModeName::Shaded => Self::Shaded,
            ModeName::Wireframe => Self::Wireframe,
            ModeName::Slope => Self::Slope,
            ModeName::Aspect => Self::Aspect,
            ModeName::HeightBands => Self::HeightBands,
            ModeName::Contours => Self::Contours,
            ModeName::Normals => Self::Normals,
            ModeName::Details => Self::Details,
            ModeName::Mask => Self::Overlay,
            ModeName::Difference => Self::Difference,
        }
    }
}

/// By what the ground's error is measured.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum MetricName {
    /// How high what is left out may be
    Roughness,
    /// How far apart vertices are
    FromAbove,
}

impl Arguments {
    /// What it is compared with, where that is to be shown.
    pub(super) fn past(&self, session: &Session) -> anyhow::Result<Option<Terrain>> {
        let since = self.view.since.filter(|_| matches!(self.view.mode, ModeName::Difference));
        since.map(|entry| session.open_to_read_at(&self.terrain, EntryId(entry))).transpose()
    }

    /// What is asked for, from the eye on.
    pub(super) fn request(&self) -> ViewRequest {
        let view = &self.view;
        let default = ViewRequest::default();
        ViewRequest {
            size_px: self.size.unwrap_or(default.size_px),
            eye: view.eye,
            target: view.target,
            fov_degrees: view.fov,
            mode: view.mode.into(),
            mask: view.mask.clone(),
            materials: Materials::from_name(&view.materials),
            sun_azimuth_degrees: view.sun[0],
            sun_altitude_degrees: view.sun[1],
            haze: view.haze,
            slope_exaggeration: view.exaggerate,
            exposure_stops: view.exposure,
            has_shadows: !view.no_shadows,
            cursors: view.cursor.clone(),
            water_level_m: view.water,
            range_m: self.range.map(|range_m| range_m.map(|height_m| height_m as f32)),
            contour_m: view.contour,
            max_error_px: view.max_error,
            metric: match view.metric {
                MetricName::Roughness => Metric::Roughness,
                MetricName::FromAbove => Metric::FromAbove,
            },
        }
    }
}

/// What a picture was drawn from, for programs.
#[derive(Debug, Serialize)]
pub(super) struct Seen {
    eye_m: [f64; 3],
    target_m: [f64; 3],
    tiles: u32,
    triangles: u64,
    draw_calls: u32,
    pages: u32,
    missing_pages: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    difference_m: Option<f32>,
}

impl From<&Drawn> for Seen {
    fn from(drawn: &Drawn) -> Self {
        let FrameReport { num_tiles, num_triangles, num_draw_calls, num_pages, num_missing } = drawn.report;
        Self {
            eye_m: drawn.eye_m,
            target_m: drawn.target_m,
            tiles: num_tiles,
            triangles: num_triangles,
            draw_calls: num_draw_calls,
            pages: num_pages,
            missing_pages: num_missing,
            difference_m: drawn.difference_m,
        }
    }
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    file: String,
    width_px: u32,
    height_px: u32,
    adapter: String,
    #[serde(flatten)]
    seen: Seen,
    notices: Vec<String>,
    elapsed_s: f64,
}

/// Draws the picture.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let request = arguments.request();
    let terrain = session.open_to_read(&arguments.terrain)?;
    let past = arguments.past(session)?;
    let mut view = terrain.view(request.size_px)?;
    past.iter().try_for_each(|past| view.compare_with(past))?;
    let drawn = view.draw(&request, &mut ProgressWatch::new())?;
    drawn.picture.write(&arguments.file)?;
    let adapter = view.adapter().to_string();
    drop(view);
    terrain.close()?;
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        file: text_of(&arguments.file),
        width_px: drawn.picture.width_px,
        height_px: drawn.picture.height_px,
        adapter,
        seen: Seen::from(&drawn),
        notices: drawn.notices,
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, width_px, height_px, adapter, seen, elapsed_s, .. } = self;
        write_notices(f, &self.notices)?;
        writeln!(f, "drew {file}: {width_px} x {height_px} pixels, in {elapsed_s:.2} s on {adapter}")?;
        let [[eye_x, eye_y, eye_z], [x, y, z]] = [seen.eye_m, seen.target_m];
        writeln!(
            f,
            "  from {eye_x:.1},{eye_y:.1},{eye_z:.1} towards {x:.1},{y:.1},{z:.1}: {} triangles of {} tiles in {} draw calls, {} pages",
            seen.triangles, seen.tiles, seen.draw_calls, seen.pages
        )?;
        if let Some(difference_m) = seen.difference_m {
            writeln!(f, "  red: {difference_m:.3} m higher than it was, blue: as much lower")?;
        }
        if seen.missing_pages > 0 {
            writeln!(
                f,
                "  {} pages had no room in the page budget: the ground is coarser there",
                seen.missing_pages
            )?;
        }
        Ok(())
    }
}
