//! `memory`: bytes of a page in memory, and of an entry of the history, by brush and radius, on the bundled terrain.
//!
//! An entry is a stroke of two diameters in length. Beside it the heights under it: what a copy of each of them would take.

use std::path::Path;

use anyhow::Result;
use orogeny_engine::{Operation, Quiet};

use crate::bundled;
use crate::report::{Figure, Report};
use crate::stores::scratch_folder;

/// In samples.
const RADII: [f64; 3] = [16.0, 64.0, 128.0];
const NUM_STROKES: u32 = 8;
const BRUSHES: [(&str, &str); 6] = [
    ("raise", r#""type": "raise", "strength": 20"#),
    ("level", r#""type": "level", "strength": 0.7"#),
    ("noise", r#""type": "noise", "strength": 30, "feature_size": 900"#),
    ("roughen", r#""type": "roughen", "strength": 3"#),
    ("smooth", r#""type": "smooth", "strength": 0.8"#),
    ("terrace", r#""type": "terrace", "strength": 1, "step": 50"#),
];

pub fn run(report: &mut Report) -> Result<()> {
    let folder = scratch_folder()?;
    for (name, brush) in BRUSHES {
        for radius in RADII {
            let mut terrain = bundled::terrain(&folder.path().join(format!("{name}-{radius}.orogeny")))?;
            let before = terrain.describe()?.history.size_in_bytes;
            for number in 0..NUM_STROKES {
                terrain.apply(&[stroke(brush, radius, number)?], &mut Quiet)?;
            }
            let size_in_bytes = terrain.describe()?.history.size_in_bytes - before;
            let of_one = size_in_bytes as f64 / f64::from(NUM_STROKES);
            report.add(Figure::size(format!("memory entry of {name}, radius {radius}"), of_one));
            let heights = 4.0 * (std::f64::consts::PI + 8.0) * radius * radius;
            report.add(Figure::ratio(
                format!("memory heights under it beside its size, {name}, radius {radius}"),
                vec![heights / of_one],
            ));
            terrain.close()?;
        }
    }
    resident(report, &folder.path().join("resident.orogeny"))
}

fn stroke(brush: &str, radius: f64, number: u32) -> Result<Operation> {
    let (radius_m, side_m) = (radius * bundled::SPACING_M, bundled::SIDE as f64 * bundled::SPACING_M);
    let inside = |share: f64| radius_m + share.fract() * (side_m - 2.0 * radius_m);
    let (x, z) = (
        inside(f64::from(number) * 0.618_034).min(side_m - 5.0 * radius_m),
        inside(f64::from(number) * 0.754_878),
    );
    let text = format!(
        r#"{{"op": "stroke", "brush": {{{brush}, "radius": {radius_m}}}, "points": [[{x}, {z}], [{}, {z}]]}}"#,
        x + 4.0 * radius_m
    );
    Ok(Operation::from_json_text(&text)?)
}

/// What is counted for each page that a stroke has made resident.
fn resident(report: &mut Report, path: &Path) -> Result<()> {
    let mut terrain = bundled::terrain(path)?;
    let before = terrain.memory();
    let fill = r#"{"op": "fill", "brush": {"type": "raise", "strength": 1}}"#;
    terrain.apply(&[Operation::from_json_text(fill)?], &mut Quiet)?;
    let after = terrain.memory();
    let side = u64::from(terrain.describe()?.page_size);
    let num_pages = bundled::SIDE.div_ceil(side).pow(2);
    let bytes = after.pages_in_bytes.saturating_sub(before.pages_in_bytes);
    report.add(Figure::size("memory resident page".to_owned(), bytes as f64 / num_pages as f64));
    report.add(Figure::size("memory heights of a page".to_owned(), (side * side * 4) as f64));
    Ok(terrain.close()?)
}
