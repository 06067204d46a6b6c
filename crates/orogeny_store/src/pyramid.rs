//! The levels above full resolution, kept up with it: an edit refreshes the samples above those that it changed, and no
//! others.
//!
//! A page above level 0 is a function of the pages below it alone, so undo, redo and every order of edits lead to the same
//! bits as making it from scratch. It is there where any of the four pages that it covers is, or where a neighbour's edge
//! reaches into it or to its last cells; elsewhere the field's constant is right. Its lowest and highest height are those of full resolution
//! below it, its revision is the latest below it, its error is the largest below it and what its own level adds to that, but at least
//! [`MIN_ERROR_GROWTH`] times that.

use std::collections::BTreeMap;
use std::sync::Arc;

use orogeny_field::{
    HeightBounds, MIN_ERROR_GROWTH, Page, PageKey, PageLayout, SampleRect, TerrainGrid, rect_above,
    rect_below,
};
use orogeny_reference::field::coarsen;
use rayon::prelude::*;

use crate::cache::Content;
use crate::content::{self, changed_rect};
use crate::database::Database;
use crate::rows::{PageInfo, PageRow};
use crate::{EntryId, Error, Result, codec};

/// Pages that are made at once: with what they are made of, up to ten pages each.
const BATCH_PAGES: usize = 8;

/// What changed of which pages, in samples of their level. A page may be there with nothing changed: then its revision
/// or its bounds did.
pub(crate) type Changed = BTreeMap<PageKey, SampleRect>;

/// Notes that part of a page changed.
pub(crate) fn note(changed: &mut Changed, key: PageKey, rect: &SampleRect) {
    let all = changed.entry(key).or_insert(SampleRect::EMPTY);
    *all = all.bounds_with(rect);
}

/// How a field's pages lie and what it holds where it has none.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) grid: TerrainGrid,
    pub(crate) layout: PageLayout,
    pub(crate) constant: f32,
}

/// All of these pages, as if they had just been painted; one that no terrain has is left out.
pub(crate) fn all_of(
    grid: &TerrainGrid,
    layout: PageLayout,
    keys: impl IntoIterator<Item = PageKey>,
) -> Changed {
    let there = keys.into_iter().filter(|key| layout.has_page(grid, key));
    there.map(|key| (key, layout.page_rect(&key).intersection(&grid.bounds_at(key.level)))).collect()
}

/// What becomes of a page above level 0.
struct Made {
    key: PageKey,
    outcome: Outcome,
    changed: SampleRect,
}

enum Outcome {
    /// It is written.
    Page { content: Content, row: PageRow },
    /// It is absent.
    Absent,
    /// It cannot be made, since what it is made of is damaged, and so is it, or it is missing. It stays damaged or becomes so:
    /// that is seen, where its absence would count as the field's constant. Above it, the last whole level stays what it is.
    Damaged(PageInfo),
}

/// What a page is made of.
struct Material {
    key: PageKey,
    old: Option<Content>,
    /// What has to be made anew.
    rect: SampleRect,
    below: BTreeMap<PageKey, Content>,
    /// Of what it is made of, the pages that are damaged: what reads them stays as it is.
    damaged_below: Vec<PageKey>,
    /// Whether no page is damaged of those that its error is worked out from.
    is_error_known: bool,
    /// What the directory has for an error that cannot be worked out.
    error_to_keep_m: Option<f32>,
    /// Of the pages that it covers; `None`: there are none.
    info: Option<PageInfo>,
}

/// Makes all pages above the changed ones anew, in the running transaction. `constant` gives a field's constant.
pub(crate) fn refresh(
    db: &Database,
    grid: TerrainGrid,
    layout: PageLayout,
    constant: impl Fn(&PageKey) -> f32,
    changed: Changed,
) -> Result<()> {
    let mut changed = changed;
    for level in 1..=layout.top_level(&grid) {
        let above = pages_above(&grid, layout, level, &changed);
        changed = Changed::new();
        let above: Vec<_> = above.into_iter().collect();
        for batch in above.chunks(BATCH_PAGES) {
            let gather = |(key, rect): &(PageKey, SampleRect)| {
                let plane = Plane { grid, layout, constant: constant(key) };
                Ok((plane, gather(db, &plane, *key, *rect)?))
            };
            let materials = batch.iter().map(gather).collect::<Result<Vec<_>>>()?;
            let pace = &*db.pace;
            let made = materials
                .into_par_iter()
                .map(|(plane, material)| {
                    pace.wait();
                    material.make(&plane)
                })
                .collect::<Result<Vec<_>>>()?;
            for made in made {
                write(db, &made)?;
                changed.insert(made.key, made.changed);
            }
        }
    }
    Ok(())
}

/// The page as it would be made now, all of it: for comparing with the one that is there.
pub(crate) fn made_from_scratch(db: &Database, plane: &Plane, key: PageKey) -> Result<Option<Content>> {
    let rect = plane.layout.page_rect(&key).intersection(&plane.grid.bounds_at(key.level));
    let material = Material { old: None, ..gather(db, plane, key, rect)? };
    if !material.damaged_below.is_empty() {
        return Err(Error::damaged_page(key, "a page below it is damaged"));
    }
    // An error that cannot be worked out is the one that the page has.
    let as_it_is_m = material.error_to_keep_m;
    match material.make(plane)?.outcome {
        Outcome::Page { content, .. } => {
            let error_m = as_it_is_m.unwrap_or(content.error_m);
            Ok(Some(Content { error_m, ..content }))
        }
        Outcome::Absent | Outcome::Damaged(_) => Ok(None),
    }
}

/// The pages of a level that the changes below it may reach, with what of them.
pub(crate) fn pages_above(grid: &TerrainGrid, layout: PageLayout, level: u8, changed: &Changed) -> Changed {
    let bounds = grid.bounds_at(level);
    let mut above = Changed::new();
    for (key, rect) in changed {
        note(&mut above, key.parent(), &SampleRect::EMPTY);
        let rect = rect_above(rect).intersection(&bounds);
        // A page's error looks at the first samples of the next pages, too.
        let looked_at = SampleRect::new(rect.x0 - 1, rect.z0 - 1, rect.x1, rect.z1).intersection(&bounds);
        for (x, z) in layout.pages_in(if rect.is_empty() { rect } else { looked_at }) {
            let key = PageKey { field: key.field, level, z, x };
            note(&mut above, key, &layout.page_rect(&key).intersection(&rect));
        }
    }
    above
}

fn gather(db: &Database, plane: &Plane, key: PageKey, rect: SampleRect) -> Result<Material> {
    let Plane { grid, layout, .. } = *plane;
    let whole = layout.page_rect(&key).intersection(&grid.bounds_at(key.level));
    let (rect, old) = match content::content(db, layout, &key) {
        Ok(Some(old)) => (rect, Some(old)),
        // New, or missing: whatever is below it counts. A damaged one is made anew.
        Ok(None) | Err(Error::DamagedPage { .. }) => (whole, None),
        Err(err) => return Err(err),
    };
    let level_below = key.level.saturating_sub(1);
    let bounds_below = grid.bounds_at(level_below);
    let read = rect_below(&rect).intersection(&bounds_below);
    // Its error is that of all of it, whatever of it changes, up to the first samples of the next pages.
    let of_error = rect_below(&SampleRect { x1: whole.x1 + 1, z1: whole.z1 + 1, ..whole });
    let all = read.bounds_with(&of_error.intersection(&bounds_below));
    let keys: Vec<_> =
        layout.pages_in(all).map(|(x, z)| PageKey { field: key.field, level: level_below, z, x }).collect();
    let (mut below, mut damaged_below, mut is_error_known) = (BTreeMap::new(), Vec::new(), true);
    for (key, content) in keys.iter().zip(content::contents(db, layout, &keys)?) {
        match content {
            Ok(content) => below.extend(content.map(|content| (*key, content))),
            Err(Error::DamagedPage { .. }) => {
                is_error_known = false;
                if !layout.page_rect(key).intersection(&read).is_empty() {
                    damaged_below.push(*key);
                }
            }
            Err(err) => return Err(err),
        }
    }
    let info = covered(db, plane, &key)?;
    let error_to_keep_m = if is_error_known { None } else { db.page_info(&key)?.map(|info| info.error_m) };
    Ok(Material { key, old, rect, below, damaged_below, is_error_known, error_to_keep_m, info })
}

/// What the directory says of the four pages that a page covers; `None` where there are none.
fn covered(db: &Database, plane: &Plane, key: &PageKey) -> Result<Option<PageInfo>> {
    let (mut info, mut has_gap) = (None, false);
    for child in key.children() {
        let bounds = plane.grid.bounds_at(child.level);
        if plane.layout.page_rect(&child).intersection(&bounds).is_empty() {
            continue;
        }
        match db.page_info(&child)? {
            Some(found) => info = Some(info.map_or(found, |info: PageInfo| info.with(found))),
            None => has_gap = true,
        }
    }
    let constant = HeightBounds::of(plane.constant);
    Ok(info.map(|info| PageInfo {
        bounds: if has_gap { info.bounds.with(constant) } else { info.bounds },
        ..info
    }))
}

impl PageInfo {
    /// Of a page without a height of its own.
    const fn flat(constant: f32) -> Self {
        Self { revision: EntryId::CREATION, bounds: HeightBounds::of(constant), error_m: 0.0 }
    }

    fn with(self, other: Self) -> Self {
        Self {
            revision: self.revision.max(other.revision),
            bounds: self.bounds.with(other.bounds),
            error_m: self.error_m.max(other.error_m),
        }
    }
}

impl Material {
    fn make(self, plane: &Plane) -> Result<Made> {
        let Plane { layout, constant, .. } = *plane;
        if !self.damaged_below.is_empty() && self.old.is_none() {
            let outcome = Outcome::Damaged(self.info.unwrap_or(PageInfo::flat(constant)));
            return Ok(Made { key: self.key, outcome, changed: SampleRect::EMPTY });
        }
        let flat;
        let before = match &self.old {
            Some(old) => &*old.page,
            None => {
                flat = Page::constant(layout, constant);
                &flat
            }
        };
        let mut after = before.clone();
        self.coarsen(plane, &mut after);
        for damaged in &self.damaged_below {
            let page_rect = layout.page_rect(&self.key);
            let kept = rect_above(&layout.page_rect(damaged)).intersection(&page_rect);
            let columns = (kept.x0.abs_diff(page_rect.x0), kept.x1.abs_diff(page_rect.x0));
            for z in kept.z0..kept.z1 {
                let row = z.abs_diff(page_rect.z0);
                if let (Some(from), Some(to)) =
                    (before.row(row, columns.0, columns.1), after.row_mut(row, columns.0, columns.1))
                {
                    to.copy_from_slice(from);
                }
            }
        }
        let changed = changed_rect(layout, &self.key, before.samples(), after.samples());
        let added_error_m = self.added_error_m(plane, &after);
        let is_constant = || after.samples().iter().all(|height_m| height_m.to_bits() == constant.to_bits());
        let info = match self.info {
            Some(info) => info,
            // Only a neighbour's edge reaches into it, or to its last cells, which is no height of its own.
            None if added_error_m > 0.0 || !is_constant() => PageInfo::flat(constant),
            None => return Ok(Made { key: self.key, outcome: Outcome::Absent, changed }),
        };
        let error_m = if self.is_error_known {
            (info.error_m + added_error_m).max(info.error_m * MIN_ERROR_GROWTH)
        } else {
            // As far off as it was, if that is known; it is not further off than its heights are high.
            let kept_m = self.error_to_keep_m.filter(|error_m| *error_m > 0.0);
            kept_m.unwrap_or(info.bounds.max_m - info.bounds.min_m).max(info.error_m * MIN_ERROR_GROWTH)
        };
        let info = PageInfo { error_m, ..info };
        let row = content::encode_page(layout, self.key, info, &codec::ordered_from_page(&after))?;
        let PageInfo { revision, bounds, .. } = info;
        let content = Content { revision, bounds, error_m, page: Arc::new(after) };
        Ok(Made { key: self.key, outcome: Outcome::Page { content, row }, changed })
    }

    /// Makes the samples of the rectangle.
    fn coarsen(&self, plane: &Plane, page: &mut Page) {
        let page_rect = plane.layout.page_rect(&self.key);
        let columns = (self.rect.x0.abs_diff(page_rect.x0), self.rect.x1.abs_diff(page_rect.x0));
        let read = rect_below(&self.rect);
        let mut rows = [(); 3].map(|()| vec![0.0; read.width() as usize]);
        for z in self.rect.z0..self.rect.z1 {
            let [north, centre, south] = &mut rows;
            if z == self.rect.z0 {
                self.read_row(plane, 2 * z - 1, read.x0, south);
            }
            // The southern row of the sample to the north is the northern one of this.
            std::mem::swap(north, south);
            self.read_row(plane, 2 * z, read.x0, centre);
            self.read_row(plane, 2 * z + 1, read.x0, south);
            if let Some(above) = page.row_mut(z.abs_diff(page_rect.z0), columns.0, columns.1) {
                coarsen::row(above, north, centre, south);
            }
        }
    }

    /// How far the surface of the page's level is from that of the level below, at most, metres: from the page's first samples to the first of the
    /// next pages.
    fn added_error_m(&self, plane: &Plane, page: &Page) -> f32 {
        let bounds = plane.grid.bounds_at(self.key.level);
        let page_rect = plane.layout.page_rect(&self.key);
        let rect = page_rect.intersection(&bounds);
        let below = plane.grid.bounds_at(self.key.level.saturating_sub(1));
        let end = if rect.x1 < bounds.x1 { 2 * rect.x1 + 1 } else { below.x1 };
        let mut on = vec![0.0; end.abs_diff(2 * rect.x0) as usize];
        let mut between = on.clone();
        let row_of = |z: i32| {
            let own = page.row(z.abs_diff(page_rect.z0), 0, rect.width()).filter(|_| z < rect.z1);
            let end = (rect.x1 + 1).min(bounds.x1);
            let mut row = own.map_or_else(Vec::new, <[f32]>::to_vec);
            row.extend(self.coarse_row(plane, z, rect.x0 + row.len() as i32, end));
            row
        };
        let mut error_m = 0.0_f32;
        let mut north = row_of(rect.z0);
        for z in rect.z0..(rect.z1 + 1).min(bounds.z1) {
            self.read_row(plane, 2 * z, 2 * rect.x0, &mut on);
            error_m = error_m.max(coarsen::row_error(&north, &north, &on));
            if z < rect.z1 && 2 * z + 1 < below.z1 {
                self.read_row(plane, 2 * z + 1, 2 * rect.x0, &mut between);
                // The surface goes on beyond the terrain's last sample as it is there.
                let south = if z + 1 < bounds.z1 { row_of(z + 1) } else { north.clone() };
                error_m = error_m.max(coarsen::row_error(&north, &south, &between));
                north = south;
            }
        }
        error_m
    }

    /// Samples of the page's level that may lie beyond the page.
    fn coarse_row(&self, plane: &Plane, z: i32, x0: i32, x1: i32) -> Vec<f32> {
        let mut above = vec![0.0; usize::try_from(x1 - x0).unwrap_or_default()];
        let mut rows = [(); 3].map(|()| vec![0.0; 2 * above.len() + 1]);
        if !above.is_empty() {
            for (z, row) in (2 * z - 1..).zip(&mut rows) {
                self.read_row(plane, z, 2 * x0 - 1, row);
            }
            let [north, centre, south] = &rows;
            coarsen::row(&mut above, north, centre, south);
        }
        above
    }

    /// Samples of the level below from column `x0` on; those beyond the terrain's edge are the ones on it.
    fn read_row(&self, plane: &Plane, z: i32, x0: i32, row: &mut [f32]) {
        let Plane { layout, constant, .. } = *plane;
        let bounds = plane.grid.bounds_at(self.key.level.saturating_sub(1));
        let z = z.clamp(0, bounds.z1 - 1);
        let inside = SampleRect::new(x0, z, x0 + row.len() as i32, z + 1).intersection(&bounds);
        row.fill(constant);
        for (x, page_z) in layout.pages_in(inside) {
            let key =
                PageKey { field: self.key.field, level: self.key.level.saturating_sub(1), z: page_z, x };
            let rect = layout.page_rect(&key);
            let part = rect.intersection(&inside);
            let Some(content) = self.below.get(&key) else { continue };
            let from =
                content.page.row(z.abs_diff(rect.z0), part.x0.abs_diff(rect.x0), part.x1.abs_diff(rect.x0));
            let start = part.x0.abs_diff(x0) as usize;
            if let (Some(from), Some(to)) = (from, row.get_mut(start..start + part.width() as usize)) {
                to.copy_from_slice(from);
            }
        }
        // At most one sample on either side.
        let (first, last) = (inside.x0.abs_diff(x0) as usize, inside.x1.abs_diff(x0) as usize);
        if first > 0 {
            row.copy_within(first..first + 1, first - 1);
        }
        if last < row.len() {
            row.copy_within(last - 1..last, last);
        }
    }
}

fn write(db: &Database, made: &Made) -> Result<()> {
    let mut cache = db.cache.borrow_mut();
    match &made.outcome {
        Outcome::Page { content, row } => {
            db.write_page(row)?;
            cache.put(made.key, content.clone());
        }
        Outcome::Absent => {
            cache.forget(&made.key);
            if db.page_info(&made.key)?.is_some() {
                db.delete_page(&made.key)?;
            }
        }
        Outcome::Damaged(info) => {
            cache.forget(&made.key);
            if db.page_info(&made.key)?.is_none() {
                db.insert_damaged_page(made.key, *info)?;
            }
        }
    }
    Ok(())
}
