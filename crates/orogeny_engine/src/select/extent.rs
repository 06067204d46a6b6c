//! Which pages of the selection a change may reach.

use std::collections::{BTreeMap, BTreeSet};

use orogeny_brush::MAX_PAGES;
use orogeny_field::{FieldId, PageKey, PageLayout, SampleRect, SelectCombine, Selecting};

use crate::Result;

/// Where a shape may select anything.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Extent {
    /// Where something is selected already.
    Selected,
    /// Within a rectangle of the terrain.
    Rect(SampleRect),
    /// On these pages, within a rectangle.
    Pages(Vec<PageKey>, SampleRect),
}

/// Rows and columns of pages, in order.
type Places = BTreeSet<(u32, u32)>;

/// The pages that a terrain's selection has: there is nothing selected on any other.
pub(super) struct Pages {
    layout: PageLayout,
    bounds: SampleRect,
    selected: Places,
}

impl Pages {
    pub(super) fn new(layout: PageLayout, bounds: SampleRect, selected: &[PageKey]) -> Self {
        Self { layout, bounds, selected: places(selected) }
    }

    /// The pages that may change where a shape joins the selection and what comes of that spreads by so many samples.
    ///
    /// # Errors
    /// [`orogeny_brush::Error::TooManyPages`].
    pub(super) fn changed(&self, shape: &Extent, selecting: &Selecting, spread: u32) -> Result<Places> {
        if selecting.is_inverted {
            return self.within(self.bounds);
        }
        let has_lengths =
            [selecting.grow_m, selecting.shrink_m, selecting.feather_m].iter().any(|m| *m > 0.0);
        let changed = match selecting.combine {
            SelectCombine::Replace => {
                let mut changed = self.spread(&self.of(shape)?, spread)?;
                changed.extend(&self.selected);
                changed
            }
            // Without a length what lies elsewhere stays as it is.
            SelectCombine::Add if !has_lengths => self.of(shape)?,
            SelectCombine::Add => {
                let mut joined = self.of(shape)?;
                joined.extend(&self.selected);
                self.spread(&joined, spread)?
            }
            SelectCombine::Subtract if !has_lengths => self.selected_within(shape),
            SelectCombine::Subtract | SelectCombine::Intersect => self.spread(&self.selected, spread)?,
        };
        checked(changed.len() as u64)?;
        Ok(changed)
    }

    /// All pages that a shape may select anything of.
    fn of(&self, shape: &Extent) -> Result<Places> {
        match shape {
            Extent::Selected => Ok(self.selected.clone()),
            Extent::Rect(rect) => self.within(*rect),
            Extent::Pages(keys, rect) => {
                let mut pages = places(keys);
                pages.retain(|place| self.is_within(*place, rect));
                checked(pages.len() as u64)?;
                Ok(pages)
            }
        }
    }

    fn selected_within(&self, shape: &Extent) -> Places {
        let mut selected = self.selected.clone();
        match shape {
            Extent::Selected => {}
            Extent::Rect(rect) => selected.retain(|place| self.is_within(*place, rect)),
            Extent::Pages(keys, rect) => {
                let pages = places(keys);
                selected.retain(|place| pages.contains(place) && self.is_within(*place, rect));
            }
        }
        selected
    }

    fn within(&self, rect: SampleRect) -> Result<Places> {
        let rect = rect.intersection(&self.bounds);
        checked(self.layout.num_pages_in(rect))?;
        Ok(self.layout.pages_in(rect).map(|(x, z)| (z, x)).collect())
    }

    fn is_within(&self, (z, x): (u32, u32), rect: &SampleRect) -> bool {
        let page = self.layout.page_rect(&PageKey::full_resolution(FieldId(0), x, z));
        !page.intersection(rect).is_empty()
    }

    /// The pages and all that lie within so many samples of them.
    fn spread(&self, pages: &Places, by: u32) -> Result<Places> {
        let by = by.div_ceil(self.layout.size());
        let last = |end: i32| end.unsigned_abs().saturating_sub(1) / self.layout.size();
        let (last_x, last_z) = (last(self.bounds.x1), last(self.bounds.z1));
        let along = |place: u32, last: u32| place.saturating_sub(by)..=place.saturating_add(by).min(last);
        let mut of_rows = Places::new();
        for (z, x) in pages {
            of_rows.extend(along(*x, last_x).map(|x| (*z, x)));
            checked(of_rows.len() as u64)?;
        }
        let mut spread = Places::new();
        for (z, x) in of_rows {
            spread.extend(along(z, last_z).map(|z| (z, x)));
            checked(spread.len() as u64)?;
        }
        Ok(spread)
    }
}

fn places(keys: &[PageKey]) -> Places {
    keys.iter().map(|key| (key.z, key.x)).collect()
}

fn checked(num_pages: u64) -> Result<()> {
    if num_pages > MAX_PAGES {
        return Err(orogeny_brush::Error::TooManyPages { num_pages, limit: MAX_PAGES }.into());
    }
    Ok(())
}

/// Pages put together into squares of so many a side.
pub(super) fn blocks(pages: Places, field: FieldId, side: u32) -> Vec<Vec<PageKey>> {
    let mut blocks = BTreeMap::<(u32, u32), Vec<PageKey>>::new();
    for (z, x) in pages {
        blocks.entry((z / side, x / side)).or_default().push(PageKey::full_resolution(field, x, z));
    }
    blocks.into_values().collect()
}
