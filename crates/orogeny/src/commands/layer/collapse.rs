//! `layer collapse`: bakes what a layer shows.

use std::path::PathBuf;

use orogeny_engine::{CollapseLayer, LayerOperation, LayerReference};

use super::done;
use crate::session::Session;
use crate::values;

/// What `layer collapse` takes.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// The layer, by its name or `#ID`
    #[arg(value_parser = values::layer)]
    layer: LayerReference,
    /// All that is below goes into it too: it is the only one of them then, and shows what they came to
    #[arg(long)]
    below: bool,
}

/// Bakes the layer.
///
/// # Errors
/// When it is not there, is locked, or there is nothing to bake; nothing was changed then.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let (layer, below) = (arguments.layer.clone(), arguments.below);
    let operation = LayerOperation::CollapseLayer(CollapseLayer { layer, below });
    done::run(&arguments.terrain, operation, "collapsed", session)
}
