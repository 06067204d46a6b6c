//! `info`: what a terrain is.

use std::fmt;
use std::path::PathBuf;

use clap::Args;
use indicatif::HumanBytes;
use orogeny_engine::{Description, HeightStatistics, LayerDescription};
use serde::Serialize;

use crate::commands::layer::notes;
use crate::output::{count, memory_line, text_of};
use crate::progress::ProgressWatch;
use crate::session::Session;

/// What `info` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The terrain
    terrain: PathBuf,
    /// Also the lowest, highest and mean height, for which the whole terrain is read
    #[arg(long)]
    heights: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    #[serde(flatten)]
    description: Description,
    #[serde(skip_serializing_if = "Option::is_none")]
    heights: Option<HeightStatistics>,
}

/// Describes the terrain.
///
/// # Errors
/// When it cannot be read.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let terrain = session.open_to_read(&arguments.terrain)?;
    let description = terrain.describe()?;
    let heights = match arguments.heights {
        true => Some(terrain.height_statistics(&mut ProgressWatch::new())?),
        false => None,
    };
    terrain.close()?;
    session.output().report(&Report { terrain: text_of(&arguments.terrain), description, heights })
}

/// A layer in a line.
fn layer_line(layer: &LayerDescription, layers: &[LayerDescription], page_size: u32) -> String {
    let pages = count(layer.num_pages, "page");
    let mut line = format!("{} `{}`: ", layer.id, layer.name);
    line.push_str(&match (layer.content, layer.brush) {
        ("heights", _) => {
            format!("{pages} of {page_size} x {page_size}, elsewhere {} m", layer.constant_m)
        }
        (content, Some(brush)) => format!("{content} `{brush}`"),
        (content, None) => content.to_owned(),
    });
    line.push_str(&format!(", {}, opacity {}", layer.blend.name(), layer.opacity));
    for note in notes(layer, layers) {
        line.push_str(&format!(", {note}"));
    }
    line
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Description { width, depth, spacing_m, width_m, depth_m, page_size, layers, history, .. } =
            &self.description;
        writeln!(f, "{}", self.terrain)?;
        writeln!(
            f,
            "size     {width} x {depth} samples, one every {spacing_m} m: {width_m:.0} x {depth_m:.0} m"
        )?;
        let Description { file_size_in_bytes, num_commits, num_levels_above, .. } = &self.description;
        let commits = count(*num_commits, "commit");
        let levels = count((*num_levels_above).into(), "coarser level");
        writeln!(f, "file     {}, {commits}, {levels}", HumanBytes(*file_size_in_bytes))?;
        for layer in layers {
            writeln!(f, "layer    {}", layer_line(layer, layers, *page_size))?;
        }
        let budget = match history.budget_in_bytes {
            Some(budget) => format!("of at most {}", HumanBytes(budget)),
            None => "no limit".to_owned(),
        };
        writeln!(
            f,
            "history  {} applied, {} undone, {} left behind, {}, {budget}",
            history.num_applied,
            history.num_undone,
            history.num_branch,
            HumanBytes(history.size_in_bytes)
        )?;
        writeln!(f, "memory   {}", memory_line(&self.description.memory))?;
        match &self.heights {
            Some(heights) => {
                writeln!(f, "heights  {} to {} m, mean {:.3} m", heights.min_m, heights.max_m, heights.mean_m)
            }
            None => Ok(()),
        }
    }
}
