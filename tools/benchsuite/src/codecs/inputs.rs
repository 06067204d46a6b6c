//! What is compressed.

use std::path::PathBuf;

use anyhow::{Context as _, Result};
use orogeny_field::Brush;
use orogeny_store::codec;

use super::candidates::Delta;
use crate::ground::{self, Change, Sampling};
use crate::report::Report;

/// The folder with more terrains.
const DATA_VARIABLE: &str = "OROGENY_DATA";
/// Pages taken of one raster, spread over it.
const MAX_PAGES_OF_A_RASTER: usize = 16;

/// Pages, or changes of pages.
pub struct Input {
    pub name: &'static str,
    pages: Pages,
}

enum Pages {
    Content(Vec<Vec<u32>>),
    Changes(Vec<Change>),
}

pub fn all(report: &mut Report) -> Result<Vec<Input>> {
    let content = |name, pages| Input { name, pages: Pages::Content(pages) };
    let mut inputs = vec![
        strokes("smooth stroke", ground::raise())?,
        strokes("noisy stroke", ground::roughen())?,
        content("whole metres", ground::bundled(Sampling::AsTheyAre)?.ordered()),
        content("resampled", ground::bundled(Sampling::AsImported)?.ordered()),
    ];
    if let Some(folder) = std::env::var_os(DATA_VARIABLE) {
        inputs.push(content("other terrains", rasters_in(folder.into(), report)?));
    }
    Ok(inputs)
}

/// Two strokes, each on the untouched terrain.
fn strokes(name: &'static str, brush: Brush) -> Result<Input> {
    let ground = ground::bundled(Sampling::AsTheyAre)?;
    let mut changes = Vec::new();
    for seed in 0..2 {
        let painted = ground.paint(std::slice::from_ref(&brush), seed)?;
        changes.extend(painted.into_iter().flatten().map(|(_, change)| change));
    }
    Ok(Input { name, pages: Pages::Changes(changes) })
}

/// Pages of every raster in a folder that can be read and holds one, as they are.
fn rasters_in(folder: PathBuf, report: &mut Report) -> Result<Vec<Vec<u32>>> {
    let mut paths = std::fs::read_dir(&folder)
        .with_context(|| format!("`{}`, which {DATA_VARIABLE} names, cannot be read", folder.display()))?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<Vec<_>>>()?;
    paths.sort();
    let mut pages = Vec::new();
    for path in paths {
        let Ok(ground) = ground::read(&path, Sampling::AsTheyAre) else { continue };
        let ordered = ground.ordered();
        let step = ordered.len().div_ceil(MAX_PAGES_OF_A_RASTER).max(1);
        let chosen: Vec<_> = ordered.into_iter().step_by(step).collect();
        let name = path.file_name().unwrap_or_default().display();
        report.note(format!("other terrains: {} pages of {name}", chosen.len()));
        pages.extend(chosen);
    }
    Ok(pages)
}

impl Input {
    pub fn num_pages(&self) -> usize {
        match &self.pages {
            Pages::Content(pages) => pages.len(),
            Pages::Changes(changes) => changes.len(),
        }
    }

    /// What it is, for people.
    pub fn description(&self) -> String {
        let num_pages = self.num_pages();
        match &self.pages {
            Pages::Content(_) => format!("{num_pages} pages"),
            Pages::Changes(changes) => {
                let differing = |change: &Change| {
                    change.before.iter().zip(&change.after).filter(|(before, after)| before != after).count()
                };
                let num_changed: usize = changes.iter().map(differing).sum();
                let num_samples: usize = changes.iter().map(|change| change.after.len()).sum();
                let percent = 100.0 * num_changed as f64 / num_samples as f64;
                format!("{num_pages} pages, {percent:.0} % of their samples changed")
            }
        }
    }

    /// The values that a candidate gets: contents as they are, changes as their delta.
    pub fn values(&self, delta: Delta) -> Vec<Vec<u32>> {
        let bits = |ordered: &[u32]| ordered.iter().map(|&value| codec::bits_from_ordered(value)).collect();
        match (&self.pages, delta) {
            (Pages::Content(pages), Delta::Ordered) => pages.clone(),
            (Pages::Content(pages), Delta::Xor) => pages.iter().map(|page| bits(page)).collect(),
            (Pages::Changes(changes), Delta::Ordered) => {
                changes.iter().map(|change| codec::difference(&change.after, Some(&change.before))).collect()
            }
            (Pages::Changes(changes), Delta::Xor) => changes
                .iter()
                .map(|change| {
                    let [before, after]: [Vec<u32>; 2] =
                        [&change.before, &change.after].map(|side| bits(side));
                    before.iter().zip(after).map(|(before, after)| before ^ after).collect()
                })
                .collect(),
        }
    }
}
