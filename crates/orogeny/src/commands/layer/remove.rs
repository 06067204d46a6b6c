//! `layer remove`: takes a layer out of the stack.

use std::path::PathBuf;

use orogeny_engine::{LayerOperation, LayerReference, RemoveLayer};

use super::done;
use crate::session::Session;
use crate::values;

/// What `layer remove` takes.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// The layer, by its name or `#ID`
    #[arg(value_parser = values::layer)]
    layer: LayerReference,
    /// Of a group: its layers too
    #[arg(long)]
    members: bool,
}

/// Removes the layer.
///
/// # Errors
/// When it is not there, is locked, is the last one, or another one's mask looks at it; nothing was changed then.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let (layer, members) = (arguments.layer.clone(), arguments.members);
    let operation = LayerOperation::RemoveLayer(RemoveLayer { layer, members });
    done::run(&arguments.terrain, operation, "removed", session)
}
