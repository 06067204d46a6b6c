//! The hand of someone who draws while being watched: points come as they are given, and what they have come to is shown.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use orogeny_field::{PageLayout, PointerSample, SampleRect, TerrainGrid};

use super::cancelling::Cancelling;
use super::event::{Event, Out};
use super::looker::Looker;
use super::participant::By;
use super::waiting::Waiting;
use super::{PageData, PageRequest, Task, Ticket};
use crate::composite::Change;
use crate::hand::{Hand, SoFar};
use crate::{Error, Result};

/// How often it is looked whether the stroke is given up, while no point comes.
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// How long others wait for a stroke; also, how long it may take though they wait.
pub(super) const MAX_WAIT: Duration = Duration::from_secs(2);

/// Points of one stroke out of the tasks of a session.
pub(super) struct LiveHand<'a> {
    pub(super) ticket: Ticket,
    pub(super) by: &'a By,
    pub(super) since: Instant,
    pub(super) grid: TerrainGrid,
    pub(super) layout: PageLayout,
    pub(super) tasks: &'a Receiver<Task>,
    /// What is for when the stroke is over.
    pub(super) waiting: &'a mut Waiting,
    pub(super) looker: &'a mut Looker,
    pub(super) out: &'a Out,
    pub(super) cancelling: &'a Cancelling,
    /// The points so far.
    pub(super) given: Vec<PointerSample>,
    /// Whether what they came to was lost, and they are to be given again.
    pub(super) is_lost: bool,
    pub(super) is_lifted: bool,
    /// Whether it was ended because others waited.
    pub(super) is_cut: bool,
    /// Points that came before it was begun.
    pub(super) early: Vec<PointerSample>,
    /// Whether it was told that something changed.
    pub(super) was_told: bool,
}

impl Hand for LiveHand<'_> {
    fn next_points(&mut self, so_far: &mut SoFar<'_, '_, '_>) -> Result<Option<Vec<PointerSample>>> {
        if std::mem::take(&mut self.is_lost) && !self.given.is_empty() {
            return Ok(Some(self.given.clone()));
        }
        self.tell_changed(so_far);
        let mut points = std::mem::take(&mut self.early);
        while !self.is_lifted {
            if self.cancelling.is_cancelled(self.ticket) {
                return Err(Error::Cancelled);
            }
            if self.since.elapsed() >= MAX_WAIT && self.waiting.is_waited_for(self.by, MAX_WAIT) {
                (self.is_lifted, self.is_cut) = (true, true);
                break;
            }
            // All points that are there are taken at once.
            let task = if points.is_empty() {
                match self.tasks.recv_timeout(LOOK_EVERY) {
                    Ok(task) => task,
                    Err(RecvTimeoutError::Timeout) => continue,
                    Err(RecvTimeoutError::Disconnected) => {
                        self.is_lifted = true;
                        break;
                    }
                }
            } else {
                match self.tasks.try_recv() {
                    Ok(task) => task,
                    Err(_) => break,
                }
            };
            match task {
                Task::Points { stroke, points: new } if stroke == self.ticket => points.extend(new),
                Task::Lift { stroke } if stroke == self.ticket => self.is_lifted = true,
                Task::Look(requests) => self.look(so_far, requests)?,
                // The window is gone: what was drawn so far stays.
                task @ Task::Close => {
                    self.is_lifted = true;
                    self.waiting.push(task);
                }
                task => self.waiting.push(task),
            }
        }
        if points.is_empty() {
            return Ok(None);
        }
        self.given.extend_from_slice(&points);
        Ok(Some(points))
    }

    fn begin_again(&mut self) {
        self.is_lost = true;
    }
}

/// Pages that were looked at, none where they could not be read.
pub(super) fn or_none(pages: Result<Vec<PageData>>) -> Vec<PageData> {
    pages.unwrap_or_else(|err| {
        tracing::warn!("pages could not be looked at: {err}");
        Vec::new()
    })
}

impl LiveHand<'_> {
    /// Every look is answered, and none ends the stroke, unless what it has painted is lost.
    fn look(&mut self, so_far: &mut SoFar<'_, '_, '_>, requests: Vec<PageRequest>) -> Result<()> {
        let (parts, whole): (Vec<_>, Vec<_>) = requests.iter().copied().partition(PageRequest::is_part);
        let looked = self.looker.parts_in(&self.grid, so_far, &parts).and_then(|found| {
            let (mut pages, rest) = match found {
                Some(pages) => (pages, whole),
                None => (Vec::new(), requests),
            };
            if !rest.is_empty() {
                so_far.executor.save(so_far.pages)?;
                pages.extend(or_none(self.looker.pages_in(&self.grid, so_far.pages.recording(), &rest)));
            }
            Ok(pages)
        });
        let (pages, result) = match looked {
            Ok(pages) => (pages, Ok(())),
            Err(err) => (Vec::new(), Err(err)),
        };
        self.out.tell(Event::Pages(pages));
        result
    }

    fn tell_changed(&mut self, so_far: &mut SoFar<'_, '_, '_>) {
        let rect = std::mem::replace(&mut so_far.changed, SampleRect::EMPTY);
        if rect.is_empty() {
            return;
        }
        let change = Change { field: so_far.field, rect };
        let rects = self.looker.forget(&self.grid, self.layout, &[change]);
        self.was_told = true;
        self.out.tell(Event::Changed { rects: Some(rects), is_settled: false });
    }
}
