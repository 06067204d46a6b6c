//! What waits while a stroke is drawn: tasks, and the points of strokes that are not drawn yet.

use std::collections::{HashMap, VecDeque};
use std::time::{Duration, Instant};

use orogeny_field::PointerSample;

use super::participant::By;
use super::{Task, Ticket};

/// Tasks for later, in the order in which they came.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    tasks: VecDeque<(Instant, Task)>,
    /// What has come of strokes that are among the tasks.
    strokes: HashMap<Ticket, Drawn>,
}

/// What has come of a stroke.
#[derive(Debug, Default)]
pub(super) struct Drawn {
    pub(super) points: Vec<PointerSample>,
    pub(super) is_lifted: bool,
    /// Whether it was ended because others waited.
    pub(super) is_cut: bool,
}

impl Waiting {
    /// Keeps a task that came while another one is done.
    pub(super) fn push(&mut self, task: Task) {
        match task {
            Task::Points { stroke, points } => {
                // Of one that has failed, or ended, nothing is kept.
                if let Some(drawn) = self.strokes.get_mut(&stroke) {
                    drawn.points.extend(points);
                }
            }
            Task::Lift { stroke } => {
                if let Some(drawn) = self.strokes.get_mut(&stroke) {
                    drawn.is_lifted = true;
                }
            }
            task => {
                if let Task::Stroke { ticket, .. } = task {
                    self.strokes.insert(ticket, Drawn::default());
                }
                self.tasks.push_back((Instant::now(), task));
            }
        }
    }

    /// The next task.
    pub(super) fn pop(&mut self) -> Option<Task> {
        self.tasks.pop_front().map(|(_, task)| task)
    }

    /// What has come of a stroke that begins now.
    pub(super) fn take_stroke(&mut self, ticket: Ticket) -> Drawn {
        self.strokes.remove(&ticket).unwrap_or_default()
    }

    /// Whether someone else has waited for so long to change the terrain.
    pub(super) fn is_waited_for(&self, by: &By, limit: Duration) -> bool {
        let is_other = |task: &Task| task.by().is_some_and(|other| !other.is(by));
        self.tasks.iter().any(|(since, task)| is_other(task) && since.elapsed() >= limit)
    }
}
