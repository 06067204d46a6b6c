//! `session`: from a point of a pointer to the frame that shows what it painted, as a window has it: through the session's thread, its pages,
//! their way into textures and the drawing. The brush's part and the frame's are told apart.
//!
//! And frames while a heavy stroke runs on the session's thread, beside frames with nothing else to do.

use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use anyhow::{Result, bail, ensure};
use glam::DVec3;
use orogeny_engine::session::{Event, Session, Ticket};
use orogeny_engine::{
    Adapter, Camera, Gpu, LiveView, Mode, Operation, PointerSample, Quiet, Settings, Terrain, TerrainGrid,
    ViewRequest, drawing_gpu,
};

use crate::measure::Times;
use crate::report::{Figure, Report};
use crate::stores::scratch_folder;

const SIDE: u64 = 4096;
/// Small, since on a software driver nearly all of a frame is the shading of its pixels.
const SIZE_PX: [u32; 2] = [320, 180];
const RADII: [f64; 3] = [64.0, 256.0, 1024.0];
const POINTS: u32 = 12;
const WAIT: Duration = Duration::from_secs(60);

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let folder = scratch_folder()?;
    let settings = Settings { adapter: Adapter::Cpu, ..Settings::default() };
    let grid = TerrainGrid::new(SIDE, SIDE, 1.0)?;
    let mut terrain = Terrain::create(&folder.path().join("t.orogeny"), grid, 0.0, settings)?;
    let hills = r#"{"op": "fill", "brush": {"type": "noise", "strength": 200, "feature_size": 1500}}"#;
    terrain.apply(&[Operation::from_json_text(hills)?], &mut Quiet)?;
    let mut window = Window::new(terrain)?;
    report.note(format!(
        "session: pictures of {} x {} pixels on {}",
        SIZE_PX[0],
        SIZE_PX[1],
        window.gpu.description()
    ));
    for radius in RADII {
        let mut times = [(); 3].map(|()| Times::default());
        for stroke in 0..repeat {
            window.draw_stroke(radius, stroke, &mut times)?;
        }
        let [painted, drawn, whole] = &times;
        for (part, times) in [("painted", painted), ("its frame", drawn), ("point to frame", whole)] {
            let name = format!("session radius {radius}, {part}");
            report.add(Figure::time(name.clone(), times));
            report.add(Figure::percentile(format!("{name}, 99th percentile"), times, 0.99));
        }
    }
    window.heavy(report, repeat)?;
    window.session.close()?;
    Ok(())
}

/// What a window has of a session.
struct Window {
    session: Session,
    woken: Receiver<()>,
    view: LiveView,
    gpu: Gpu,
    camera: Camera,
    request: ViewRequest,
}

impl Window {
    fn new(terrain: Terrain) -> Result<Self> {
        let (wake, woken) = channel();
        let session = Session::of(terrain, move || _ = wake.send(()))?;
        let settings = Settings { adapter: Adapter::Auto, ..Settings::default() };
        let gpu = drawing_gpu(&settings)?;
        let start = Instant::now();
        let status = loop {
            let status = session.events().into_iter().find_map(|event| match event {
                Event::Status(status) => Some(status),
                _ => None,
            });
            if let Some(status) = status {
                break status;
            }
            ensure!(start.elapsed() < WAIT, "the session tells nothing");
            woken.recv_timeout(WAIT)?;
        };
        let view = LiveView::new(&gpu, &status, 256 << 20)?;
        let middle = SIDE as f64 / 2.0;
        let (eye, target) = (DVec3::new(middle, 1500.0, middle + 2500.0), DVec3::new(middle, 100.0, middle));
        let camera = Camera::looking_at(eye, target, 0.9, SIZE_PX);
        // As a window draws on a software driver while something moves.
        let request = ViewRequest {
            size_px: SIZE_PX,
            mode: Mode::Shaded,
            has_shadows: false,
            ..ViewRequest::default()
        };
        let mut window = Self { session, woken, view, gpu, camera, request };
        window.settle()?;
        Ok(window)
    }

    fn frame(&mut self) -> Result<()> {
        self.view.draw(&self.camera, SIZE_PX, &self.request)?;
        Ok(self.gpu.wait()?)
    }

    /// Takes what was told since; whether something was painted, pages came, and which task ended.
    fn take(&mut self) -> Result<Told> {
        let mut told = Told::default();
        for event in self.session.events() {
            self.view.take(&event)?;
            match event {
                Event::Changed { .. } => told.is_changed = true,
                Event::Pages(_) => told.has_pages = true,
                Event::Done { ticket, .. } => told.done = Some(ticket),
                Event::Failed { message, .. } => bail!("{message}"),
                _ => {}
            }
        }
        let wanted = self.view.wanted();
        if !wanted.is_empty() {
            self.session.look(wanted);
        }
        Ok(told)
    }

    /// Until a frame lacks nothing.
    fn settle(&mut self) -> Result<()> {
        let start = Instant::now();
        loop {
            self.frame()?;
            self.take()?;
            if self.view.is_complete() {
                return Ok(());
            }
            ensure!(start.elapsed() < WAIT, "pages do not come");
            _ = self.woken.recv_timeout(Duration::from_millis(50));
        }
    }

    /// A stroke point by point, each once the frame shows the one before it: how long until it is painted, how long its frame
    /// takes, and both with all that lies between.
    fn draw_stroke(
        &mut self,
        radius: f64,
        number: usize,
        [painted, drawn, whole]: &mut [Times; 3],
    ) -> Result<()> {
        let text = format!(
            r#"{{"op": "stroke", "brush": {{"type": "raise", "radius": {radius}, "strength": 2}}, "points": []}}"#
        );
        let Operation::Brush(stroke) = Operation::from_json_text(&text)? else { bail!("a stroke is none") };
        let ticket = self.session.begin_stroke(stroke);
        for point in 0..POINTS {
            // Forth and back, further than from instance to instance, so that each point paints.
            let x = 2000.0 + f64::from(point % 2) * 0.5 * radius + number as f64;
            let start = Instant::now();
            self.session.push_points(ticket, vec![PointerSample::at(x, 2000.0)]);
            // Of the first point nothing is seen before the second one comes: a hand may rest.
            if point <= 1 {
                continue;
            }
            let (mut is_changed, mut is_painted) = (false, None);
            loop {
                ensure!(start.elapsed() < WAIT, "nothing is painted");
                _ = self.woken.recv_timeout(Duration::from_millis(5));
                let told = self.take()?;
                is_changed |= told.is_changed;
                if is_changed && is_painted.is_none() {
                    is_painted = Some(start.elapsed());
                }
                if is_changed && told.has_pages {
                    let begin = Instant::now();
                    self.frame()?;
                    if self.view.is_complete() {
                        drawn.add(begin.elapsed().as_secs_f64());
                        break;
                    }
                }
            }
            if let Some(is_painted) = is_painted {
                painted.add(is_painted.as_secs_f64());
                whole.add(start.elapsed().as_secs_f64());
            }
        }
        self.session.lift(ticket);
        self.until_done(ticket)?;
        self.settle()
    }

    fn until_done(&mut self, ticket: Ticket) -> Result<()> {
        let start = Instant::now();
        while self.take()?.done != Some(ticket) {
            ensure!(start.elapsed() < WAIT, "a task does not end");
            _ = self.woken.recv_timeout(Duration::from_millis(50));
        }
        Ok(())
    }

    /// Frames one after another, with nothing else to do and while a wide and heavy stroke is worked out.
    fn heavy(&mut self, report: &mut Report, repeat: usize) -> Result<()> {
        let mut idle = Times::default();
        for _ in 0..repeat * 8 {
            idle.measure(|| self.frame())?;
        }
        let text = r#"{"op": "stroke", "brush": {"type": "smooth", "radius": 1000, "width": 60, "strength": 1, "spacing": 0.05},
            "points": [[1500, 1500], [2500, 2500]]}"#;
        let mut busy = Times::default();
        let mut lasted = Times::default();
        let start = Instant::now();
        let ticket = self.session.apply(vec![Operation::from_json_text(text)?]);
        loop {
            busy.measure(|| self.frame())?;
            if self.take()?.done == Some(ticket) {
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
}

/// What a session told.
#[derive(Default)]
struct Told {
    is_changed: bool,
    has_pages: bool,
    done: Option<Ticket>,
}
