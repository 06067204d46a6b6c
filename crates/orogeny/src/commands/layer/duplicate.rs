//! `layer duplicate`: copies a layer.

use std::path::PathBuf;

use orogeny_engine::{DuplicateLayer, LayerOperation, LayerReference};

use super::done;
use crate::session::Session;
use crate::values;

/// What `layer duplicate` takes.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// The layer, by its name or `#ID`
    #[arg(value_parser = values::layer)]
    layer: LayerReference,
    /// What the copy is called [default: as the layer, with `copy` after it]
    #[arg(long)]
    name: Option<String>,
}

/// Copies the layer.
///
/// # Errors
/// When it is not there, is a group, or another one has the name; nothing was changed then.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let (layer, name) = (arguments.layer.clone(), arguments.name.clone());
    let operation = LayerOperation::DuplicateLayer(DuplicateLayer { layer, name, id: None });
    done::run(&arguments.terrain, operation, "made a copy,", session)
}
