//! `export`: from a terrain to a file of another program.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use clap::{ArgGroup, Args};
use orogeny_engine::{ExportOptions, ExportRequest, ExportSize, ExportSource, LayerReference};
use serde::Serialize;

use crate::output::{text_of, write_notices};
use crate::progress::ProgressWatch;
use crate::session::Session;
use crate::values::{self, Fitting, Order, Sample};

/// What `export` takes.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("samples").args(["preset", "size"]).multiple(true)))]
pub struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// PNG, .r16, .raw, .r32, TIFF, HGT or NPY
    file: PathBuf,
    /// A region in metres; its far edges are outside [default: all]
    #[arg(long, value_name = "X,Z,W,D", value_parser = values::region, allow_hyphen_values = true)]
    region: Option<[f64; 4]>,
    /// A coarser level, with a sample for two each way; 0 is full resolution
    #[arg(long, value_name = "K", default_value_t = 0)]
    level: u8,
    /// One layer alone, by its name or `#ID`, as it is made, whether it shows or not [default: what all of them come to]
    #[arg(long, value_name = "LAYER", value_parser = values::layer)]
    layer: Option<LayerReference>,
    /// How much a layer counts where, 0 to 1, by its mask and those of its groups
    #[arg(long, value_name = "LAYER", value_parser = values::layer, conflicts_with = "layer")]
    mask: Option<LayerReference>,
    /// How much is selected where, 0 to 1
    #[arg(long, conflicts_with_all = ["layer", "mask"])]
    selection: bool,
    /// Heights in metres that become the samples 0 and 65535 (or 255) of a PNG, .r16 or .raw; kept in a .json beside it
    #[arg(long, value_name = "LO,HI", value_parser = values::range, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
    /// How a sample is held: u8 or u16 in a PNG, any in a .raw
    #[arg(long)]
    sample: Option<Sample>,
    /// Which byte of a sample comes first in a .raw, .r16 or .r32 [default: little]
    #[arg(long)]
    byte_order: Option<Order>,
    /// As a program wants it, by the name of a preset, as "Unreal R16", for a file of its ending; the options beside it count more
    #[arg(long, value_name = "NAME")]
    preset: Option<String>,
    /// So many samples, as 1009x1009 [default: as many as there are, or what the preset takes]
    #[arg(long, value_name = "WxD", value_parser = values::size::<u32>)]
    size: Option<[u32; 2]>,
    /// How another number of samples, that of --size or of --preset, comes about [default: resample, or what the preset says]
    #[arg(long, requires = "samples")]
    fit: Option<Fitting>,
    /// The southern row first
    #[arg(long)]
    south_first: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    file: String,
    width: u32,
    depth: u32,
    notices: Vec<String>,
    /// What has to be typed in the program that the preset is for.
    advice: Vec<String>,
    elapsed_s: f64,
}

/// Exports the heights.
///
/// # Errors
/// When they do not fit the format, or the file cannot be written; it is then as it was.
pub fn run(arguments: Arguments, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let terrain = session.open_to_read(&arguments.terrain)?;
    let preset = match &arguments.preset {
        Some(name) => Some(session.export_presets().get(name)?.clone()),
        None => None,
    };
    let mut request = ExportRequest {
        file: arguments.file,
        options: ExportOptions {
            sample: arguments.sample.map(Into::into),
            byte_order: arguments.byte_order.map(Into::into),
            range_m: arguments.range.map(Into::into),
            ..ExportOptions::default()
        },
        source: match (arguments.layer, arguments.mask, arguments.selection) {
            (Some(layer), ..) => ExportSource::Layer(layer),
            (_, Some(layer), _) => ExportSource::Mask(layer),
            (.., true) => ExportSource::Selection,
            _ => ExportSource::Composite,
        },
        region_m: arguments.region,
        level: arguments.level,
        is_south_first: arguments.south_first,
        ..ExportRequest::new("")
    };
    let fit = arguments.fit.map(Into::into);
    request.size =
        arguments.size.map(|[width, depth]| ExportSize { width, depth, fit: fit.unwrap_or_default() });
    let mut advice = Vec::new();
    if let Some(preset) = preset {
        let planned = terrain.take_preset(&mut request, &preset, fit)?;
        advice = preset.program.advice(&planned);
    }
    let summary = terrain.export(&request, &mut ProgressWatch::new())?;
    terrain.close()?;
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        file: text_of(&summary.file),
        width: summary.width,
        depth: summary.depth,
        notices: summary.notices,
        advice,
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, width, depth, elapsed_s, .. } = self;
        write_notices(f, &self.notices)?;
        writeln!(f, "wrote {file}: {width} x {depth} samples, in {elapsed_s:.2} s")?;
        self.advice.iter().try_for_each(|line| writeln!(f, "  {line}"))
    }
}
