//! The layer stack: a stroke on the lowest, the middle and the uppermost of ten layers, until the composite under the brush is worked
//! out, beside the same stroke on a terrain of one layer.
//!
//! The ground is a real tile of 3601 x 3601 samples where `OROGENY_DATA` names a folder with one, else the bundled terrain of 1024 x
//! 1024. Strokes of all kinds take turns; each is painted and committed behind, and then what it changed is read, with all that
//! layers above make of it.

use std::path::{Path, PathBuf};

use anyhow::Result;
use orogeny_engine::{
    Adapter, ExportSource, ImportOptions, ImportRequest, NodataPolicy, Operation, Quiet, Settings, Terrain,
};
use tempfile::TempDir;

use crate::measure::Times;
use crate::report::{Figure, Report};
use crate::stores::scratch_folder;

const BUNDLED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/terrain/frazier_1024_int16.tif");
/// The tile, in the folder of `OROGENY_DATA`.
const TILE: &str = "N34W119.hgt.zip";
const SPACING_M: f64 = 28.0;
/// Samples from the middle of a stroke to its rim.
const RADIUS: f64 = 256.0;

/// Ten layers with the ground: what is stored, worked out, applied to what is below, and masked by it.
const STACK: [&str; 9] = [
    r#"{"op": "add_layer", "name": "Sculpt"}"#,
    r#"{"op": "add_layer", "name": "Hills", "content": {"type": "procedural", "seed": 1,
        "brush": {"type": "noise", "strength": 60, "feature_size": 4000}}}"#,
    r#"{"op": "add_layer", "name": "Details", "content": {"type": "procedural", "seed": 2,
        "brush": {"type": "noise", "turbulence": "ridged", "strength": 15, "feature_size": 500}}}"#,
    r#"{"op": "add_layer", "name": "Valleys", "content": {"type": "effect", "brush": {"type": "smooth", "width": 120, "strength": 1}},
        "mask": [{"gate": {"height": {"min": -500, "max": 900, "feather": 200}}}]}"#,
    r#"{"op": "add_layer", "name": "Roads"}"#,
    r#"{"op": "add_layer", "name": "Steps", "content": {"type": "effect", "brush": {"type": "terrace", "step": 40, "strength": 1}},
        "mask": [{"gate": {"slope": {"min": 25, "max": 90, "feather": 5}}}]}"#,
    r#"{"op": "add_layer", "name": "Lake beds", "blend": "min", "opacity": 0.5, "height": 3000}"#,
    r#"{"op": "add_layer", "name": "Rough", "content": {"type": "procedural", "seed": 3,
        "brush": {"type": "noise", "strength": 4, "feature_size": 200}}, "opacity": 0.5}"#,
    r#"{"op": "add_layer", "name": "Finish"}"#,
];

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let folder = scratch_folder()?;
    let mut single = ground(&folder, "single")?;
    let mut stack = ground(&folder, "stack")?;
    let operations = STACK.into_iter().map(Operation::from_json_text).collect::<Result<Vec<_>, _>>()?;
    stack.apply(&operations, &mut Quiet)?;
    let side = single.grid().width();
    report.note(format!("layers: ground of {side} x {side} samples, strokes of {RADIUS} samples in radius"));
    let names = ["Base", "Roads", "Finish"];
    let mut times = [(); 4].map(|()| Times::default());
    let mut ratios = [(); 3].map(|()| Vec::new());
    let mut most_in_bytes = 0;
    for round in 0..repeat + 1 {
        let [alone, by_layer @ ..] = &mut times;
        let of_single = stroke(&mut single, "Base", round)?;
        let mut of_layers = [0.0; 3];
        for (name, seconds) in names.iter().zip(&mut of_layers) {
            *seconds = stroke(&mut stack, name, round)?;
            most_in_bytes = stack.memory().total_in_bytes().max(most_in_bytes);
        }
        // In the first round pages are read, and what is below the brush is worked out for the first time.
        if round == 0 {
            continue;
        }
        alone.add(of_single);
        for ((times, ratios), seconds) in by_layer.iter_mut().zip(&mut ratios).zip(of_layers) {
            times.add(seconds);
            ratios.push(seconds / of_single);
        }
    }
    let [alone, by_layer @ ..] = times;
    report.add(Figure::time("stroke to composite, one layer".to_owned(), &alone));
    for ((name, times), ratios) in ["lowest", "middle", "uppermost"].into_iter().zip(by_layer).zip(ratios) {
        report.add(Figure::time(format!("stroke to composite, {name} of ten layers"), &times));
        report.add(Figure::ratio(format!("the same beside one layer, {name} of ten"), ratios));
    }
    let budget = Settings::default().page_budget_in_bytes;
    report.note(format!("memory: at most {} MiB of a budget of {} MiB", most_in_bytes >> 20, budget >> 20));
    stack.close()?;
    single.close()?;
    Ok(())
}

fn ground(folder: &TempDir, name: &str) -> Result<Terrain> {
    let tile = std::env::var_os("OROGENY_DATA").map(|data| PathBuf::from(data).join(TILE));
    let file = tile.filter(|tile| tile.exists()).unwrap_or_else(|| Path::new(BUNDLED).to_owned());
    let options =
        ImportOptions { spacing_m: Some(SPACING_M), nodata: NodataPolicy::Fill, ..ImportOptions::default() };
    let request = ImportRequest { file, options, layer: None, at_m: [0.0, 0.0] };
    let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let path = folder.path().join(format!("{name}.orogeny"));
    Ok(Terrain::from_raster(&path, &request, settings, &mut Quiet)?.0)
}

/// Paints on a layer, and reads what is seen of it; seconds.
fn stroke(terrain: &mut Terrain, layer: &str, round: usize) -> Result<f64> {
    let side_m = f64::from(terrain.grid().width()) * SPACING_M;
    let radius_m = RADIUS * SPACING_M;
    let place = |number: usize| side_m * (0.35 + 0.3 * (number as f64 * 0.618_034).fract());
    let (x_m, z_m) = (place(round), place(round + 5));
    let text = format!(
        r#"{{"op": "stroke", "layer": "{layer}", "brush": {{"type": "raise", "radius": {radius_m}, "strength": 5}},
            "points": [[{x_m}, {z_m}], [{}, {z_m}]]}}"#,
        x_m + 0.5 * radius_m
    );
    let operation = Operation::from_json_text(&text)?;
    terrain.flush()?;
    let region = [x_m - radius_m, z_m - radius_m, 2.5 * radius_m, 2.0 * radius_m];
    // What is painted on, and what lies around it, has been looked at before.
    let [x, z, width, depth] = region;
    let around = [x - radius_m, z - radius_m, width + 2.0 * radius_m, depth + 2.0 * radius_m];
    terrain.heights(&ExportSource::Composite, Some(around), 0)?;
    let mut times = Times::default();
    times.measure(|| {
        terrain.submit(std::slice::from_ref(&operation), &mut Quiet)?;
        terrain.heights(&ExportSource::Composite, Some(region), 0)
    })?;
    Ok(times.median_s())
}
