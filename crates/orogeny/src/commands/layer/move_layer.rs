//! `layer move`: moves a layer within the stack.

use std::path::PathBuf;

use orogeny_engine::{LayerOperation, LayerReference, MoveLayer};

use super::done;
use crate::session::Session;
use crate::values;

/// What `layer move` takes.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// The layer, by its name or `#ID`
    #[arg(value_parser = values::layer)]
    layer: LayerReference,
    #[command(flatten)]
    place: Place,
    /// The group that it is in then [default: none]
    #[arg(long = "in", value_name = "GROUP", value_parser = values::layer)]
    within: Option<LayerReference>,
}

#[derive(Debug, clap::Args)]
#[group(required = true, multiple = false)]
struct Place {
    /// The layer that it comes to lie on
    #[arg(long, value_name = "LAYER", value_parser = values::layer)]
    above: Option<LayerReference>,
    /// It becomes the lowest
    #[arg(long)]
    bottom: bool,
}

/// Moves the layer.
///
/// # Errors
/// When it is not there, or cannot lie there; nothing was changed then.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let operation = LayerOperation::MoveLayer(MoveLayer {
        layer: arguments.layer.clone(),
        above: arguments.place.above.clone(),
        group: arguments.within.clone(),
    });
    done::run(&arguments.terrain, operation, "moved", session)
}
