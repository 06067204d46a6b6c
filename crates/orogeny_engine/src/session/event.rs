//! What a session tells.

use std::sync::mpsc::Sender;

use orogeny_field::{HeightBounds, Page, SampleRect};
use orogeny_geomip::{PagePlace, PageSummary};
use orogeny_gpu::DevicePlane;
use orogeny_store::EntryId;

use super::{Status, Survey};
use crate::{Applied, Progress};

/// Names something that was asked for; later ones are higher.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Ticket(pub u64);

/// What happened.
#[derive(Debug)]
pub enum Event {
    /// Something that was asked for is being done.
    Progress {
        /// What.
        ticket: Ticket,
        /// How far it has come.
        progress: Progress,
    },
    /// A survey that was asked for.
    Surveyed {
        /// What asked for it.
        ticket: Ticket,
        /// The terrain in few heights.
        survey: Box<Survey>,
    },
    /// Something is done, and on disk.
    Done {
        /// What.
        ticket: Ticket,
        /// What operations did; empty for what is none.
        applied: Vec<Applied>,
        /// The entries that were recorded for it.
        entries: Vec<EntryId>,
        /// How many points were drawn of a stroke that was ended before the hand was lifted, because others had waited for it too long.
        cut_after: Option<usize>,
    },
    /// Something was not done, and changed nothing.
    Failed {
        /// What.
        ticket: Ticket,
        /// Why, and what to do about it.
        message: String,
        /// Whether it was given up because that was asked for.
        is_cancelled: bool,
        /// Whether the machine is to blame, and not what was asked for.
        is_fault: bool,
    },
    /// What is seen changed: pages over it are no longer as they were.
    Changed {
        /// Where, for each level, in its samples, which may reach beyond the terrain; `None`: everywhere.
        rects: Option<Vec<SampleRect>>,
        /// Whether that is for good, and not a stroke on its way.
        is_settled: bool,
    },
    /// Layers, history and more, as they are now. The first event of all.
    Status(Box<Status>),
    /// Pages that were asked for.
    Pages(Vec<PageData>),
}

/// A page, or a part of it.
#[derive(Debug, Clone, PartialEq)]
pub struct PageData {
    /// Which.
    pub place: PagePlace,
    /// What of it, in samples of its level, within the terrain.
    pub rect: SampleRect,
    /// Heights of the composite over the rectangle, row by row; none while a stroke is drawn, where they lie on the device.
    pub heights: Vec<f32>,
    /// The same as they lie on the device that the terrain's settings [share](crate::Settings::sharing), where they do.
    pub on_device: Option<DevicePlane>,
    /// What heights without [`Self::heights`] lie within.
    pub bounds: Option<HeightBounds>,
    /// Up to four masks over the whole page, 255 for 1, where any are shown.
    pub masks: Option<Vec<[u8; 4]>>,
    /// What these masks are where nothing was painted; `None` while a stroke is drawn.
    pub unpainted_masks: Option<[f32; 4]>,
    /// The whole page as it was then, where a past is open, of a page that is whole.
    pub earlier: Option<Earlier>,
    /// What is known of the page and of those below it, and of how they were then; nothing while a stroke is drawn.
    pub summaries: Vec<(PagePlace, PageSummary)>,
}

/// A page as it was at an earlier entry of the history.
#[derive(Debug, Clone, PartialEq)]
pub struct Earlier {
    /// All of its heights, metres, those beyond the terrain's edge too.
    pub page: Page,
    /// The composite where nothing was painted then, metres.
    pub unpainted_m: f32,
}

/// Where events go.
pub(super) struct Out {
    sender: Sender<Event>,
    wake: Box<dyn Fn() + Send>,
}

impl Out {
    pub(super) fn new(sender: Sender<Event>, wake: impl Fn() + Send + 'static) -> Self {
        Self { sender, wake: Box::new(wake) }
    }

    pub(super) fn tell(&self, event: Event) {
        // Whoever listened may be gone; the thread ends when no tasks can come.
        self.sender.send(event).ok();
        (self.wake)();
    }
}
