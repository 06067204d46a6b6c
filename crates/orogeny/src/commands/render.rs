//! `render`: a picture of a terrain.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::ensure;
use clap::Args;
use orogeny_engine::MapRequest;
use serde::Serialize;

use crate::arguments::WrongUse;
use crate::output::{text_of, write_notices};
use crate::progress::ProgressWatch;
use crate::session::Session;
use crate::values;

/// What `render` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// The PNG to write
    file: PathBuf,
    /// A shaded map from above, tinted by height; this version draws no other picture
    #[arg(long)]
    map: bool,
    /// A region in metres; its far edges are outside [default: all]
    #[arg(long, value_name = "X,Z,W,D", value_parser = values::region, allow_hyphen_values = true)]
    region: Option<[f64; 4]>,
    /// Pixels that the picture fits into
    #[arg(long, value_name = "WxH", default_value = "1024x1024", value_parser = values::size::<u32>)]
    size: [u32; 2],
    /// Heights in metres of the first and the last tint [default: the lowest and the highest drawn]
    #[arg(long, value_name = "LO,HI", value_parser = values::range, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    file: String,
    width_px: u32,
    height_px: u32,
    samples_per_px: u32,
    range_m: [f32; 2],
    level: u8,
    notices: Vec<String>,
    elapsed_s: f64,
}

/// Draws the picture.
///
/// # Errors
/// When the file cannot be written, or the region lies outside.
pub fn run(arguments: Arguments, session: &Session) -> anyhow::Result<()> {
    ensure!(arguments.map, WrongUse("this version draws only the map from above: give --map"));
    let start = Instant::now();
    let request = MapRequest {
        file: arguments.file,
        region_m: arguments.region,
        size_px: arguments.size,
        range_m: arguments.range.map(|range_m| range_m.map(|height_m| height_m as f32)),
    };
    let terrain = session.open_to_read(&arguments.terrain)?;
    let summary = terrain.draw_map(&request, &mut ProgressWatch::new())?;
    terrain.close()?;
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        file: text_of(&summary.file),
        width_px: summary.width_px,
        height_px: summary.height_px,
        samples_per_px: summary.samples_per_px,
        range_m: summary.range_m,
        level: summary.level,
        notices: summary.notices,
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, width_px, height_px, samples_per_px, range_m: [low_m, high_m], elapsed_s, .. } =
            self;
        let scale = match samples_per_px {
            1 => "a pixel a sample".to_owned(),
            side => format!("a pixel for {side} x {side} samples"),
        };
        write_notices(f, &self.notices)?;
        writeln!(
            f,
            "drew {file}: {width_px} x {height_px} pixels, {scale}, tinted from {low_m} to {high_m} m, in {elapsed_s:.2} s"
        )
    }
}
