//! `render --fly`: numbered pictures along a way.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context as _;
use orogeny_engine::Flight;
use serde::Serialize;

use super::Arguments;
use super::view::Seen;
use crate::output::text_of;
use crate::progress::ProgressWatch;
use crate::session::Session;

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    files: Vec<String>,
    width_px: u32,
    height_px: u32,
    frames: Vec<Seen>,
    elapsed_s: f64,
}

/// Draws the pictures.
pub(super) fn run(arguments: &Arguments, path: &Path, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let text =
        std::fs::read_to_string(path).with_context(|| format!("`{}` cannot be read", path.display()))?;
    let flight = Flight::from_json(&text).with_context(|| format!("`{}`", path.display()))?;
    let request = arguments.request();
    let terrain = session.open_to_read(&arguments.terrain)?;
    let past = arguments.past(session)?;
    let mut view = terrain.view(request.size_px)?;
    past.iter().try_for_each(|past| view.compare_with(past))?;
    let (mut files, mut frames) = (Vec::new(), Vec::new());
    let mut watch = ProgressWatch::new();
    for (number, request) in (1..).zip(flight.frames(&request)) {
        let drawn = view.draw(&request, &mut watch)?;
        let file = numbered(&arguments.file, number);
        drawn.picture.write(&file)?;
        files.push(text_of(&file));
        frames.push(Seen::from(&drawn));
    }
    drop(view);
    terrain.close()?;
    let [width_px, height_px] = request.size_px;
    let elapsed_s = start.elapsed().as_secs_f64();
    let terrain = text_of(&arguments.terrain);
    session.output().report(&Report { terrain, files, width_px, height_px, frames, elapsed_s })
}

/// `out.png` as `out-0001.png`.
fn numbered(file: &Path, number: u32) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let extension = file.extension().map(|extension| extension.to_string_lossy());
    let extension = extension.as_deref().unwrap_or("png");
    file.with_file_name(format!("{stem}-{number:04}.{extension}"))
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { files, width_px, height_px, elapsed_s, .. } = self;
        let (first, last) =
            (files.first().map_or("", String::as_str), files.last().map_or("", String::as_str));
        let num = files.len();
        writeln!(
            f,
            "drew {num} pictures of {width_px} x {height_px} pixels, {first} to {last}, in {elapsed_s:.2} s"
        )
    }
}
