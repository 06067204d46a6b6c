//! A terrain in a window, without the window: a session, what draws it, and a hand.

use std::path::Path;
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

const SIDE: u64 = 4096;
/// Small, since on a software driver nearly all of a frame is the shading of its pixels.
pub const SIZE_PX: [u32; 2] = [320, 180];
const POINTS: u32 = 12;
pub const WAIT: Duration = Duration::from_secs(60);

/// What brushes work on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorksOn {
    Cpu,
    /// The device that draws.
    DrawingDevice,
}

/// What the dabs of strokes took.
#[derive(Default)]
pub struct Dabs {
    /// Until one is painted.
    pub painted: Times,
    /// The frame that shows it.
    pub drawn: Times,
    /// From the pointer to the frame.
    pub whole: Times,
}

/// What a window has of a session.
pub struct Window {
    pub session: Session,
    pub woken: Receiver<()>,
    pub view: LiveView,
    pub gpu: Gpu,
    camera: Camera,
    request: ViewRequest,
}

impl Window {
    /// Of hills.
    pub fn new(path: &Path, works_on: WorksOn) -> Result<Self> {
        let gpu = drawing_gpu(&Settings::default())?;
        let adapter = match works_on {
            WorksOn::Cpu => Adapter::Cpu,
            WorksOn::DrawingDevice => Adapter::Named(gpu.description().name.clone()),
        };
        let settings = Settings { adapter, ..Settings::default() }.sharing(&gpu);
        let mut terrain = Terrain::create(path, TerrainGrid::new(SIDE, SIDE, 1.0)?, 0.0, settings)?;
        let hills = r#"{"op": "fill", "brush": {"type": "noise", "strength": 200, "feature_size": 1500}}"#;
        terrain.apply(&[Operation::from_json_text(hills)?], &mut Quiet)?;
        let (wake, woken) = channel();
        let session = Session::of(terrain, move || _ = wake.send(()))?;
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

    /// Draws, and waits until it is drawn.
    pub fn frame(&mut self) -> Result<()> {
        self.view.draw(&self.camera, SIZE_PX, &self.request)?;
        Ok(self.gpu.wait()?)
    }

    /// Takes what was told since; whether something was painted, pages came, and which task ended.
    pub fn take(&mut self) -> Result<Told> {
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
    pub fn draw_stroke(&mut self, radius: f64, number: usize, dabs: &mut Dabs) -> Result<()> {
        let Dabs { painted, drawn, whole } = dabs;
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
}

/// What a session told.
#[derive(Default)]
pub struct Told {
    pub is_changed: bool,
    pub has_pages: bool,
    pub done: Option<Ticket>,
}
