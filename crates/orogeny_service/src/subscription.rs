//! What a client looks at, and which of it has to be sent. Pure.

use std::collections::{HashSet, VecDeque};

use orogeny_engine::session::Status;
use orogeny_engine::{PagePlace, SampleRect};

use crate::frame::FrameFormat;
use crate::reply::Refusal;

/// Pages of a region at a level that a client wants to have as they are.
#[derive(Debug)]
pub(crate) struct Subscription {
    level: u8,
    /// The first page along z and x, and the first beyond them.
    pages: [[u32; 2]; 2],
    pub(crate) format: FrameFormat,
    /// Frames that may be under way.
    window: u32,
    /// Pages that are not at the client as they are, the longest waiting first.
    queue: VecDeque<PagePlace>,
    /// The same, to find them.
    queued: HashSet<PagePlace>,
    /// Pages that were asked for and have not come yet.
    asked_for: HashSet<PagePlace>,
}

/// What a client asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wish {
    /// `[x, z, width, depth]` in metres; `None`: all.
    pub(crate) region_m: Option<[f64; 4]>,
    pub(crate) level: u8,
    pub(crate) format: FrameFormat,
    pub(crate) window: u32,
}

impl Subscription {
    /// A subscription in which nothing has been sent.
    ///
    /// # Errors
    /// When the level or the region is not there, or the pages are too many.
    pub(crate) fn new(wish: Wish, status: &Status, max_pages: u64) -> Result<Self, Refusal> {
        let (grid, layout) = (status.grid, status.layout);
        let top = layout.top_level(&grid);
        if wish.level > top {
            let message = format!("there is no level {}: the coarsest is {top}", wish.level);
            return Err(Refusal::new("unknown_level", message));
        }
        let region = match wish.region_m {
            Some(region_m) => grid
                .samples_in_region(region_m)
                .map_err(|err| Refusal::new("region", err.to_string()))?
                .intersection(&grid.bounds()),
            None => grid.bounds(),
        };
        if region.is_empty() {
            return Err(Refusal::new("region", "the region lies outside the terrain".to_owned()));
        }
        let side = i64::from(layout.size()) << wish.level;
        let page = |sample: i32| u32::try_from(i64::from(sample) / side).unwrap_or_default();
        let pages = [[page(region.z0), page(region.x0)], [page(region.z1 - 1) + 1, page(region.x1 - 1) + 1]];
        let [[z0, x0], [z1, x1]] = pages;
        let num_pages = u64::from(z1 - z0) * u64::from(x1 - x0);
        if num_pages > max_pages {
            let message = format!(
                "the region has {num_pages} pages of level {}: ask for a smaller one, or a coarser level",
                wish.level
            );
            return Err(Refusal::new("too_many_pages", message).with_limit(max_pages));
        }
        let mut subscription = Self {
            level: wish.level,
            pages,
            format: wish.format,
            window: wish.window.max(1),
            queue: VecDeque::new(),
            queued: HashSet::new(),
            asked_for: HashSet::new(),
        };
        subscription.change_all();
        Ok(subscription)
    }

    /// Takes the place of another one, whose pages may still be on their way.
    pub(crate) fn take_over(&mut self, before: Self) {
        self.asked_for = before.asked_for;
    }

    /// Everything changed.
    pub(crate) fn change_all(&mut self) {
        self.change_pages(self.pages);
    }

    /// Samples changed, given for each level, within pages of so many samples a side.
    pub(crate) fn change(&mut self, rects: &[SampleRect], page_size: u32) {
        let Some(rect) = rects.get(usize::from(self.level)) else { return };
        if rect.is_empty() {
            return;
        }
        let page = |sample: i32| u32::try_from(sample.max(0)).unwrap_or_default() / page_size;
        let [[z0, x0], [z1, x1]] = self.pages;
        // A rectangle may reach beyond the terrain, and before it.
        let until = |sample: i32| if sample <= 0 { 0 } else { page(sample - 1) + 1 };
        self.change_pages([
            [page(rect.z0).max(z0), page(rect.x0).max(x0)],
            [until(rect.z1).min(z1), until(rect.x1).min(x1)],
        ]);
    }

    fn change_pages(&mut self, [[z0, x0], [z1, x1]]: [[u32; 2]; 2]) {
        for z in z0..z1 {
            for x in x0..x1 {
                let place = PagePlace { level: self.level, z, x };
                if self.queued.insert(place) {
                    self.queue.push_back(place);
                }
            }
        }
    }

    /// Pages to ask for now, while so many frames are under way.
    pub(crate) fn ask(&mut self, num_under_way: u64, at_most: usize) -> Vec<PagePlace> {
        let under_way = num_under_way.saturating_add(self.asked_for.len() as u64);
        let room = usize::try_from(u64::from(self.window).saturating_sub(under_way)).unwrap_or(usize::MAX);
        let mut pages = Vec::new();
        // One that is on its way already and changed since comes as it is then.
        for _ in 0..self.queue.len() {
            if pages.len() >= room.min(at_most) {
                break;
            }
            let Some(place) = self.queue.pop_front() else { break };
            if self.asked_for.contains(&place) {
                self.queue.push_back(place);
                continue;
            }
            self.queued.remove(&place);
            self.asked_for.insert(place);
            pages.push(place);
        }
        pages
    }

    /// A page has come, as it is after all changes that were told: whether it is to be sent.
    pub(crate) fn arrive(&mut self, place: PagePlace) -> bool {
        let [[z0, x0], [z1, x1]] = self.pages;
        let is_within =
            place.level == self.level && (z0..z1).contains(&place.z) && (x0..x1).contains(&place.x);
        if !self.asked_for.remove(&place) || !is_within {
            return false;
        }
        if self.queued.remove(&place) {
            self.queue.retain(|queued| *queued != place);
        }
        true
    }

    #[cfg(test)]
    fn num_queued(&self) -> usize {
        assert_eq!(self.queue.len(), self.queued.len());
        self.queue.len()
    }
}

#[cfg(test)]
mod tests;
