//! The page table: from which page the shaders read a sample. Twin of `shaders/scene/ground.wgsl`.
//!
//! For each level a window of [`TABLE_SIDE`] pages a side around the eye, which is all of the level where that has no more. An entry names the slot and the
//! level of the page that is read: the page itself, or, while that is not there, the next coarser one that is. What lies outside a level's
//! window is read from the next level. So a height depends on its level and sample alone, whichever tile asks: nothing can tear.

use std::collections::HashMap;

use orogeny_field::{PageLayout, TerrainGrid};

use crate::{Holder, PagePlace};

/// Pages a side of each level's window. A power of two.
pub const TABLE_SIDE: u32 = 64;

/// Levels that there may be.
pub const MAX_LEVELS: usize = 16;

/// An entry for which there is no page, not even a coarser one: its heights are those of unpainted ground.
const NO_PAGE: u32 = u32::MAX;

/// Slot bits of an entry; the level is above them. All ones: the page is of constant height.
const SLOT_BITS: u32 = 27;
const CONSTANT_SLOT: u32 = (1 << SLOT_BITS) - 1;

/// The windows, and what is in them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PageTable {
    /// Of each level: the first column and row of pages, and one past the last.
    windows: Vec<[i32; 4]>,
    entries: Vec<u32>,
}

impl PageTable {
    /// For an eye over a sample of full resolution, drawn from these pages.
    #[must_use]
    pub fn new(
        grid: &TerrainGrid,
        layout: PageLayout,
        eye_sample: [i32; 2],
        pages: &HashMap<PagePlace, Holder>,
    ) -> Self {
        let top = layout.top_level(grid);
        let windows: Vec<_> = (0..=top).map(|level| window(grid, layout, level, eye_sample)).collect();
        let num_entries = windows.len() * (TABLE_SIDE * TABLE_SIDE) as usize;
        let mut table = Self { windows, entries: vec![NO_PAGE; num_entries] };
        // From the top, so that what a page falls back to is known.
        for level in (0..=top).rev() {
            let Some([x0, z0, x1, z1]) = table.windows.get(usize::from(level)).copied() else { continue };
            for (z, x) in (z0..z1).flat_map(|z| (x0..x1).map(move |x| (z.unsigned_abs(), x.unsigned_abs()))) {
                let place = PagePlace { level, z, x };
                let slot = pages.get(&place).map(|holder| match holder {
                    Holder::Slot(slot) => *slot,
                    Holder::Constant => CONSTANT_SLOT,
                });
                let entry = match slot {
                    Some(slot) => (u32::from(level) << SLOT_BITS) | slot,
                    None if level < top => table.entry(place.parent()),
                    None => NO_PAGE,
                };
                if let Some(place) = table.entries.get_mut(index(place)) {
                    *place = entry;
                }
            }
        }
        table
    }

    /// Whether a page lies in its level's window.
    fn is_inside(&self, place: PagePlace) -> bool {
        self.windows.get(usize::from(place.level)).is_some_and(|[x0, z0, x1, z1]| {
            (*x0..*x1).contains(&place.x.cast_signed()) && (*z0..*z1).contains(&place.z.cast_signed())
        })
    }

    /// The entry of a page; [`NO_PAGE`] outside its level's window.
    fn entry(&self, place: PagePlace) -> u32 {
        let entry = if self.is_inside(place) { self.entries.get(index(place)) } else { None };
        entry.copied().unwrap_or(NO_PAGE)
    }

    /// From which level a page is read and what holds that; `None` where there is nothing. Of one outside its level's window, that of the
    /// first above it inside one, as the shaders do.
    #[must_use]
    pub fn lookup(&self, place: PagePlace) -> Option<(u8, Holder)> {
        let above =
            |place: &PagePlace| (usize::from(place.level) + 1 < self.windows.len()).then(|| place.parent());
        let inside = std::iter::successors(Some(place), above).find(|place| self.is_inside(*place))?;
        let entry = self.entry(inside);
        let holder = match entry & CONSTANT_SLOT {
            CONSTANT_SLOT => Holder::Constant,
            slot => Holder::Slot(slot),
        };
        // Five bits.
        (entry != NO_PAGE).then_some(((entry >> SLOT_BITS) as u8, holder))
    }

    /// As the shaders have it: level by level, row by row, wrapped around.
    #[must_use]
    pub fn entries(&self) -> &[u32] {
        &self.entries
    }

    /// Each level's window, in pages: the first column and row, and one past the last. Levels that there are not have an empty one.
    #[must_use]
    pub fn windows(&self) -> [[i32; 4]; MAX_LEVELS] {
        let mut all = [[0; 4]; MAX_LEVELS];
        for (to, from) in all.iter_mut().zip(&self.windows) {
            *to = *from;
        }
        all
    }
}

/// Where an entry is: a window moves with the eye, an entry stays where it is.
fn index(PagePlace { level, z, x }: PagePlace) -> usize {
    const MASK: u32 = TABLE_SIDE - 1;
    ((u32::from(level) * TABLE_SIDE + (z & MASK)) * TABLE_SIDE + (x & MASK)) as usize
}

fn window(grid: &TerrainGrid, layout: PageLayout, level: u8, eye_sample: [i32; 2]) -> [i32; 4] {
    const SIDE: i32 = TABLE_SIDE.cast_signed();
    let (columns, rows) = layout.num_pages_at(grid, level);
    let along = |eye: i32, num: u32| {
        let num = num.cast_signed();
        let page = (eye >> level).div_euclid(layout.size().cast_signed());
        let first = (page - SIDE / 2).clamp(0, (num - SIDE).max(0));
        (first, (first + SIDE).min(num))
    };
    let ((x0, x1), (z0, z1)) = (along(eye_sample[0], columns), along(eye_sample[1], rows));
    [x0, z0, x1, z1]
}
