//! What a live view knows of a terrain: pages that are there, with what of them is stale, and summaries.

use std::collections::{HashMap, HashSet};

use orogeny_field::{HeightBounds, Page, PageLayout, SampleRect, TerrainGrid};
use orogeny_geomip::{Ground, PagePlace, PageRelief, PageSummaries, PageSummary, Tile};

use crate::composite::usual_error_m;
use crate::session::{PageData, Status};
use crate::view::{higher_m, most_m, page_rect};

/// Pages and summaries, as far as they have arrived.
#[derive(Debug)]
pub(super) struct Known {
    pub(super) grid: TerrainGrid,
    pub(super) layout: PageLayout,
    pub(super) unpainted_m: f32,
    summaries: HashMap<PagePlace, PageSummary>,
    held: HashMap<PagePlace, Held>,
    /// While a stroke is drawn, pages as they were when it began, of those that changed since; `None`: it was not there.
    before: Option<HashMap<PagePlace, Option<Page>>>,
    /// What of pages was stale when it began.
    stale_before: HashMap<PagePlace, SampleRect>,
    /// Pages whose summary, and those of the pages below them, may no longer be true.
    stale_summaries: HashSet<PagePlace>,
}

/// A page that arrived.
#[derive(Debug)]
struct Held {
    page: Page,
    /// How it was, and the most by which it differs from that, metres; where a past is open.
    earlier: Option<(Page, f32)>,
    /// What of it is no longer so, in samples of its level.
    stale: SampleRect,
    /// What of it is drawn as it is now, and is not known here.
    unknown: SampleRect,
}

impl Known {
    pub(super) fn new(status: &Status) -> Self {
        Self {
            grid: status.grid,
            layout: status.layout,
            unpainted_m: status.unpainted_m,
            summaries: HashMap::from([status.root]),
            held: HashMap::new(),
            before: None,
            stale_before: HashMap::new(),
            stale_summaries: HashSet::new(),
        }
    }

    pub(super) fn take_status(&mut self, status: &Status) {
        self.unpainted_m = status.unpainted_m;
        self.summaries.extend([status.root]);
    }

    /// The part of the terrain's level that a page covers, in samples of that level.
    fn rect_of(&self, place: PagePlace) -> SampleRect {
        page_rect(self.layout, place).intersection(&self.grid.bounds_at(place.level))
    }

    /// Notes that what is seen has changed, for each level.
    pub(super) fn note_changed(&mut self, rects: Option<&[SampleRect]>, is_settled: bool) {
        let everywhere = |level| self.grid.bounds_at(level);
        let rect_at = |level: u8| match rects {
            None => everywhere(level),
            // What is not told of a level has not changed.
            Some(rects) => rects.get(usize::from(level)).copied().unwrap_or(SampleRect::EMPTY),
        };
        let layout = self.layout;
        let changed_of = |place: &PagePlace| page_rect(layout, *place).intersection(&rect_at(place.level));
        for (place, held) in &mut self.held {
            let changed = changed_of(place);
            if !changed.is_empty() {
                held.stale = held.stale.bounds_with(&changed);
            }
        }
        let spacing_m = self.grid.spacing_m();
        let held = &self.held;
        let stale_summaries = &mut self.stale_summaries;
        self.summaries.retain(|place, summary| {
            if changed_of(place).is_empty() {
                return true;
            }
            if is_settled {
                stale_summaries.insert(*place);
                // One that is no longer known is found out when its parent is.
                return held.contains_key(place) || rects.is_some() && !summary.is_constant;
            }
            // Until it is known: as rough as ground usually is.
            summary.is_constant = false;
            summary.error_m = summary.error_m.max(usual_error_m(spacing_m, place.level));
            true
        });
    }

    /// Takes a page or a part of one; gives the page where it is now there, and what of it is new: first sample and number of samples.
    pub(super) fn take(&mut self, data: &PageData) -> Option<(&Page, [u32; 2], [u32; 2])> {
        let place = data.place;
        if data.summaries.is_empty() {
            self.widen(data);
        } else {
            self.stale_summaries.remove(&place);
            self.summaries.extend(data.summaries.iter().copied());
        }
        if data.rect.is_empty() {
            return None;
        }
        let whole = self.rect_of(place);
        if let Some(before) = &mut self.before {
            before.entry(place).or_insert_with(|| self.held.get(&place).map(|held| held.page.clone()));
        }
        let layout = self.layout;
        if data.rect == whole {
            let fresh = || Held {
                page: Page::constant(layout, 0.0),
                earlier: None,
                stale: SampleRect::EMPTY,
                unknown: SampleRect::EMPTY,
            };
            self.held.entry(place).or_insert_with(fresh);
        }
        let held = self.held.get_mut(&place)?;
        let page_rect = page_rect(layout, place);
        let first = [data.rect.x0.abs_diff(page_rect.x0), data.rect.z0.abs_diff(page_rect.z0)];
        let num = [data.rect.width(), data.rect.depth()];
        if data.heights.is_empty() {
            held.unknown = held.unknown.bounds_with(&data.rect);
        } else if data.rect.contains(&held.unknown) {
            held.unknown = SampleRect::EMPTY;
        }
        for (row, samples) in (first[1]..).zip(data.heights.chunks_exact(num[0].max(1) as usize)) {
            if let Some(to) = held.page.row_mut(row, first[0], first[0] + num[0]) {
                to.copy_from_slice(samples);
            }
        }
        if data.rect == whole {
            held.earlier = data.earlier.as_ref().map(|earlier| (earlier.page.clone(), 0.0));
        }
        if let Some((earlier, most)) = &mut held.earlier {
            *most = most_m(&higher_m(&held.page, earlier));
        }
        Some((&held.page, first, num))
    }

    /// A page that is there, as it is and, where that is known, as it was.
    pub(super) fn page(&self, place: PagePlace) -> Option<(&Page, Option<&Page>)> {
        let held = self.held.get(&place)?;
        Some((&held.page, held.earlier.as_ref().map(|(earlier, _)| earlier)))
    }

    /// The pages that are there.
    pub(super) fn places(&self) -> Vec<PagePlace> {
        self.held.keys().copied().collect()
    }

    /// The most by which pages differ from how they were, of those that are shown, metres; `None` where that is known of none.
    pub(super) fn difference_m(&self, is_shown: impl Fn(PagePlace) -> bool) -> Option<f32> {
        let shown = self.held.iter().filter(|(place, _)| is_shown(**place));
        shown.filter_map(|(_, held)| held.earlier.as_ref().map(|(_, most_m)| *most_m)).reduce(f32::max)
    }

    /// Bounds that hold what has arrived of a stroke on its way, of the page and of those above it.
    fn widen(&mut self, data: &PageData) {
        let Some(new) = data.bounds.or_else(|| HeightBounds::of_row(&data.heights)) else { return };
        let root = PagePlace::root(&self.grid, self.layout);
        let mut place = data.place;
        loop {
            if let Some(summary) = self.summaries.get_mut(&place) {
                summary.bounds = summary.bounds.with(new);
            }
            if place.level >= root.level {
                break;
            }
            place = place.parent();
        }
    }

    /// Whether [`Self::height_at`] goes on telling heights as they are now, whatever arrives: a stroke that is drawn over them then does not depend on
    /// how fast it is seen.
    pub(super) fn hold_still(&mut self, is_still: bool) {
        if self.before.is_none() && is_still {
            let stale = self.held.iter().filter(|(_, held)| !held.stale.is_empty());
            self.stale_before = stale.map(|(place, held)| (*place, held.stale)).collect();
        }
        self.before = match self.before.take() {
            Some(before) if is_still => Some(before),
            _ => is_still.then(HashMap::new),
        };
    }

    /// What is drawn and not known here is asked for again.
    pub(super) fn doubt_unknown(&mut self) {
        for held in self.held.values_mut() {
            held.stale = held.stale.bounds_with(&std::mem::replace(&mut held.unknown, SampleRect::EMPTY));
        }
    }

    /// Drops pages of which `is_kept` says that they need not be there.
    pub(super) fn retain(&mut self, is_kept: impl Fn(&PagePlace) -> bool) {
        self.held.retain(|place, _| is_kept(place));
    }

    /// What of pages that are there is stale, and is taken to be asked for; coarse pages first, as they cover more.
    pub(super) fn take_stale(
        &mut self,
        is_shown: impl Fn(PagePlace) -> bool,
    ) -> Vec<(PagePlace, SampleRect)> {
        let stale = self.held.iter_mut().filter(|(place, held)| !held.stale.is_empty() && is_shown(**place));
        let mut stale: Vec<_> = stale
            .map(|(place, held)| (*place, std::mem::replace(&mut held.stale, SampleRect::EMPTY)))
            .collect();
        stale.sort_by(|(a, _), (b, _)| b.cmp(a));
        stale
    }

    /// Whether anything of these pages is stale.
    pub(super) fn has_stale(&self, is_shown: impl Fn(PagePlace) -> bool) -> bool {
        self.held.iter().any(|(place, held)| !held.stale.is_empty() && is_shown(*place))
    }

    /// Pages whose summaries are stale, and are taken to be asked for; those that are not wanted are forgotten with what is known of them.
    pub(super) fn take_stale_summaries(&mut self, is_wanted: impl Fn(&PagePlace) -> bool) -> Vec<PagePlace> {
        let (wanted, others): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.stale_summaries).into_iter().partition(is_wanted);
        let root = PagePlace::root(&self.grid, self.layout);
        for place in others.iter().filter(|place| **place != root) {
            self.summaries.remove(place);
        }
        wanted
    }

    /// Lowest and highest height of the terrain, metres.
    pub(super) fn range_m(&self) -> [f32; 2] {
        let bounds = self.summary(PagePlace::root(&self.grid, self.layout)).bounds;
        [bounds.min_m, bounds.max_m]
    }

    /// Whether what a page tells of a place is no longer so.
    fn is_stale(&self, place: PagePlace, [x, z]: [f64; 2]) -> bool {
        let stale = match &self.before {
            Some(_) => self.stale_before.get(&place),
            None => self.held.get(&place).map(|held| &held.stale),
        };
        let (x, z) = (x.floor() as i32, z.floor() as i32);
        stale.is_some_and(|stale| stale.contains(&SampleRect::new(x, z, x + 1, z + 1)))
    }

    /// The height at a place between samples of a level's page, from that page alone: where it ends, its last samples go on.
    /// `None` where it is not there, or is not to be trusted.
    fn height_in(&self, level: u8, [x, z]: [f64; 2], is_stale_good: bool) -> Option<f32> {
        let size = self.layout.size();
        let column = (x.max(0.0) as u32) / size;
        let row = (z.max(0.0) as u32) / size;
        let place = PagePlace { level, z: row, x: column };
        if !is_stale_good && self.is_stale(place, [x, z]) {
            return None;
        }
        let before = self.before.as_ref().and_then(|before| before.get(&place));
        let page = match before {
            Some(before) => before.as_ref()?,
            None => &self.held.get(&place)?.page,
        };
        let bounds = self.grid.bounds_at(level);
        let last = [bounds.x1, bounds.z1].map(|end| end.unsigned_abs().saturating_sub(1));
        let along = |at: f64, page: u32, last: u32| {
            let first = page * size;
            let at = at.clamp(f64::from(first), f64::from(last));
            let whole = (at as u32).min(last);
            let next = (whole + 1).min(last).min(first + size - 1);
            (whole - first, next - first, (at - f64::from(whole)) as f32)
        };
        let (x0, x1, across) = along(x, column, last[0]);
        let (z0, z1, down) = along(z, row, last[1]);
        let sample = |x: u32, z: u32| page.row(z, x, x + 1).and_then(|row| row.first().copied());
        let (a, b, c, d) = (sample(x0, z0)?, sample(x1, z0)?, sample(x0, z1)?, sample(x1, z1)?);
        let (upper, lower) = (a + (b - a) * across, c + (d - c) * across);
        Some(upper + (lower - upper) * down)
    }

    /// The height between samples of full resolution, from the finest page that is there and true. Pages that are not drawn are not asked
    /// for again when they become stale: they count where nothing else is there.
    pub(super) fn height_at(&self, [x, z]: [f64; 2]) -> f32 {
        let top = self.layout.top_level(&self.grid);
        let finest = |is_stale_good| {
            (0..=top).find_map(|level| {
                let scale = f64::from(1_u32 << level);
                self.height_in(level, [x / scale, z / scale], is_stale_good)
            })
        };
        finest(false).or_else(|| finest(true)).unwrap_or(self.unpainted_m)
    }
}

impl PageSummaries for Known {
    fn summary(&self, place: PagePlace) -> PageSummary {
        if let Some(summary) = self.summaries.get(&place) {
            return *summary;
        }
        // Until it is known, it is within what it is a part of, and nothing below it is looked for.
        let root = PagePlace::root(&self.grid, self.layout);
        let mut above = place;
        while above.level < root.level {
            above = above.parent();
            if let Some(summary) = self.summaries.get(&above) {
                return PageSummary { bounds: summary.bounds, error_m: 0.0, is_constant: false };
            }
        }
        PageSummary { bounds: HeightBounds::of(self.unpainted_m), error_m: 0.0, is_constant: false }
    }
}

impl Ground for Known {
    fn bounds(&self, tile: Tile) -> HeightBounds {
        PageRelief::new(self.grid, self.layout, self).tile_bounds(tile)
    }

    fn height_m(&self, [x, z]: [u32; 2]) -> f32 {
        self.height_at([f64::from(x), f64::from(z)])
    }
}
