//! `presets thumbnail` and `presets --gallery`: pictures.

use std::fmt;
use std::path::Path;
use std::time::Instant;

use orogeny_engine::presets::Gallery;
use serde::Serialize;

use crate::output::{count, text_of, write_notices};
use crate::progress::ProgressWatch;
use crate::session::Session;

#[derive(Debug, Serialize)]
struct Report {
    file: String,
    num_presets: u64,
    width_px: u32,
    height_px: u32,
    notices: Vec<String>,
    elapsed_s: f64,
}

/// Draws one preset.
///
/// # Errors
/// When there is none of that name, or the picture cannot be drawn or written.
pub(super) fn draw_thumbnail(name: &str, file: &Path, size_px: u32, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let picture = session.presets().get(name)?.preset.draw_thumbnail(size_px)?;
    picture.write(file)?;
    session.output().report(&Report {
        file: text_of(file),
        num_presets: 1,
        width_px: picture.width_px,
        height_px: picture.height_px,
        notices: Vec::new(),
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

/// Draws all presets.
///
/// # Errors
/// When the picture cannot be drawn or written.
pub(super) fn draw_gallery(file: &Path, cell_px: u32, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let presets = session.presets();
    let Gallery { picture, notices: undrawn } = presets.draw_gallery(cell_px, &mut ProgressWatch::new())?;
    picture.write_small(file)?;
    session.output().report(&Report {
        file: text_of(file),
        num_presets: presets.iter().count() as u64,
        width_px: picture.width_px,
        height_px: picture.height_px,
        notices: presets.unusable().map(ToString::to_string).chain(undrawn).collect(),
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, num_presets, width_px, height_px, notices, elapsed_s } = self;
        write_notices(f, notices)?;
        let presets = count(*num_presets, "preset");
        writeln!(f, "drew {file}: {presets}, {width_px} x {height_px} pixels, in {elapsed_s:.2} s")
    }
}
