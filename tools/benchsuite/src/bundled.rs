//! The terrain that comes with the program, as real ground.

use std::path::Path;

use anyhow::Result;
use orogeny_engine::{Adapter, ImportOptions, ImportRequest, Quiet, Settings, Terrain};

/// Its raster of 1024 x 1024 heights.
pub const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/terrain/frazier_1024_int16.tif");
/// Samples a side.
pub const SIDE: u64 = 1024;
/// Metres between samples.
pub const SPACING_M: f64 = 28.0;

/// A new terrain of it, through the CPU back end.
pub fn terrain(path: &Path) -> Result<Terrain> {
    let options = ImportOptions { spacing_m: Some(SPACING_M), ..ImportOptions::default() };
    let request = ImportRequest { file: FILE.into(), options, layer: None, at_m: [0.0, 0.0] };
    let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    Ok(Terrain::from_raster(path, &request, settings, &mut Quiet)?.0)
}
