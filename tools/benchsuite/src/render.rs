//! Pictures: what a frame takes by mode and while flying, and how many triangles and draw calls it is made of, beside those of all cells.
//!
//! The terrain is the bundled one. A frame is measured from the call until its
//! pixels are in memory; on a software driver nearly all of it is the shading of pixels.
//!
//! Frames that show the dabs of a stroke, beside those that show nothing new, and the bytes that go from memory to the device for a stroke: where
//! brushes work on the CPU, and where they work on the device that draws.

use anyhow::Result;
use orogeny_engine::{Flight, HeightAt, Metric, Mode, Place, Quiet, Settings, Terrain, View, ViewRequest};

use crate::bundled;
use crate::measure::Times;
use crate::report::{Figure, Report};
use crate::stores::scratch_folder;
use crate::window::{Dabs, Window, WorksOn};

const SIZE_PX: [u32; 2] = [640, 360];
/// Frames of the flight.
const NUM_FRAMES: u32 = 12;

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let folder = scratch_folder()?;
    let path = folder.path().join("real.orogeny");
    bundled::terrain(&path)?.close()?;
    let terrain = Terrain::open_to_read(&path, Settings::default())?;
    let mut view = terrain.view(SIZE_PX)?;
    report.note(format!("pictures of {} x {} pixels on {}", SIZE_PX[0], SIZE_PX[1], view.adapter()));
    counts(report, &terrain, &mut view)?;
    frames(report, &mut view, repeat)?;
    for (name, works_on) in
        [("brushes on the CPU", WorksOn::Cpu), ("brushes on the device that draws", WorksOn::DrawingDevice)]
    {
        let mut window = Window::new(&folder.path().join(format!("{works_on:?}.orogeny")), works_on)?;
        brushing(report, &mut window, name, repeat)?;
        window.session.close()?;
    }
    Ok(())
}

/// Frames with nothing new, and frames that show what was painted since the last one.
fn brushing(report: &mut Report, window: &mut Window, name: &str, repeat: usize) -> Result<()> {
    for radius in [64.0, 256.0, 1024.0] {
        let (mut idle, mut dabs, mut ratios) = (Times::default(), Dabs::default(), Vec::new());
        let mut uploaded = Vec::new();
        for number in 0..repeat.max(1) {
            let (mut idle_now, mut dabs_now) = (Times::default(), Dabs::default());
            for _ in 0..8 {
                idle_now.measure(|| window.frame())?;
            }
            let before = window.view.uploaded_bytes();
            window.draw_stroke(radius, number, &mut dabs_now)?;
            uploaded.push((window.view.uploaded_bytes() - before) as f64);
            idle.add(idle_now.median_s());
            dabs.drawn.add(dabs_now.drawn.median_s());
            dabs.painted.add(dabs_now.painted.median_s());
            ratios.push(dabs_now.drawn.median_s() / idle_now.median_s());
        }
        let name = |what: &str| format!("{what}, radius {radius}, {name}");
        report.add(Figure::time(name("a live frame, idle"), &idle));
        report.add(Figure::time(name("a live frame with a dab"), &dabs.drawn));
        report.add(Figure::ratio(name("the same by idle"), ratios));
        report.add(Figure::time(name("the dab itself"), &dabs.painted));
        report.add(Figure::sizes(name("uploaded for a stroke"), uploaded));
    }
    Ok(())
}

fn near() -> ViewRequest {
    let place =
        |x_m: f64, above_m: f64, z_m: f64| Some(Place { x_m, height: HeightAt::AboveGround(above_m), z_m });
    ViewRequest {
        size_px: SIZE_PX,
        eye: place(9_000.0, 900.0, 16_500.0),
        target: place(14_500.0, 0.0, 11_000.0),
        ..ViewRequest::default()
    }
}

/// Triangles and draw calls of one picture, by both metrics, beside two triangles for each cell in a draw call a page.
fn counts(report: &mut Report, terrain: &Terrain, view: &mut View<'_>) -> Result<()> {
    let cells = u64::from(terrain.grid().width() - 1) * u64::from(terrain.grid().depth() - 1);
    for (name, metric) in [("roughness", Metric::Roughness), ("from above", Metric::FromAbove)] {
        for max_error_px in [1.0, 2.0, 4.0, 8.0] {
            let request = ViewRequest { mode: Mode::Shaded, metric, max_error_px, ..near() };
            let drawn = view.draw(&request, &mut Quiet)?.report;
            report.note(format!(
                "{name}, {max_error_px} px: {} triangles ({:.1} % of all cells'), {} draw calls, {} pages",
                drawn.num_triangles,
                100.0 * drawn.num_triangles as f64 / (2 * cells) as f64,
                drawn.num_draw_calls,
                drawn.num_pages
            ));
        }
    }
    Ok(())
}

/// Frames from one place by mode, and frames of a flight, by turns with them.
fn frames(report: &mut Report, view: &mut View<'_>, repeat: usize) -> Result<()> {
    let modes = [Mode::Shaded, Mode::Textured, Mode::Contours, Mode::Wireframe];
    let mut times = modes.map(|_| Times::default());
    let (mut flying, mut ratios) = (Times::default(), Vec::new());
    let keys = r#"[{"eye": [3000, 4000, 25000], "target": [12000, 1000, 15000]}, {"eye": [13000, 3200, 12000], "target": [20000, 1000, 6000]}]"#;
    let flight = Flight::from_json(&format!(r#"{{"frames": {NUM_FRAMES}, "keys": {keys}}}"#))?;
    let shaded = ViewRequest { mode: Mode::Shaded, ..near() };
    for mode in modes {
        // Pipelines, pages and textures are there from now on.
        view.draw(&ViewRequest { mode, ..near() }, &mut Quiet)?;
    }
    for _ in 0..repeat.max(1) {
        for (mode, times) in modes.into_iter().zip(&mut times) {
            times.measure(|| view.draw(&ViewRequest { mode, ..near() }, &mut Quiet))?;
        }
    }
    for request in flight.frames(&shaded) {
        let (mut one, mut idle) = (Times::default(), Times::default());
        one.measure(|| view.draw(&request, &mut Quiet))?;
        idle.measure(|| view.draw(&request, &mut Quiet))?;
        flying.add(one.median_s());
        ratios.push(one.median_s() / idle.median_s());
    }
    for (mode, times) in modes.into_iter().zip(&times) {
        report.add(Figure::time(format!("a frame, {}", mode.name()), times));
    }
    report.add(Figure::time("a frame of a flight, shaded, pages read".to_owned(), &flying));
    report.add(Figure::ratio("the same by one drawn again from there".to_owned(), ratios));
    Ok(())
}
