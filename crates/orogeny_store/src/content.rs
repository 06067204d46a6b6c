//! Between pages in memory and rows in the file.

use orogeny_field::{Page, PageKey, PageLayout, is_storable_height};

use crate::rows::{DeltaRow, PageRow};
use crate::{EntryId, Error, Result, codec};

/// Bytes of uncoded pages that are worked on at once: enough for all cores, little beside any budget.
const BATCH_BYTES: u64 = 16 << 20;

/// How many pages are read, coded and written together.
pub(crate) fn pages_per_batch(layout: PageLayout) -> usize {
    usize::try_from(BATCH_BYTES / layout.size_in_bytes()).unwrap_or(1).max(1)
}

/// Codes a page's ordered values as the state that `revision` left.
pub(crate) fn encode_page(
    layout: PageLayout,
    key: PageKey,
    revision: EntryId,
    ordered: &[u32],
) -> Result<PageRow> {
    let bytes = encode(layout, ordered)?;
    Ok(PageRow { key, revision, codec: codec::WRITTEN, bytes })
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

/// The ordered values of a page; refuses values that are no heights.
pub(crate) fn decode_page(layout: PageLayout, row: &PageRow) -> Result<Vec<u32>> {
    let ordered = codec::decode(row.codec, &row.bytes, layout.size() as usize)
        .map_err(|err| Error::damaged_page(row.key, err.to_string()))?;
    check_ordered(row.key, &ordered)?;
    Ok(ordered)
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

fn encode(layout: PageLayout, values: &[u32]) -> Result<Vec<u8>> {
    codec::encode(values, layout.size() as usize).map_err(|source| Error::Compression { source })
}
