//! `curves`: how cost grows, as series that `--document` draws: of an instance by its radius, of a stroke by the terrain's size and by how many
//! pages are resident, of noise by its octaves. Strokes by the length of the history are `terrain`'s.
//!
//! All through the CPU back end on all cores. Cost by radius should grow as its square once a page is small beside it; cost by terrain and by
//! resident pages should not grow at all.

use anyhow::Result;
use orogeny_brush::{CpuExecutor, Executor};
use orogeny_engine::{Adapter, Operation, Quiet, Settings, Terrain};
use orogeny_field::noise::{Noise, Normalization};
use orogeny_field::{Brush, BrushType, PageLayout, Smoothing, TerrainGrid};
use orogeny_pages::MemoryPages;

use crate::dab::{dab, make_resident};
use crate::fill::Fill;
use crate::measure::{Spread, Times};
use crate::report::{Report, Series, Unit};
use crate::stores::scratch_folder;

/// A terrain on which an instance of the widest radius lies whole: 512 MiB of heights.
const TERRAIN: [u64; 2] = [16_384, 8_192];
/// About its middle, off the grid of samples.
const PLACE_M: [f64; 2] = [8192.3, 4096.7];
const BUDGET_IN_BYTES: u64 = 2 << 30;
const RADII: [f64; 10] = [8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0, 1024.0, 2048.0, 4096.0];
const SIDES: [u64; 6] = [1 << 10, 1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20];
/// Samples a side of squares of resident pages.
const RESIDENT_SIDES: [u64; 4] = [1 << 10, 1 << 11, 1 << 12, 1 << 13];
const OCTAVES: [u32; 6] = [1, 2, 4, 8, 12, 16];
const NOISE_SIDE: u64 = 2048;

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    by_radius(report, repeat)?;
    by_terrain(report, repeat)?;
    by_resident_pages(report, repeat)?;
    by_octaves(report, repeat)
}

fn brushes(radius: f64) -> [(&'static str, Brush); 3] {
    let noise = Noise { feature_size_m: 256.0, normalization: Normalization::Off, ..Noise::default() };
    let smoothing = Smoothing { width_m: Some(16.0), ..Smoothing::default() };
    [
        ("raise", Brush::new(BrushType::Raise, radius, 1.0)),
        ("noise", Brush { noise, ..Brush::new(BrushType::Noise, radius, 1.0) }),
        ("smooth", Brush { smoothing, ..Brush::new(BrushType::Smooth, radius, 0.5) }),
    ]
}

/// One instance on resident pages.
fn by_radius(report: &mut Report, repeat: usize) -> Result<()> {
    let mut executor = CpuExecutor::new(PageLayout::default(), BUDGET_IN_BYTES, None)?;
    let mut pages = MemoryPages::new(PageLayout::default(), 100.0);
    make_resident(&mut executor, &mut pages, TERRAIN)?;
    let mut cases = Vec::new();
    for radius in RADII {
        for (name, brush) in brushes(radius) {
            cases.push((name, radius, dab(&brush, TERRAIN, PLACE_M)?, Times::default()));
        }
    }
    for _ in 0..repeat {
        for (_, _, batch, times) in &mut cases {
            times.measure(|| executor.run(batch, &mut pages))?;
            executor.finish(&mut pages)?;
            pages.commit();
        }
    }
    for (name, _) in brushes(1.0) {
        let points = cases.iter().filter(|(case, ..)| *case == name);
        let points = points.map(|(_, radius, _, times)| (*radius, times.spread_s())).collect();
        report.plot(Series::new("instance by radius", name, "radius, samples", Unit::Seconds, points));
    }
    Ok(())
}

/// A stroke, 64 samples in radius, and its undoing, each until they are on disk.
fn by_terrain(report: &mut Report, repeat: usize) -> Result<()> {
    let folder = scratch_folder()?;
    let settings = || Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let mut terrains = Vec::new();
    for side in SIDES {
        let path = folder.path().join(format!("{side}.orogeny"));
        let terrain = Terrain::create(&path, TerrainGrid::new(side, side, 1.0)?, 0.0, settings())?;
        terrains.push((side, terrain, [(); 2].map(|()| Times::default())));
    }
    for number in 0..repeat * 4 {
        for (side, terrain, [strokes, undos]) in &mut terrains {
            let place = *side as f64 * (0.2 + 0.6 * (number as f64 * 0.618_034).fract());
            let text = format!(
                r#"{{"op": "stroke", "brush": {{"type": "raise", "radius": 64, "strength": 9}},
                    "points": [[{place}, {place}], [{}, {place}]]}}"#,
                place + 150.0
            );
            let stroke = Operation::from_json_text(&text)?;
            strokes.measure(|| terrain.apply(std::slice::from_ref(&stroke), &mut Quiet))?;
            undos.measure(|| terrain.undo(1))?;
            terrain.redo(1)?;
        }
    }
    for (place, name) in ["stroke", "undo"].into_iter().enumerate() {
        let points =
            terrains.iter().filter_map(|(side, _, times)| Some((*side as f64, times.get(place)?.spread_s())));
        report.plot(Series::new(
            "on disk by terrain",
            name,
            "samples a side",
            Unit::Seconds,
            points.collect(),
        ));
    }
    terrains.into_iter().try_for_each(|(_, terrain, _)| Ok(terrain.close()?))
}

/// An instance of 256 samples in radius, where more and more pages are in memory.
fn by_resident_pages(report: &mut Report, repeat: usize) -> Result<()> {
    let layout = PageLayout::default();
    let mut points = Vec::new();
    for side in RESIDENT_SIDES {
        let mut executor = CpuExecutor::new(layout, BUDGET_IN_BYTES, None)?;
        let mut pages = MemoryPages::new(layout, 100.0);
        make_resident(&mut executor, &mut pages, [side; 2])?;
        let batch = dab(&Brush::new(BrushType::Raise, 256.0, 1.0), [side; 2], [side as f64 / 2.0; 2])?;
        let mut times = Times::default();
        for _ in 0..repeat * 8 {
            times.measure(|| executor.run(&batch, &mut pages))?;
        }
        let num_pages = (side / u64::from(layout.size())).pow(2);
        points.push((num_pages as f64, times.spread_s()));
    }
    report.plot(Series::new("instance by resident pages", "raise", "resident pages", Unit::Seconds, points));
    Ok(())
}

/// Fills.
fn by_octaves(report: &mut Report, repeat: usize) -> Result<()> {
    let num_threads = rayon::current_num_threads();
    let num_samples = (NOISE_SIDE * NOISE_SIDE) as f64;
    let mut points = Vec::new();
    for octaves in OCTAVES {
        let noise =
            Noise { octaves, feature_size_m: 256.0, normalization: Normalization::Off, ..Noise::default() };
        let brush = Brush { noise, ..Brush::new(BrushType::Noise, 1.0, 100.0) };
        let mut fill = Fill::new(num_threads, NOISE_SIDE, 1.0, None, &brush)?;
        let mut times = Times::default();
        for _ in 0..repeat {
            fill.measure(&mut times)?;
        }
        let Spread { median, lowest, highest } = times.spread_s();
        let by_sample = |seconds: f64| seconds / num_samples;
        let spread =
            Spread { median: by_sample(median), lowest: by_sample(lowest), highest: by_sample(highest) };
        points.push((f64::from(octaves), spread));
    }
    report.plot(Series::new("noise by octaves", "gradient fbm", "octaves", Unit::Seconds, points));
    Ok(())
}
