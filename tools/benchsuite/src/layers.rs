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

use crate::bundled::{self, SPACING_M};
use crate::measure::Times;
use crate::report::{Figure, Report};
use crate::stores::scratch_folder;

/// The tile, in the folder of `OROGENY_DATA`.
const TILE: &str = "N34W119.hgt.zip";
/// Samples from the middle of a stroke to its rim.
const RADIUS: f64 = 256.0;

/// Ten layers with the ground, of all kinds: what is stored, worked out, applied to what is below, and masked by it.
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

/// Ten layers with the ground, as they are when one sculpts: all of them joined sample by sample, most of them painted, two through masks.
const LIGHT_STACK: [&str; 17] = [
    r#"{"op": "add_layer", "name": "Hills", "content": {"type": "procedural", "seed": 1,
        "brush": {"type": "noise", "strength": 60, "feature_size": 4000}}}"#,
    r#"{"op": "set_mask", "layer": "Hills", "from": "nothing"}"#,
    r#"{"op": "stroke", "layer": "Hills", "target": "mask", "brush": {"type": "paint_mask", "radius": 40000}, "points": [[50000, 50000]]}"#,
    r#"{"op": "add_layer", "name": "Sculpt"}"#,
    r#"{"op": "stroke", "layer": "Sculpt", "brush": {"type": "raise", "radius": 40000, "strength": 50}, "points": [[50000, 50000]]}"#,
    r#"{"op": "add_layer", "name": "Ridges"}"#,
    r#"{"op": "stroke", "layer": "Ridges", "brush": {"type": "raise", "radius": 40000, "strength": 50}, "points": [[50000, 50000]]}"#,
    r#"{"op": "add_layer", "name": "Valleys", "blend": "subtract"}"#,
    r#"{"op": "stroke", "layer": "Valleys", "brush": {"type": "raise", "radius": 40000, "strength": 50}, "points": [[50000, 50000]]}"#,
    r#"{"op": "add_layer", "name": "Roads"}"#,
    r#"{"op": "stroke", "layer": "Roads", "target": "mask", "brush": {"type": "erase_mask", "radius": 20000}, "points": [[20000, 20000]]}"#,
    r#"{"op": "add_layer", "name": "Steps", "opacity": 0.5}"#,
    r#"{"op": "stroke", "layer": "Steps", "brush": {"type": "raise", "radius": 40000, "strength": 50}, "points": [[50000, 50000]]}"#,
    r#"{"op": "add_layer", "name": "Lake beds", "blend": "min", "height": 3000}"#,
    r#"{"op": "add_layer", "name": "Rough", "opacity": 0.5}"#,
    r#"{"op": "stroke", "layer": "Rough", "brush": {"type": "roughen", "radius": 40000, "strength": 2}, "points": [[50000, 50000]]}"#,
    r#"{"op": "add_layer", "name": "Finish"}"#,
];

/// Layers of both stacks that are painted on.
const PAINTED: [(&str, &str); 3] = [("lowest", "Base"), ("middle", "Roads"), ("uppermost", "Finish")];

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    for (name, stack) in [("ten layers", &STACK[..]), ("ten light layers", &LIGHT_STACK[..])] {
        run_stack(report, repeat, name, stack)?;
    }
    Ok(())
}

fn run_stack(report: &mut Report, repeat: usize, stack_name: &str, operations: &[&str]) -> Result<()> {
    let folder = scratch_folder()?;
    let mut single = ground(&folder, "single")?;
    let mut stack = ground(&folder, "stack")?;
    let operations =
        operations.iter().map(|text| Operation::from_json_text(text)).collect::<Result<Vec<_>, _>>()?;
    stack.apply(&operations, &mut Quiet)?;
    let side = single.grid().width();
    report.note(format!("layers: ground of {side} x {side} samples, strokes of {RADIUS} samples in radius"));
    let mut times = [(); 4].map(|()| Times::default());
    let mut ratios = [(); 3].map(|()| Vec::new());
    let mut most_in_bytes = 0;
    for round in 0..repeat + 1 {
        let [alone, by_layer @ ..] = &mut times;
        let of_single = stroke(&mut single, "Base", round)?;
        let mut of_layers = [0.0; 3];
        for ((_, layer), seconds) in PAINTED.iter().zip(&mut of_layers) {
            *seconds = stroke(&mut stack, layer, round)?;
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
    report.add(Figure::time(format!("stroke to composite, one layer beside {stack_name}"), &alone));
    for (((place, _), times), ratios) in PAINTED.iter().zip(by_layer).zip(ratios) {
        report.add(Figure::time(format!("stroke to composite, {place} of {stack_name}"), &times));
        report.add(Figure::ratio(format!("the same beside one layer, {place} of {stack_name}"), ratios));
    }
    let budget = Settings::default().page_budget_in_bytes;
    report.note(format!("memory: at most {} MiB of a budget of {} MiB", most_in_bytes >> 20, budget >> 20));
    stack.close()?;
    single.close()?;
    Ok(())
}

fn ground(folder: &TempDir, name: &str) -> Result<Terrain> {
    let tile = std::env::var_os("OROGENY_DATA").map(|data| PathBuf::from(data).join(TILE));
    let file = tile.filter(|tile| tile.exists()).unwrap_or_else(|| Path::new(bundled::FILE).to_owned());
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
    // What is on its way to one file takes no time from strokes on another.
    terrain.flush()?;
    Ok(times.median_s())
}
