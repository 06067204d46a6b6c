//! `layer refresh`: works out anew an effect that is kept, or a mask that a brush made.

use std::path::PathBuf;

use orogeny_engine::{LayerOperation, LayerReference, RefreshLayer};

use super::done;
use crate::session::Session;
use crate::values;

/// What `layer refresh` takes.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// The layer, by its name or `#ID`
    #[arg(value_parser = values::layer)]
    layer: LayerReference,
}

/// Works it out.
///
/// # Errors
/// When the layer is not there, is locked, or has neither; nothing was changed then.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let operation = LayerOperation::RefreshLayer(RefreshLayer { layer: arguments.layer.clone() });
    done::run(&arguments.terrain, operation, "worked out", session)
}
