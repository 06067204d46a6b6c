//! `import`: from a file of another program to a terrain.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::ensure;
use clap::Args;
use orogeny_engine::{EntryId, ImportOptions, ImportRequest, NodataPolicy, Terrain};
use serde::Serialize;

use crate::output::{dropped_line, text_of, write_notices};
use crate::progress::ProgressWatch;
use crate::session::Session;
use crate::values::{self, Mirror, Order, Sample};

/// What `import` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// PNG, .r16, .raw, .r32, TIFF, HGT (also zipped) or NPY
    file: PathBuf,
    /// The terrain, which is made where there is none
    terrain: PathBuf,
    /// The layer to write into, which is made where there is none of that name [default: the lowest]
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,
    /// Where the north-west sample goes in a terrain that is there, in metres [default: 0,0]
    #[arg(long, value_name = "X,Z", value_parser = values::place, allow_hyphen_values = true)]
    at: Option<[f64; 2]>,
    /// Heights in metres of the samples 0 and 65535 (or 255) of a PNG, .r16 or .raw; without it samples are metres
    #[arg(long, value_name = "LO,HI", value_parser = values::range, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
    /// Take the samples as they are, so many metres apart, whatever the file says
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    spacing: Option<f64>,
    /// Samples along x and z of a .raw; of an .r16 or .r32 that is not square
    #[arg(long, value_name = "WxD", value_parser = values::size::<u32>)]
    size: Option<[u32; 2]>,
    /// How a .raw holds a sample
    #[arg(long)]
    sample: Option<Sample>,
    /// Which byte of a sample comes first in a .raw, .r16 or .r32 [default: little]
    #[arg(long)]
    byte_order: Option<Order>,
    /// What becomes of samples without a height: `refuse` them, `fill` them from around, or a height in metres
    #[arg(long, value_name = "POLICY", default_value = "refuse", value_parser = values::nodata, allow_negative_numbers = true)]
    nodata: NodataPolicy,
    /// Turn it clockwise, as it is seen from above: 0, 90, 180 or 270
    #[arg(long, value_name = "DEGREES", default_value_t = 0, allow_negative_numbers = true)]
    rotate: u16,
    /// Mirror it, once it is turned
    #[arg(long)]
    flip: Option<Mirror>,
}

#[derive(Debug, Serialize)]
struct Report {
    file: String,
    terrain: String,
    made_terrain: bool,
    layer: String,
    made_layer: bool,
    entry: EntryId,
    width: u32,
    depth: u32,
    spacing_m: f64,
    notices: Vec<String>,
    elapsed_s: f64,
}

/// Imports the file.
///
/// # Errors
/// When the file cannot be read whole, or does not fit the terrain.
pub fn run(arguments: Arguments, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let path = arguments.terrain;
    let made_terrain = !path.try_exists()?;
    ensure!(
        !made_terrain || arguments.at.is_none(),
        "there is no terrain `{}`, and one that is made begins where the file does: leave out --at",
        path.display()
    );
    let request = ImportRequest {
        file: arguments.file,
        options: ImportOptions {
            size: arguments.size.map(Into::into),
            sample: arguments.sample.map(Into::into),
            byte_order: arguments.byte_order.map(Into::into),
            range_m: arguments.range.map(Into::into),
            nodata: arguments.nodata,
            spacing_m: arguments.spacing,
            rotate_degrees: arguments.rotate,
            flip: arguments.flip.map(Into::into).unwrap_or_default(),
            ..ImportOptions::default()
        },
        layer: arguments.layer,
        at_m: arguments.at.unwrap_or_default(),
    };
    let mut watch = ProgressWatch::new();
    let (mut terrain, mut summary) = if made_terrain {
        Terrain::from_raster(&path, &request, session.settings(), &mut watch)?
    } else {
        let mut terrain = session.open(&path)?;
        let summary = terrain.import(&request, &mut watch)?;
        (terrain, summary)
    };
    summary.notices.extend(dropped_line(&terrain.take_dropped_history()?));
    terrain.close()?;
    drop(watch);
    session.output().report(&Report {
        file: text_of(&request.file),
        terrain: text_of(&path),
        made_terrain,
        layer: summary.layer,
        made_layer: summary.made_layer,
        entry: summary.entry,
        width: summary.width,
        depth: summary.depth,
        spacing_m: summary.spacing_m,
        notices: summary.notices,
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, terrain, width, depth, spacing_m, layer, .. } = self;
        write_notices(f, &self.notices)?;
        let into = match (self.made_terrain, self.made_layer) {
            (true, _) => format!("a new terrain {terrain}"),
            (false, true) => format!("a new layer `{layer}` of {terrain}"),
            (false, false) => format!("the layer `{layer}` of {terrain}"),
        };
        writeln!(
            f,
            "imported {file} into {into}: {width} x {depth} samples, one every {spacing_m} m, in {:.2} s",
            self.elapsed_s
        )
    }
}
