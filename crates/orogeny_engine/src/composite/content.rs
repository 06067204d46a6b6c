//! Stored fields as they lie on the terrain: read, and moved, turned and enlarged where a layer's are.

use orogeny_field::{FieldId, Mirrors, Page, PageKey, PageLayout, Place, Plane, SampleRect};
use orogeny_reference::field::between::Ground;
use orogeny_reference::field::resample;
use rayon::prelude::*;

use super::Look;
use super::node::Stored;
use super::samples::Samples;
use crate::Result;
use crate::access::PAGES_AT_ONCE;

/// Samples around a place that a value between samples is made of.
const AROUND: i32 = 2;

/// A rectangle of a stored field, as it lies on the terrain at the level that is looked at.
pub(crate) fn stored(look: &mut Look<'_>, stored: &Stored, rect: SampleRect) -> Result<Plane> {
    Ok(samples(look, stored, rect)?.into_plane(look.layout, rect))
}

/// The same where it lies; the pages of a large rectangle are not held all at once.
pub(super) fn samples(look: &mut Look<'_>, stored: &Stored, rect: SampleRect) -> Result<Samples> {
    let Stored { field, constant, transform } = *stored;
    if !transform.is_identity() {
        return moved(look, stored, rect).map(Samples::Plane);
    }
    let inside = rect.intersection(&look.terrain.bounds_at(look.level));
    let level = look.level;
    let keys: Vec<_> = look.layout.pages_in(inside).map(|(x, z)| PageKey { field, level, z, x }).collect();
    // What pages hold beyond the terrain is not the field's.
    if keys.len() > PAGES_AT_ONCE || inside != rect {
        return read(look, field, constant, level, rect).map(Samples::Plane);
    }
    let pages = look.pages.load(&keys)?;
    let pages = keys.iter().zip(pages).filter_map(|(key, page)| Some((look.layout.page_rect(key), page?)));
    Ok(Samples::Pages { pages: pages.collect(), constant })
}

/// A rectangle of a stored field that was moved, turned or enlarged.
fn moved(look: &mut Look<'_>, stored: &Stored, rect: SampleRect) -> Result<Plane> {
    let Stored { field, constant, transform } = *stored;
    let placement = transform.placement(look.grid.spacing_m());
    // Where its samples come to lie closer together than the terrain's, of the coarser level where they do not.
    let top = look.layout.top_level(&look.terrain);
    let coarser =
        (placement.samples_between().max(1.0).log2().floor() as u8).min(top.saturating_sub(look.level));
    let placement = placement.on_level(u32::from(coarser));
    let source =
        read(look, field, constant, look.level + coarser, placement.source_rect(&rect).grown(AROUND))?;
    let ground = Ground { plane: &source, mirrors: Mirrors::NONE };
    let columns: Vec<Place> = (rect.x0..rect.x1).map(|x| placement.column(x)).collect();
    let mut plane = Plane::constant(rect, 0.0);
    let rows = plane.samples_mut().par_chunks_mut(columns.len().max(1));
    rows.zip((rect.z0..rect.z1).into_par_iter()).for_each(|(row, z)| {
        resample::row(row, &ground, &columns, placement.row(z), [transform.height_scale as f32, 0.0]);
    });
    Ok(plane)
}

/// A rectangle of a field at a level; its constant where it lies beyond the terrain.
fn read(look: &mut Look<'_>, field: FieldId, constant: f32, level: u8, rect: SampleRect) -> Result<Plane> {
    let mut plane = Plane::constant(rect, constant);
    let inside = rect.intersection(&look.terrain.bounds_at(level));
    let keys: Vec<_> = look.layout.pages_in(inside).map(|(x, z)| PageKey { field, level, z, x }).collect();
    for keys in keys.chunks(PAGES_AT_ONCE) {
        for (key, page) in keys.iter().zip(look.pages.load(keys)?) {
            if let Some(page) = page {
                plane.paste(&page, &look.layout.page_rect(key), &inside);
            }
        }
    }
    Ok(plane)
}

/// Copies a rectangle of a plane, which has all of it, into a page.
pub(super) fn patch(page: &mut Page, page_rect: SampleRect, part: &SampleRect, plane: &Plane) {
    let (x0, x1) = (part.x0.abs_diff(page_rect.x0), part.x1.abs_diff(page_rect.x0));
    for z in part.z0..part.z1 {
        let from = row_part(plane, z, part.x0, part.x1);
        if let Some(to) = page.row_mut(z.abs_diff(page_rect.z0), x0, x1).filter(|to| to.len() == from.len()) {
            to.copy_from_slice(from);
        }
    }
}

/// The part of a plane that is a page; 0 where the plane does not reach.
pub(super) fn cut(plane: &Plane, layout: PageLayout, page_rect: SampleRect) -> Page {
    page_of(plane, layout, page_rect, 0.0)
}

/// The part of a plane that is a page; some other value where the plane does not reach.
pub(crate) fn page_of(plane: &Plane, layout: PageLayout, page_rect: SampleRect, beyond: f32) -> Page {
    let mut page = Page::constant(layout, beyond);
    let both = page_rect.intersection(&plane.rect());
    let (x0, x1) = (both.x0.abs_diff(page_rect.x0), both.x1.abs_diff(page_rect.x0));
    for z in both.z0..both.z1 {
        let from = row_part(plane, z, both.x0, both.x1);
        if let Some(to) = page.row_mut(z.abs_diff(page_rect.z0), x0, x1) {
            to.copy_from_slice(from);
        }
    }
    page
}

/// Samples `x0..x1` of a row, all of which lie in the plane.
pub(super) fn row_part(plane: &Plane, z: i32, x0: i32, x1: i32) -> &[f32] {
    let first = plane.rect().x0;
    let part = |row: &'_ [f32]| -> Option<(usize, usize)> {
        let (from, to) = (x0.checked_sub(first)?, x1.checked_sub(first)?);
        let (from, to) = (usize::try_from(from).ok()?, usize::try_from(to).ok()?);
        (to <= row.len()).then_some((from, to))
    };
    let row = plane.row(z).unwrap_or_default();
    part(row).and_then(|(from, to)| row.get(from..to)).unwrap_or_default()
}

/// A part of a plane.
pub(super) fn cropped(plane: Plane, rect: SampleRect) -> Plane {
    if plane.rect() == rect {
        return plane;
    }
    let mut part = Plane::constant(rect, 0.0);
    let width = rect.width() as usize;
    for (z, row) in (rect.z0..rect.z1).zip(part.samples_mut().chunks_exact_mut(width.max(1))) {
        let from = row_part(&plane, z, rect.x0, rect.x1);
        if from.len() == row.len() {
            row.copy_from_slice(from);
        }
    }
    part
}
