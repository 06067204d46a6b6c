//! `render`: a picture of a terrain, as it is seen from somewhere or as a map.

mod fly;
mod map;
mod view;

use std::path::PathBuf;

use clap::Args;

use self::view::ViewArguments;
use crate::session::Session;
use crate::values;

/// What `render` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// The PNG to write; with --fly, of the first frame OUT-0001.png for OUT.png
    file: PathBuf,
    /// Pixels: of the picture, or for --map those that it fits into [default: 1280x720, for --map 1024x1024]
    #[arg(long, value_name = "WxH", value_parser = values::size::<u32>)]
    size: Option<[u32; 2]>,
    /// Heights in metres of the first and the last colour [default: the lowest and the highest there are]; for --mode difference, differences:
    /// the larger one, up or down, is fully red, or fully blue [default: the largest that is looked at]
    #[arg(long, value_name = "LO,HI", value_parser = values::range, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
    /// A shaded map from above, tinted by height; needs no adapter that could draw
    #[arg(long)]
    map: bool,
    /// For --map: a region in metres; its far edges are outside [default: all]
    #[arg(long, value_name = "X,Z,W,D", value_parser = values::region, allow_hyphen_values = true, requires = "map")]
    region: Option<[f64; 4]>,
    #[command(flatten)]
    view: ViewArguments,
    /// Draw numbered pictures along the way that a JSON file describes
    #[arg(long, value_name = "PATH.json", conflicts_with_all = ["map", "eye", "target"])]
    fly: Option<PathBuf>,
}

/// Draws the picture.
///
/// # Errors
/// When the file cannot be written, the region lies outside, or there is nothing that could draw.
pub fn run(arguments: Arguments, session: &Session) -> anyhow::Result<()> {
    if arguments.map {
        return map::run(&arguments, session);
    }
    match &arguments.fly {
        Some(path) => fly::run(&arguments, path, session),
        None => view::run(&arguments, session),
    }
}
