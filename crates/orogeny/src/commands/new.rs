//! `new`: a flat terrain.

use std::fmt;
use std::path::PathBuf;

use clap::Args;
use orogeny_engine::{Terrain, TerrainGrid};
use serde::Serialize;

use crate::output::text_of;
use crate::session::Session;
use crate::values;

/// What `new` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain to make
    terrain: PathBuf,
    /// Samples along x and z, up to 1048576 each
    #[arg(long, value_name = "WxD", value_parser = values::size::<u64>)]
    size: [u64; 2],
    /// Metres between samples
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    spacing: f64,
    /// Height everywhere, in metres
    #[arg(long, value_name = "METRES", default_value_t = 0.0, allow_negative_numbers = true)]
    height: f32,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    width: u32,
    depth: u32,
    spacing_m: f64,
    height_m: f32,
}

/// Makes the terrain.
///
/// # Errors
/// When there is a file already, or a value is out of range.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let [width, depth] = arguments.size;
    let grid = TerrainGrid::new(width, depth, arguments.spacing)?;
    Terrain::create(&arguments.terrain, grid, arguments.height, session.settings())?.close()?;
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        width: grid.width(),
        depth: grid.depth(),
        spacing_m: grid.spacing_m(),
        height_m: arguments.height,
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { terrain, width, depth, spacing_m, height_m } = self;
        writeln!(f, "made {terrain}: {width} x {depth} samples, one every {spacing_m} m, at {height_m} m")
    }
}
