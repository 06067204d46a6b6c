//! The levels above full resolution, kept up with it: an edit refreshes the samples above those that it changed, and no
//! others.
//!
//! A page above level 0 is a function of the pages below it alone, so undo, redo and every order of edits lead to the same
//! bits as making it from scratch. It is there where any of the four pages that it covers is, or where a neighbour's edge
//! reaches into it; elsewhere the field's constant is right. Its lowest and highest height are those of full resolution
//! below it, its revision is the latest below it.

use std::collections::BTreeMap;
use std::sync::Arc;

use orogeny_field::{
    HeightBounds, Page, PageKey, PageLayout, SampleRect, TerrainGrid, rect_above, rect_below,
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
            let made = materials
                .into_par_iter()
                .map(|(plane, material)| material.make(&plane))
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
    match material.make(plane)?.outcome {
        Outcome::Page { content, .. } => Ok(Some(content)),
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
        for (x, z) in layout.pages_in(rect) {
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
    let read = rect_below(&rect).intersection(&grid.bounds_at(level_below));
    let keys: Vec<_> =
        layout.pages_in(read).map(|(x, z)| PageKey { field: key.field, level: level_below, z, x }).collect();
    let (mut below, mut damaged_below) = (BTreeMap::new(), Vec::new());
    for (key, content) in keys.iter().zip(content::contents(db, layout, &keys)?) {
        match content {
            Ok(content) => below.extend(content.map(|content| (*key, content))),
            Err(Error::DamagedPage { .. }) => damaged_below.push(*key),
            Err(err) => return Err(err),
        }
    }
    let info = covered(db, plane, &key)?;
    Ok(Material { key, old, rect, below, damaged_below, info })
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
    fn with(self, other: Self) -> Self {
        Self { revision: self.revision.max(other.revision), bounds: self.bounds.with(other.bounds) }
    }
}

impl Material {
    fn make(self, plane: &Plane) -> Result<Made> {
        let Plane { layout, constant, .. } = *plane;
        if !self.damaged_below.is_empty() && self.old.is_none() {
            let flat = PageInfo { revision: EntryId::CREATION, bounds: HeightBounds::of(constant) };
            let outcome = Outcome::Damaged(self.info.unwrap_or(flat));
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
        let reaches_into = || after.samples().iter().any(|height_m| height_m.to_bits() != constant.to_bits());
        let info = match self.info {
            Some(info) => info,
            // Only a neighbour's edge reaches into it, which is no height of its own.
            None if reaches_into() => {
                PageInfo { revision: EntryId::CREATION, bounds: HeightBounds::of(constant) }
            }
            None => return Ok(Made { key: self.key, outcome: Outcome::Absent, changed }),
        };
        let row = content::encode_page(layout, self.key, info, &codec::ordered_from_page(&after))?;
        let content = Content { revision: info.revision, bounds: info.bounds, page: Arc::new(after) };
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
