//! The terrain file at work: opening and the first edit by size, strokes and undo by the length of the history, and what a
//! commit costs by its pages.
//!
//! A stroke is measured twice: until it is painted (`painted`), when the next one may begin, and until it is on disk (`on
//! disk`). Both are to be the same whatever the size and the history.

use std::path::Path;

use anyhow::{Context as _, Result};
use orogeny_engine::{Adapter, Operation, Quiet, Settings, Terrain, TerrainGrid};
use orogeny_field::{Page, PageKey, PageLayout};
use orogeny_store::{NewLayer, NewTerrain, Store};
use tempfile::TempDir;

use crate::measure::Times;
use crate::report::{Figure, Report, Unit};
use crate::stores::scratch_folder;

/// Sides of the terrains that are opened.
const SIDES: [u64; 3] = [1 << 10, 1 << 16, 1 << 20];
/// Strokes on the terrain whose history grows, and how many at its start and end are compared.
const NUM_STROKES: u32 = 10_000;
const NUM_COMPARED: u32 = 1000;
/// Pages of a commit.
const COMMIT_SIZES: [u32; 3] = [64, 256, 1000];
const NUM_COMMITS: u32 = 5;

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let folder = scratch_folder()?;
    openings(report, &folder, repeat)?;
    long_history(report, &folder)?;
    commits(report, &folder)
}

fn settings() -> Settings {
    Settings { adapter: Adapter::Cpu, ..Settings::default() }
}

/// A stroke of three points, 64 samples in radius and 300 long, somewhere on a terrain of that side.
fn stroke(side: u64, number: u32) -> Result<Operation> {
    let hash = |salt: u32| (number.wrapping_mul(0x9e37_79b9) ^ salt).wrapping_mul(0x85eb_ca6b) >> 8;
    let place = |salt: u32| 200.0 + f64::from(hash(salt)) / f64::from(1 << 24) * (side as f64 - 700.0);
    let (x, z) = (place(1), place(2));
    let text = format!(
        r#"{{"op": "stroke", "brush": {{"type": "raise", "radius": 64, "strength": 9, "profile": "smooth"}},
            "points": [[{x}, {z}], [{}, {}], [{}, {z}]]}}"#,
        x + 150.0,
        z + 60.0,
        x + 300.0
    );
    Ok(Operation::from_json_text(&text)?)
}

/// Opening, and the first stroke after it, on terrains of all sizes by turns.
fn openings(report: &mut Report, folder: &TempDir, repeat: usize) -> Result<()> {
    let path = |side: u64| folder.path().join(format!("{side}.orogeny"));
    let mut times: Vec<[Times; 3]> = SIDES.map(|_| Default::default()).into();
    for (side, [creations, ..]) in SIDES.into_iter().zip(&mut times) {
        let grid = TerrainGrid::new(side, side, 1.0)?;
        creations.measure(|| Terrain::create(&path(side), grid, 0.0, settings())?.close())?;
    }
    for number in 0..u32::try_from(repeat)? {
        for (side, [_, openings, first_strokes]) in SIDES.into_iter().zip(&mut times) {
            let mut terrain = openings.measure(|| Terrain::open(&path(side), settings()))?;
            first_strokes
                .measure(|| terrain.apply(&[stroke(side, number)?], &mut Quiet).context("a stroke"))?;
            terrain.close()?;
        }
    }
    for (side, [creations, openings, first_strokes]) in SIDES.into_iter().zip(times) {
        report.add(Figure::time(format!("making a terrain of {side} a side"), &creations));
        report.add(Figure::time(format!("opening it, {side} a side"), &openings));
        report.add(Figure::time(format!("first stroke, on disk, {side} a side"), &first_strokes));
    }
    Ok(())
}

/// The first and the last of many strokes, and their undoing. At the end most pages that a stroke meets are painted already,
/// and the coarser ones are full, so that there is more to code than at the start; that the history itself costs nothing is
/// counted by the tests (`tests/terrain/scale.rs`).
fn long_history(report: &mut Report, folder: &TempDir) -> Result<()> {
    const SIDE: u64 = 1 << 16;
    let path = folder.path().join("long.orogeny");
    let mut terrain = Terrain::create(&path, TerrainGrid::new(SIDE, SIDE, 1.0)?, 0.0, settings())?;
    for (name, range) in [
        ("1st", 0..NUM_COMPARED),
        ("", NUM_COMPARED..NUM_STROKES - NUM_COMPARED),
        ("last", NUM_STROKES - NUM_COMPARED..NUM_STROKES),
    ] {
        let (mut painted, mut on_disk, mut undone) = (Times::default(), Times::default(), Times::default());
        for number in range {
            let stroke = stroke(SIDE, number)?;
            // Every other one alone, every other one with its way to the disk.
            if number % 2 == 0 {
                painted.measure(|| terrain.submit(std::slice::from_ref(&stroke), &mut Quiet))?;
            } else {
                terrain.flush()?;
                on_disk.measure(|| terrain.apply(&[stroke], &mut Quiet))?;
            }
        }
        if name.is_empty() {
            continue;
        }
        for _ in 0..NUM_COMPARED / 10 {
            undone.measure(|| terrain.undo(1))?;
        }
        terrain.redo(NUM_COMPARED / 10)?;
        report
            .add(Figure::time(format!("stroke, painted, {name} {NUM_COMPARED} of {NUM_STROKES}"), &painted));
        report
            .add(Figure::time(format!("stroke, on disk, {name} {NUM_COMPARED} of {NUM_STROKES}"), &on_disk));
        report.add(Figure::time(
            format!("undo, on disk, {name} {} of {NUM_STROKES}", NUM_COMPARED / 10),
            &undone,
        ));
    }
    terrain.close()?;
    Ok(())
}

/// Whole pages of a stroke's ground, written over and over.
fn commits(report: &mut Report, folder: &TempDir) -> Result<()> {
    let layout = PageLayout::default();
    for num_pages in COMMIT_SIZES {
        let side = num_pages.isqrt() + 1;
        let path = folder.path().join(format!("commits-{num_pages}.orogeny"));
        let mut store = new_store(&path, u64::from(side * layout.size()), layout)?;
        let field = store.layers().first().context("there is a layer")?.heights;
        let mut times = Times::default();
        for round in 0..NUM_COMMITS {
            let pages: Vec<_> = (0..num_pages)
                .map(|place| {
                    (
                        PageKey::full_resolution(field, place % side, place / side),
                        ground(layout, place, round),
                    )
                })
                .collect();
            times.measure(|| {
                let mut transaction = store.begin()?;
                transaction.write_pages(&pages)?;
                transaction.commit("{}", "")
            })?;
        }
        let bytes = f64::from(num_pages) * layout.size_in_bytes() as f64;
        let name = format!("commit of {num_pages} pages, with history and levels");
        report.add(Figure::per_second(name, Unit::BytesPerSecond, &times, bytes, None));
        store.close()?;
    }
    Ok(())
}

fn new_store(path: &Path, side: u64, layout: PageLayout) -> Result<Store> {
    let layers = vec![NewLayer { name: "Base".to_owned(), constant_m: 0.0 }];
    Ok(Store::create(path, &NewTerrain { grid: TerrainGrid::new(side, side, 1.0)?, layout, layers })?)
}

/// A page of smooth hills, another for each place and round.
fn ground(layout: PageLayout, place: u32, round: u32) -> Page {
    let mut page = Page::constant(layout, 0.0);
    let (phase, steepness) = (place as f32 * 0.37, 0.02 + round as f32 * 0.003);
    for (height_m, index) in page.samples_mut().iter_mut().zip(0_u32..) {
        let (x, z) = ((index % layout.size()) as f32, (index / layout.size()) as f32);
        *height_m = 300.0 + 80.0 * (x * steepness + phase).sin() * (z * 0.017 - phase).cos();
    }
    page
}
