//! The hand of someone who draws while being watched: points come as they are given, and what they have come to is shown.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use orogeny_field::{PageLayout, PointerSample, SampleRect, TerrainGrid};

use super::event::{Event, Out};
use super::looker::Looker;
use super::serve::Cancelling;
use super::{Task, Ticket};
use crate::composite::Change;
use crate::hand::{Hand, SoFar};
use crate::{Error, Result};

/// How often it is looked whether the stroke is given up, while no point comes.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Points of one stroke out of the tasks of a session.
pub(super) struct LiveHand<'a> {
    pub(super) ticket: Ticket,
    pub(super) grid: TerrainGrid,
    pub(super) layout: PageLayout,
    pub(super) tasks: &'a Receiver<Task>,
    /// Tasks for when the stroke is over.
    pub(super) later: &'a mut VecDeque<Task>,
    pub(super) looker: &'a mut Looker,
    pub(super) out: &'a Out,
    pub(super) cancelling: &'a Cancelling,
    /// The points so far.
    pub(super) given: Vec<PointerSample>,
    /// Whether what they came to was lost, and they are to be given again.
    pub(super) is_lost: bool,
    pub(super) is_lifted: bool,
    /// Whether it was told that something changed.
    pub(super) was_told: bool,
}

impl Hand for LiveHand<'_> {
    fn next_points(&mut self, so_far: &mut SoFar<'_, '_, '_>) -> Result<Option<Vec<PointerSample>>> {
        if std::mem::take(&mut self.is_lost) && !self.given.is_empty() {
            return Ok(Some(self.given.clone()));
        }
        self.tell_changed(so_far);
        let mut points = Vec::new();
        while !self.is_lifted {
            if self.cancelling.is_cancelled(self.ticket) {
                return Err(Error::Cancelled);
            }
            // All points that are there are taken at once.
            let task = if points.is_empty() {
                match self.tasks.recv_timeout(LOOK_EVERY) {
                    Ok(task) => task,
                    Err(RecvTimeoutError::Timeout) => continue,
                    // The window is gone: what was drawn so far stays.
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
                Task::Points(new) => points.extend(new),
                Task::Lift => self.is_lifted = true,
                Task::Look(requests) => {
                    so_far.executor.save(so_far.pages)?;
                    let pages = self.looker.pages_in(&self.grid, so_far.pages.recording(), &requests)?;
                    self.out.tell(Event::Pages(pages));
                }
                task => self.later.push_back(task),
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

impl LiveHand<'_> {
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
