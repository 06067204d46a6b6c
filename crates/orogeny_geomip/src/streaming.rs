//! Which pages a picture wants, most urgent first, and which of those that are there it is drawn from.

use std::collections::{HashMap, HashSet};

use orogeny_field::{PageLayout, TerrainGrid};

use crate::{Bounds, Camera, DetailRule, Frustum, Metric, PagePlace, PageRelief, PageSummaries};

/// How many pixels a sample may be wide before light shows that there are finer ones.
const MAX_SAMPLE_PX: f64 = 1.0;

/// What holds a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Holder {
    /// A slot of the page texture.
    Slot(u32),
    /// Nothing: it is all of the height that unpainted ground has.
    Constant,
}

/// The pages that a picture wants, most urgent first, no more than `max_pages` that have to be held: the root, then those whose parents would be off by the
/// most pixels. Those of constant height come along without being counted. Also how many pages there was no room for.
#[must_use]
pub fn wanted_pages<S: PageSummaries>(
    grid: &TerrainGrid,
    layout: PageLayout,
    camera: &Camera,
    rule: &DetailRule,
    relief: &PageRelief<'_, S>,
    max_pages: usize,
) -> (Vec<PagePlace>, usize) {
    let frustum = Frustum::of(camera);
    let mut found: Vec<(f64, PagePlace)> = Vec::new();
    let mut open = vec![(f64::INFINITY, PagePlace::root(grid, layout))];
    while let Some((urgency, place)) = open.pop() {
        found.push((urgency, place));
        let summary = relief.summary(place);
        if summary.is_constant || place.level == 0 {
            continue;
        }
        let bounds =
            Bounds::of_samples(place.samples(grid, layout), relief.page_bounds(place), grid.spacing_m());
        if !frustum.may_show(&bounds) {
            continue;
        }
        // A tile's detail is that of its ring, so what lies a tile further off counts too.
        let beyond_m = f64::from(crate::TILE_CELLS << (place.level - 1)) * grid.spacing_m();
        let distance_m = bounds.grown(beyond_m).distance_m(camera.eye_m());
        // Metres that are a pixel high at that distance.
        let pixel_m = distance_m / camera.pixels_at_one_metre();
        let sample_m = grid.spacing_m() * f64::from(1_u32 << place.level);
        let error_m = match rule.metric {
            Metric::Roughness => f64::from(summary.error_m),
            Metric::FromAbove => sample_m,
        };
        let excess =
            (error_m / rule.max_error_px.max(0.1)).max(sample_m / MAX_SAMPLE_PX) / pixel_m.max(1.0e-9);
        if excess > 1.0 {
            // None before its parent.
            let urgency = excess.min(urgency);
            open.extend(place.children(grid, layout).map(|child| (urgency, child)));
        }
    }
    found.sort_by(|(a, first), (b, second)| {
        b.total_cmp(a).then(second.level.cmp(&first.level)).then(first.cmp(second))
    });
    let mut num_held = 0;
    found.retain(|(_, place)| {
        let is_held = !relief.summary(*place).is_constant;
        num_held += usize::from(is_held);
        !is_held || num_held <= max_pages
    });
    let num_left_out = num_held.saturating_sub(max_pages);
    (found.into_iter().map(|(_, place)| place).collect(), num_left_out)
}

/// Which pages are in which slots.
#[derive(Debug)]
pub struct Slots {
    free: Vec<u32>,
    held: HashMap<PagePlace, Held>,
    /// Counts pictures.
    now: u64,
}

#[derive(Debug)]
struct Held {
    slot: u32,
    last_wanted: u64,
}

impl Slots {
    /// With room for so many pages.
    #[must_use]
    pub fn new(num_slots: u32) -> Self {
        Self { free: (0..num_slots).rev().collect(), held: HashMap::new(), now: 0 }
    }

    /// Notes what the next picture wants, and gives what of it is not there, in the same order.
    pub fn want(&mut self, wanted: &[PagePlace]) -> Vec<PagePlace> {
        self.now += 1;
        let now = self.now;
        wanted
            .iter()
            .filter(|place| match self.held.get_mut(place) {
                Some(held) => {
                    held.last_wanted = now;
                    false
                }
                None => true,
            })
            .copied()
            .collect()
    }

    /// The slot for a page that has arrived: the one that it has, a free one, or that of the page that was not wanted for longest. `None` where all are wanted.
    pub fn admit(&mut self, place: PagePlace) -> Option<u32> {
        let now = self.now;
        if let Some(held) = self.held.get_mut(&place) {
            held.last_wanted = now;
            return Some(held.slot);
        }
        let slot = self.free.pop().or_else(|| {
            let oldest = self.held.iter().filter(|(_, held)| held.last_wanted < now);
            let (place, _) = oldest.min_by_key(|(place, held)| (held.last_wanted, **place))?;
            let place = *place;
            self.held.remove(&place).map(|held| held.slot)
        })?;
        self.held.insert(place, Held { slot, last_wanted: now });
        Some(slot)
    }

    /// The slot of a page that is there.
    #[must_use]
    pub fn slot(&self, place: PagePlace) -> Option<u32> {
        self.held.get(&place).map(|held| held.slot)
    }

    /// Forgets pages: what they hold is no longer so.
    pub fn forget(&mut self, is_forgotten: impl Fn(&PagePlace) -> bool) {
        let forgotten: HashSet<_> = self.held.keys().filter(|place| is_forgotten(place)).copied().collect();
        self.free.extend(forgotten.iter().filter_map(|place| self.held.remove(place)).map(|held| held.slot));
    }

    /// Pages that are there.
    #[must_use]
    pub fn num_held(&self) -> usize {
        self.held.len()
    }
}
