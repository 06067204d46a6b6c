//! An open terrain: its session, what is drawn of it, and what is under way.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use glam::DVec3;
use orogeny_engine::session::{Event, Session, Status, Ticket};
use orogeny_engine::{EntryId, Gpu, Layer, LayerContent, LiveView, Mode, Progress, TerrainGrid};

use crate::overview::Overview;
use crate::pane::Pane;
use crate::piece::Copied;
use crate::{CameraControl, Result};

/// Bytes of pages that a pane draws from at most: the first one, and one beside it.
const DRAWN_BYTES: u64 = 512 << 20;
const DRAWN_BYTES_BESIDE: u64 = 256 << 20;

/// Something that was asked for and is not done yet.
#[derive(Debug, Clone)]
pub struct Job {
    /// By what the session knows it.
    pub ticket: Ticket,
    /// What it is, for people.
    pub what: String,
    /// How far it has come.
    pub progress: Option<Progress>,
}

/// Something that was told.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// What.
    pub text: String,
    /// Whether something went wrong.
    pub is_error: bool,
}

/// How the terrain was, beside how it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Past {
    /// The entry of the history after which it was so.
    pub entry: EntryId,
    /// What opened it.
    pub ticket: Ticket,
    /// Whether it is seen in the place of how the terrain is.
    pub is_seen: bool,
    /// Whether that ends when the key is let go.
    pub is_held: bool,
}

/// An open terrain.
#[derive(Debug)]
pub struct Document {
    /// Its file.
    pub path: PathBuf,
    /// What works on it.
    pub session: Session,
    /// Layers, history and more, as last told.
    pub status: Status,
    /// Where it is seen and worked on.
    pub pane: Pane,
    /// Where it is seen too, while the view is split.
    pub other: Option<Pane>,
    /// How many panes there have been.
    num_panes: u32,
    /// Who asked for pages that have not come, the first one first: they come in that order.
    pub asked: VecDeque<u32>,
    /// What was asked for and is not done, in order.
    pub jobs: Vec<Job>,
    /// The layer that is worked on, by its id.
    pub layer: u32,
    /// The stroke that is being drawn.
    pub stroke: Option<Ticket>,
    /// All of it in few heights.
    pub overview: Overview,
    /// What was copied, of it or of one that was open before.
    pub copied: Option<Copied>,
    /// Whether what is selected is to be copied as soon as it is known.
    pub is_copying: bool,
    /// What it is compared with.
    pub past: Option<Past>,
    /// The masks that come with pages.
    shown_masks: Vec<String>,
}

impl Document {
    /// A terrain whose session has told its first status.
    pub fn new(
        path: &Path,
        session: Session,
        status: Status,
        gpu: &Gpu,
        camera: Option<CameraControl>,
        mode: Mode,
    ) -> Result<Self> {
        let view = LiveView::new(gpu, &status, DRAWN_BYTES)?;
        let camera = camera.unwrap_or_else(|| framing(&status, [16.0, 9.0]));
        let layer = status.layers.first().map_or(0, |layer| layer.id);
        Ok(Self {
            path: path.to_owned(),
            session,
            status,
            pane: Pane::new(0, view, camera, mode),
            other: None,
            num_panes: 1,
            asked: VecDeque::new(),
            jobs: Vec::new(),
            layer,
            stroke: None,
            overview: Overview::default(),
            copied: None,
            is_copying: false,
            past: None,
            shown_masks: Vec::new(),
        })
    }

    /// Draws on another device, from pages that are asked for again.
    ///
    /// # Errors
    /// When it has no memory for that.
    pub fn draw_on(&mut self, gpu: &Gpu) -> Result<()> {
        self.overview.forget_pictures();
        let is_seen = self.sees_earlier();
        let status = &self.status;
        let beside = self.other.iter_mut().map(|pane| (pane, DRAWN_BYTES_BESIDE));
        for (pane, bytes) in std::iter::once((&mut self.pane, DRAWN_BYTES)).chain(beside) {
            pane.draw_with(LiveView::new(gpu, status, bytes)?);
            pane.view.show_earlier(is_seen)?;
        }
        Ok(())
    }

    /// All panes: the one that is worked in first.
    pub fn panes(&self) -> impl Iterator<Item = &Pane> {
        std::iter::once(&self.pane).chain(&self.other)
    }

    /// As [`Self::panes`].
    pub fn panes_mut(&mut self) -> impl Iterator<Item = &mut Pane> {
        std::iter::once(&mut self.pane).chain(&mut self.other)
    }

    /// Shows it in a second pane too, from the same place at first.
    ///
    /// # Errors
    /// When the device has no memory for that.
    pub fn split(&mut self, gpu: &Gpu) -> Result<()> {
        let mut view = LiveView::new(gpu, &self.status, DRAWN_BYTES_BESIDE)?;
        view.show_earlier(self.sees_earlier())?;
        let mut other = Pane::new(self.num_panes, view, self.pane.camera, self.pane.mode);
        other.is_right = !self.pane.is_right;
        self.num_panes += 1;
        self.other = Some(other);
        Ok(())
    }

    /// Works in the other pane from now on.
    pub const fn switch_panes(&mut self) {
        if let Some(other) = &mut self.other {
            std::mem::swap(&mut self.pane, other);
        }
    }

    fn sees_earlier(&self) -> bool {
        self.past.is_some_and(|past| past.is_seen)
    }

    /// Sees the ground as it was, or as it is, in all panes.
    ///
    /// # Errors
    /// When the device has no memory for that.
    pub fn show_earlier(&mut self, is_earlier: bool) -> Result<()> {
        for pane in self.panes_mut() {
            pane.view.show_earlier(is_earlier)?;
        }
        Ok(())
    }

    /// Whether a pane shows by how much it differs.
    #[must_use]
    pub fn is_compared(&self) -> bool {
        self.panes().any(|pane| pane.is_compared)
    }

    /// What is compared is the terrain as it is, and nothing else, from now on.
    ///
    /// # Errors
    /// When the device has no memory for that.
    pub fn close_past(&mut self) -> Result<()> {
        if self.past.take().is_some() {
            self.session.close_past();
            self.overview.note_changed();
            self.panes_mut().for_each(|pane| pane.is_compared = false);
            self.show_earlier(false)?;
        }
        Ok(())
    }

    /// Has the masks come that pictures need. They come with all pages, so there is one set of them for all panes.
    pub fn show_masks(&mut self, names: Vec<String>) {
        if names != self.shown_masks {
            self.session.show_masks(names.clone());
            self.shown_masks = names;
        }
    }

    /// Shows all of it.
    pub fn frame_all(&mut self, size: [f32; 2]) {
        self.pane.camera = framing(&self.status, size);
    }

    /// Notes that something was asked for.
    pub fn note(&mut self, ticket: Ticket, what: impl Into<String>) {
        let what = what.into();
        tracing::debug!("{what}: asked for");
        self.jobs.push(Job { ticket, what, progress: None });
    }

    /// Takes what the session has told, and gives what people are to hear of it.
    ///
    /// # Errors
    /// When the device fails.
    pub fn take_events(&mut self) -> Result<Vec<Message>> {
        let mut messages = Vec::new();
        for event in self.session.events() {
            // Pages are for the one that asked for them, all else for all.
            let asked = matches!(event, Event::Pages(_)).then(|| self.asked.pop_front());
            for pane in self.panes_mut() {
                if asked.is_none_or(|asked| asked == Some(pane.number)) {
                    pane.view.take(&event)?;
                }
            }
            match event {
                Event::Status(status) => self.take_status(*status),
                Event::Progress { ticket, progress } => {
                    if let Some(job) = self.jobs.iter_mut().find(|job| job.ticket == ticket) {
                        job.progress = Some(progress);
                    }
                }
                Event::Done { ticket, applied, .. } => {
                    self.end(ticket);
                    if let Some(made) = applied.iter().find_map(|applied| applied.made_layer) {
                        self.layer = made;
                    }
                    let num_clamped: u64 =
                        applied.iter().map(|applied| applied.notices.num_clamped_heights).sum();
                    if num_clamped > 0 {
                        let text = format!(
                            "{num_clamped} heights would have left what a terrain holds, and were clamped"
                        );
                        messages.push(Message { text, is_error: false });
                    }
                }
                // A survey that was given up with the rest is asked for again.
                Event::Failed { ticket, is_cancelled, .. }
                    if self.overview.take_failed(ticket, is_cancelled) => {}
                Event::Failed { ticket, message, is_cancelled, .. } => {
                    self.end(ticket);
                    if self.past.is_some_and(|past| past.ticket == ticket) {
                        self.close_past()?;
                    }
                    let text =
                        if is_cancelled { "cancelled: nothing was changed".to_owned() } else { message };
                    messages.push(Message { text, is_error: !is_cancelled });
                }
                Event::Changed { is_settled: true, .. } => self.overview.note_changed(),
                Event::Surveyed { ticket, survey } => {
                    self.overview.take(ticket, *survey);
                    messages.extend(self.finish_copying());
                }
                Event::Changed { .. } | Event::Pages(_) => {}
            }
        }
        Ok(messages)
    }

    /// Copies what is selected, as soon as that is known.
    pub fn copy(&mut self) -> Option<Message> {
        self.is_copying = true;
        self.overview.want(&self.session);
        self.finish_copying()
    }

    fn finish_copying(&mut self) -> Option<Message> {
        if !self.is_copying || !self.overview.is_true() {
            return None;
        }
        self.is_copying = false;
        let height_m = |place_m| self.pane.view.ground(place_m).0;
        let survey = self.overview.survey();
        self.copied = survey.and_then(|survey| Copied::selected(&self.path, survey, height_m));
        Some(match &self.copied {
            Some(Copied { region_m: [.., width_m, depth_m], .. }) => {
                let text = format!(
                    "{width_m:.0} m x {depth_m:.0} m are copied: Ctrl+V has them float over the ground"
                );
                Message { text, is_error: false }
            }
            None => {
                let text =
                    "nothing is selected: select what is to be copied, with Rectangle or Lasso".to_owned();
                Message { text, is_error: false }
            }
        })
    }

    fn take_status(&mut self, status: Status) {
        self.status = status;
        if !self.status.layers.iter().any(|layer| layer.id == self.layer) {
            self.layer = self.status.layers.last().map_or(0, |layer| layer.id);
        }
    }

    fn end(&mut self, ticket: Ticket) {
        for job in self.jobs.iter().filter(|job| job.ticket == ticket) {
            tracing::debug!("{}: ended", job.what);
        }
        self.jobs.retain(|job| job.ticket != ticket);
        if self.stroke == Some(ticket) {
            self.end_stroke();
        }
    }

    /// The hand is lifted, or what it draws came to nothing.
    pub fn end_stroke(&mut self) {
        self.stroke = None;
        self.panes_mut().for_each(|pane| pane.view.hold_still(false));
    }

    /// The layer that is worked on.
    #[must_use]
    pub fn current_layer(&self) -> Option<&Layer> {
        self.status.layers.iter().find(|layer| layer.id == self.layer)
    }

    /// Whether strokes change the current layer's mask, as it has no heights of its own.
    #[must_use]
    pub fn has_only_mask(&self) -> bool {
        self.current_layer().is_some_and(|layer| layer.content != LayerContent::Heights)
    }

    /// The terrain's width and depth, metres.
    #[must_use]
    pub fn size_m(&self) -> [f64; 2] {
        size_m(&self.status.grid)
    }
}

fn size_m(grid: &TerrainGrid) -> [f64; 2] {
    [grid.width(), grid.depth()].map(|num| f64::from(num.max(2) - 1) * grid.spacing_m())
}

fn framing(status: &Status, size: [f32; 2]) -> CameraControl {
    let (_, summary) = status.root;
    let [width_m, depth_m] = size_m(&status.grid);
    let low = DVec3::new(0.0, f64::from(summary.bounds.min_m), 0.0);
    let high = DVec3::new(width_m, f64::from(summary.bounds.max_m), depth_m);
    CameraControl::framing(low, high, size)
}
