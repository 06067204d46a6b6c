//! What all subcommands that change the stack share: one operation is run, and reported.

use std::fmt;
use std::path::Path;

use orogeny_engine::{
    Applied, Dropped, Error, LayerOperation, LayerReference, MemoryUse, Operation, Terrain,
};
use serde::Serialize;

use crate::output::{count, dropped_line, text_of, write_notices};
use crate::progress::ProgressWatch;
use crate::session::Session;

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    #[serde(skip)]
    did: &'static str,
    /// The layer that was changed, or made, by its id.
    layer: u32,
    name: String,
    #[serde(flatten)]
    applied: Applied,
    /// What went from the history.
    dropped: Dropped,
    memory: MemoryUse,
}

/// Opens a terrain, runs an operation on it, and reports it as what was `did`.
///
/// # Errors
/// When the operation fails, or is cancelled; the terrain is then as it was.
pub(super) fn run(
    path: &Path,
    operation: LayerOperation,
    did: &'static str,
    session: &Session,
) -> anyhow::Result<()> {
    run_on(session.open(path)?, path, operation, did, session)
}

/// As [`run`], on a terrain that is open.
///
/// # Errors
/// As [`run`].
pub(super) fn run_on(
    mut terrain: Terrain,
    path: &Path,
    operation: LayerOperation,
    did: &'static str,
    session: &Session,
) -> anyhow::Result<()> {
    let named = match operation.layer() {
        Some(layer) => {
            let layer = terrain.layer(Some(layer))?;
            Some((layer.id, layer.name.clone()))
        }
        None => None,
    };
    let mut watch = ProgressWatch::new();
    let applied = terrain.apply(&[Operation::Layers(operation)], &mut watch).map_err(|err| match err {
        // Of one alone its number says nothing.
        Error::InRecipe { source, .. } => *source,
        other => other,
    })?;
    drop(watch);
    let applied = applied.into_iter().next().ok_or_else(|| anyhow::anyhow!("nothing was done"))?;
    let (id, name_before) = named.unwrap_or_default();
    let id = applied.made_layer.unwrap_or(id);
    // One that was removed is told by the name that it had.
    let name = terrain.layer(Some(&LayerReference::Id(id))).map_or(name_before, |layer| layer.name.clone());
    let (dropped, memory) = (terrain.take_dropped_history()?, terrain.memory());
    terrain.close()?;
    session.output().report(&Report {
        terrain: text_of(path),
        did,
        layer: id,
        name,
        applied,
        dropped,
        memory,
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_notices(f, dropped_line(&self.dropped).as_slice())?;
        let Self { terrain, did, layer, name, applied, .. } = self;
        let pages = match applied.num_pages as u64 {
            0 => String::new(),
            number => format!(", {}", count(number, "page")),
        };
        writeln!(f, "{terrain}: {did} layer {layer} `{name}`{pages}, in {:.3} s", applied.elapsed_s)
    }
}
