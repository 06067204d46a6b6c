//! `layer list`: the stack.

use std::fmt;
use std::path::PathBuf;

use orogeny_engine::{LayerDescription, Procedure};
use serde::Serialize;

use super::words::notes;
use crate::output::{count, text_of};
use crate::session::Session;

/// What `layer list` takes.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The terrain
    terrain: PathBuf,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    /// From the top.
    layers: Vec<Line>,
}

#[derive(Debug, Serialize)]
struct Line {
    #[serde(flatten)]
    layer: LayerDescription,
    /// The brush that it is made by, with all that it was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    procedure: Option<Procedure>,
    #[serde(skip)]
    notes: String,
    /// How many groups it is in, one in the other.
    #[serde(skip)]
    depth: usize,
}

/// Lists the layers.
///
/// # Errors
/// When the terrain cannot be read.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let terrain = session.open_to_read(&arguments.terrain)?;
    let layers = terrain.describe()?.layers;
    let line = |layer: &LayerDescription| -> anyhow::Result<Line> {
        let made_of = terrain.layer(Some(&orogeny_engine::LayerReference::Id(layer.id)))?;
        Ok(Line {
            layer: layer.clone(),
            procedure: made_of.content.procedure().cloned(),
            notes: notes(layer, &layers).join(", "),
            depth: depth(layer, &layers),
        })
    };
    let lines = layers.iter().rev().map(line).collect::<anyhow::Result<_>>()?;
    terrain.close()?;
    session.output().report(&Report { terrain: text_of(&arguments.terrain), layers: lines })
}

fn depth(layer: &LayerDescription, layers: &[LayerDescription]) -> usize {
    let group_of = |layer: &&LayerDescription| layers.iter().find(|group| Some(group.id) == layer.group);
    // A ring, which only damage makes, ends there too.
    std::iter::successors(Some(layer), group_of).take(layers.len()).count().saturating_sub(1)
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = vec![["id", "layer", "made of", "blend", "opacity", ""].map(str::to_owned)];
        for Line { layer, notes, depth, .. } in &self.layers {
            let made_of = match (layer.content, layer.brush) {
                ("heights", _) => format!("heights, {}", count(layer.num_pages, "page")),
                (content, Some(brush)) => format!("{content} {brush}"),
                (content, None) => content.to_owned(),
            };
            rows.push([
                layer.id.to_string(),
                format!("{:depth$}{}", "", layer.name, depth = 2 * depth),
                made_of,
                layer.blend.name().to_owned(),
                layer.opacity.to_string(),
                notes.clone(),
            ]);
        }
        let width = |column: usize| {
            let cells = rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or_default()
        };
        let (id_width, name_width, made_width, blend_width) = (width(0), width(1), width(2), width(3));
        for [id, name, made_of, blend, opacity, notes] in &rows {
            let line = format!(
                "{id:>id_width$}  {name:<name_width$}  {made_of:<made_width$}  {blend:<blend_width$}  {opacity:<7}  {notes}"
            );
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}
