//! Checksums of rows: 128 bits of blake3 over what a row says, where it stands and which generation it is.

use orogeny_field::PageKey;

use crate::EntryId;
use crate::rows::PageInfo;

/// What a row's `checksum` column holds.
pub(crate) type Checksum = [u8; 16];

/// Hashes the parts of one row. Each part is written with its length, so that no two rows hash the same bytes.
pub(crate) struct RowHasher(blake3::Hasher);

impl RowHasher {
    /// `table` keeps rows of different tables apart.
    pub(crate) fn new(table: &'static str) -> Self {
        Self(blake3::Hasher::new()).bytes(table.as_bytes())
    }

    pub(crate) fn bytes(mut self, bytes: &[u8]) -> Self {
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
        self
    }

    pub(crate) fn number(mut self, number: i64) -> Self {
        self.0.update(&number.to_le_bytes());
        self
    }

    /// A value that may be absent.
    pub(crate) fn optional(self, bytes: Option<&[u8]>) -> Self {
        match bytes {
            Some(bytes) => self.number(1).bytes(bytes),
            None => self.number(0),
        }
    }

    pub(crate) fn place(self, key: &PageKey) -> Self {
        self.number(key.field.0.into()).number(key.level.into()).number(key.z.into()).number(key.x.into())
    }

    pub(crate) fn finish(self) -> Checksum {
        let mut checksum = Checksum::default();
        for (byte, hashed) in checksum.iter_mut().zip(self.0.finalize().as_bytes()) {
            *byte = *hashed;
        }
        checksum
    }
}

/// Of a page's coded bytes, with its place and generation: a page of another place or time does not pass.
///
/// An error of 0, as every page of full resolution has, is left out: so pages of version 2 keep the checksums that they have.
pub(crate) fn of_page(key: &PageKey, info: &PageInfo, codec: u8, bytes: &[u8]) -> Checksum {
    let PageInfo { revision, bounds, error_m } = info;
    let row = RowHasher::new("page")
        .place(key)
        .number(revision.0.into())
        .number(bounds.min_m.to_bits().into())
        .number(bounds.max_m.to_bits().into())
        .number(codec.into())
        .bytes(bytes);
    if *error_m == 0.0 { row.finish() } else { row.number(error_m.to_bits().into()).finish() }
}

/// Of a delta's coded bytes, with the entry and the page it belongs to.
pub(crate) fn of_delta(
    entry: EntryId,
    key: &PageKey,
    revision_before: Option<EntryId>,
    codec: u8,
    bytes: &[u8],
) -> Checksum {
    RowHasher::new("delta")
        .number(entry.0.into())
        .place(key)
        .number(revision_before.map_or(-1, |revision| revision.0.into()))
        .number(codec.into())
        .bytes(bytes)
        .finish()
}

#[cfg(test)]
mod tests {
    use orogeny_field::{FieldId, HeightBounds};

    use super::*;

    #[test]
    fn place_generation_and_content_all_count() {
        let key = PageKey { field: FieldId(1), level: 2, z: 3, x: 4 };
        let info = PageInfo { revision: EntryId(5), bounds: HeightBounds::of(6.0), error_m: 0.0 };
        let (lower, higher) =
            (HeightBounds { min_m: 5.0, ..info.bounds }, HeightBounds { max_m: 7.0, ..info.bounds });
        let plain = of_page(&key, &info, 1, b"bytes");
        let others = [
            of_page(&PageKey { field: FieldId(2), ..key }, &info, 1, b"bytes"),
            of_page(&PageKey { level: 3, ..key }, &info, 1, b"bytes"),
            of_page(&PageKey { z: 4, x: 3, ..key }, &info, 1, b"bytes"),
            of_page(&key, &PageInfo { revision: EntryId(6), ..info }, 1, b"bytes"),
            of_page(&key, &PageInfo { bounds: lower, ..info }, 1, b"bytes"),
            of_page(&key, &PageInfo { bounds: higher, ..info }, 1, b"bytes"),
            of_page(&key, &PageInfo { error_m: 0.5, ..info }, 1, b"bytes"),
            of_page(&key, &info, 2, b"bytes"),
            of_page(&key, &info, 1, b"byteS"),
            of_delta(EntryId(5), &key, None, 1, b"bytes"),
        ];
        for other in others {
            assert_ne!(other, plain);
        }
        assert_eq!(of_page(&key, &info, 1, b"bytes"), plain);
    }

    #[test]
    fn parts_do_not_run_together() {
        let joined = |a: &[u8], b: &[u8]| RowHasher::new("t").bytes(a).bytes(b).finish();
        assert_ne!(joined(b"ab", b"c"), joined(b"a", b"bc"));
        let optional = |a: Option<&[u8]>| RowHasher::new("t").optional(a).finish();
        assert_ne!(optional(None), optional(Some(b"")));
    }
}
