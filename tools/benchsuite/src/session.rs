//! `session`: from a point of a pointer to the frame that shows what it painted, as a window has it: through the session's thread, its pages,
//! their way into textures and the drawing. The brush's part and the frame's are told apart.
//!
//! And frames while a heavy stroke runs on the session's thread, beside frames with nothing else to do.

use std::time::Instant;

use anyhow::{Result, ensure};
use orogeny_engine::Operation;

use crate::measure::Times;
use crate::report::{Figure, Report};
use crate::stores::scratch_folder;
use crate::window::{Dabs, SIZE_PX, WAIT, Window, WorksOn};

const RADII: [f64; 3] = [64.0, 256.0, 1024.0];

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let folder = scratch_folder()?;
    let mut window = Window::new(&folder.path().join("t.orogeny"), WorksOn::Cpu)?;
    report.note(format!(
        "session: pictures of {} x {} pixels on {}",
        SIZE_PX[0],
        SIZE_PX[1],
        window.gpu.description()
    ));
    for radius in RADII {
        let mut dabs = Dabs::default();
        for stroke in 0..repeat {
            window.draw_stroke(radius, stroke, &mut dabs)?;
        }
        let Dabs { painted, drawn, whole } = &dabs;
        for (part, times) in [("painted", painted), ("its frame", drawn), ("point to frame", whole)] {
            let name = format!("session radius {radius}, {part}");
            report.add(Figure::time(name.clone(), times));
            report.add(Figure::percentile(format!("{name}, 99th percentile"), times, 0.99));
        }
    }
    heavy(&mut window, report, repeat)?;
    window.session.close()?;
    Ok(())
}

/// Frames one after another, with nothing else to do and while a wide and heavy stroke is worked out.
fn heavy(window: &mut Window, report: &mut Report, repeat: usize) -> Result<()> {
    let mut idle = Times::default();
    for _ in 0..repeat * 8 {
        idle.measure(|| window.frame())?;
    }
    let text = r#"{"op": "stroke", "brush": {"type": "smooth", "radius": 1000, "width": 60, "strength": 1, "spacing": 0.05},
        "points": [[1500, 1500], [2500, 2500]]}"#;
    let mut busy = Times::default();
    let mut lasted = Times::default();
    let start = Instant::now();
    let ticket = window.session.apply(vec![Operation::from_json_text(text)?]);
    loop {
        busy.measure(|| window.frame())?;
        if window.take()?.done == Some(ticket) {
            break;
        }
        ensure!(start.elapsed() < WAIT, "a stroke does not end");
    }
    lasted.add(start.elapsed().as_secs_f64());
    for (name, times) in [("idle", &idle), ("while a heavy stroke runs", &busy)] {
        report.add(Figure::time(format!("session frame, {name}"), times));
        report.add(Figure::percentile(format!("session frame, {name}, 99th percentile"), times, 0.99));
    }
    report.add(Figure::time("session heavy stroke meanwhile, radius 1000".to_owned(), &lasted));
    Ok(())
}
