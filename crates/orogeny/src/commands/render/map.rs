//! `render --map`: a shaded map from above.

use std::fmt;
use std::time::Instant;

use orogeny_engine::MapRequest;
use serde::Serialize;

use super::Arguments;
use crate::output::{text_of, write_notices};
use crate::progress::ProgressWatch;
use crate::session::Session;

const DEFAULT_SIZE_PX: [u32; 2] = [1024, 1024];

#[derive(Debug, Serialize)]
struct Report {
    terrain: String,
    file: String,
    width_px: u32,
    height_px: u32,
    samples_per_px: u32,
    range_m: [f32; 2],
    level: u8,
    notices: Vec<String>,
    elapsed_s: f64,
}

/// Draws the map.
///
/// # Errors
/// When the file cannot be written, or the region lies outside.
pub(super) fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let request = MapRequest {
        file: arguments.file.clone(),
        region_m: arguments.region,
        size_px: arguments.size.unwrap_or(DEFAULT_SIZE_PX),
        range_m: arguments.range.map(|range_m| range_m.map(|height_m| height_m as f32)),
    };
    let terrain = session.open_to_read(&arguments.terrain)?;
    let summary = terrain.draw_map(&request, &mut ProgressWatch::new())?;
    terrain.close()?;
    session.output().report(&Report {
        terrain: text_of(&arguments.terrain),
        file: text_of(&summary.file),
        width_px: summary.width_px,
        height_px: summary.height_px,
        samples_per_px: summary.samples_per_px,
        range_m: summary.range_m,
        level: summary.level,
        notices: summary.notices,
        elapsed_s: start.elapsed().as_secs_f64(),
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, width_px, height_px, samples_per_px, range_m: [low_m, high_m], elapsed_s, .. } =
            self;
        let scale = match samples_per_px {
            1 => "a pixel a sample".to_owned(),
            side => format!("a pixel for {side} x {side} samples"),
        };
        write_notices(f, &self.notices)?;
        writeln!(
            f,
            "drew {file}: {width_px} x {height_px} pixels, {scale}, tinted from {low_m} to {high_m} m, in {elapsed_s:.2} s"
        )
    }
}
