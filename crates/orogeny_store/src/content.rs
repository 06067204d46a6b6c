//! Between pages in memory and rows in the file.

use std::sync::Arc;

use orogeny_field::{HeightBounds, Page, PageKey, PageLayout, SampleRect, TerrainGrid, is_storable_height};
use rayon::prelude::*;

use crate::cache::Content;
use crate::database::Database;
use crate::rows::{DeltaRow, PageInfo, PageRow};
use crate::{EntryId, Error, Result, codec};

/// Bytes of uncoded pages that are worked on at once: enough for all cores, little beside any budget.
const BATCH_BYTES: u64 = 8 << 20;

/// How many pages are read, coded and written together.
pub(crate) fn pages_per_batch(layout: PageLayout) -> usize {
    usize::try_from(BATCH_BYTES / layout.size_in_bytes()).unwrap_or(1).max(1)
}

/// Codes a page's ordered values.
pub(crate) fn encode_page(
    layout: PageLayout,
    key: PageKey,
    info: PageInfo,
    ordered: &[u32],
) -> Result<PageRow> {
    let bytes = encode(layout, ordered)?;
    Ok(PageRow { key, info, codec: codec::WRITTEN, bytes })
}

/// Codes what was done to a page.
pub(crate) fn encode_delta(
    layout: PageLayout,
    key: PageKey,
    revision_before: Option<EntryId>,
    difference: &[u32],
) -> Result<DeltaRow> {
    let bytes = encode(layout, difference)?;
    Ok(DeltaRow { key, revision_before, codec: codec::WRITTEN, bytes })
}

/// The page of a row; refuses values that are no heights.
pub(crate) fn decode_page(layout: PageLayout, row: &PageRow) -> Result<Content> {
    let ordered = codec::decode(row.codec, &row.bytes, layout.size() as usize)
        .map_err(|err| Error::damaged_page(row.key, err.to_string()))?;
    check_ordered(row.key, &ordered)?;
    let page = Arc::new(page_from_ordered(layout, &ordered)?);
    let PageInfo { revision, bounds, error_m } = row.info;
    Ok(Content { revision, bounds, error_m, page })
}

/// The difference that an entry made to a page.
pub(crate) fn decode_delta(layout: PageLayout, entry: EntryId, row: &DeltaRow) -> Result<Vec<u32>> {
    codec::decode(row.codec, &row.bytes, layout.size() as usize).map_err(|err| Error::DamagedHistory {
        entry,
        page: Some(row.key),
        detail: err.to_string(),
    })
}

/// Refuses values that no page may hold, which only damage with a right checksum could bring.
pub(crate) fn check_ordered(key: PageKey, ordered: &[u32]) -> Result<()> {
    let is_height = |&value: &u32| is_storable_height(f32::from_bits(codec::bits_from_ordered(value)));
    if ordered.iter().all(is_height) {
        Ok(())
    } else {
        Err(Error::damaged_page(key, "it holds a value that is no height"))
    }
}

/// The page with these ordered values.
pub(crate) fn page_from_ordered(layout: PageLayout, ordered: &[u32]) -> Result<Page> {
    Ok(Page::from_samples(layout, codec::heights_from_ordered(ordered))?)
}

/// Pages as they are, decoded on all cores and remembered by a writer; `None` where a page is absent. A page that cannot be
/// trusted comes as its error.
pub(crate) fn contents(
    db: &Database,
    layout: PageLayout,
    keys: &[PageKey],
) -> Result<Vec<Result<Option<Content>>>> {
    enum Found {
        Here(Content),
        Row(Option<PageRow>),
        Damaged(Error),
    }
    let mut found = Vec::with_capacity(keys.len());
    for key in keys {
        let here = db.cache.borrow_mut().get(key);
        found.push(match here {
            Some(content) => Found::Here(content),
            None => match db.page(layout, key) {
                Ok(row) => Found::Row(row),
                Err(err @ Error::DamagedPage { .. }) => Found::Damaged(err),
                Err(err) => return Err(err),
            },
        });
    }
    let pace = &*db.pace;
    let decode = |found| match found {
        Found::Here(content) => Ok(Some(content)),
        Found::Row(row) => {
            pace.wait();
            row.map(|row| decode_page(layout, &row)).transpose()
        }
        Found::Damaged(err) => Err(err),
    };
    let contents: Vec<_> = found.into_par_iter().map(decode).collect();
    if db.remembers_pages() {
        let mut cache = db.cache.borrow_mut();
        for (key, content) in keys.iter().zip(&contents) {
            if let Ok(Some(content)) = content {
                cache.put(*key, content.clone());
            }
        }
    }
    Ok(contents)
}

/// One page as it is; `None` where it is absent.
pub(crate) fn content(db: &Database, layout: PageLayout, key: &PageKey) -> Result<Option<Content>> {
    contents(db, layout, std::slice::from_ref(key))?.pop().unwrap_or(Ok(None))
}

/// Lowest and highest height of a page at full resolution. What lies beyond the terrain's edge does not count.
pub(crate) fn bounds_of(grid: &TerrainGrid, layout: PageLayout, key: &PageKey, page: &Page) -> HeightBounds {
    let rect = layout.page_rect(key);
    let inside = rect.intersection(&grid.bounds_at(key.level));
    (inside.z0..inside.z1)
        .filter_map(|z| {
            let columns = (inside.x0.abs_diff(rect.x0), inside.x1.abs_diff(rect.x0));
            HeightBounds::of_row(page.row(z.abs_diff(rect.z0), columns.0, columns.1)?)
        })
        .reduce(HeightBounds::with)
        .unwrap_or(HeightBounds::of(0.0))
}

/// The smallest rectangle, in samples of the page's level, that holds every sample whose bits differ.
pub(crate) fn changed_rect(layout: PageLayout, key: &PageKey, before: &[f32], after: &[f32]) -> SampleRect {
    let side = layout.size() as usize;
    let rect = layout.page_rect(key);
    let differs = |(a, b): (&f32, &f32)| a.to_bits() != b.to_bits();
    let mut changed = SampleRect::EMPTY;
    for ((before, after), z) in before.chunks_exact(side).zip(after.chunks_exact(side)).zip(rect.z0..) {
        let pairs = || before.iter().zip(after);
        let Some(first) = pairs().position(differs) else { continue };
        let last = pairs().rposition(differs).unwrap_or(first);
        let (x0, x1) = (rect.x0 + first as i32, rect.x0 + last as i32 + 1);
        changed = changed.bounds_with(&SampleRect::new(x0, z, x1, z + 1));
    }
    changed
}

fn encode(layout: PageLayout, values: &[u32]) -> Result<Vec<u8>> {
    codec::encode(values, layout.size() as usize).map_err(|source| Error::Compression { source })
}
