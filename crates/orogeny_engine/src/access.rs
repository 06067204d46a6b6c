//! The terrain file as the engine has it open: for writing, with commits behind the painting, or for reading.

use std::path::Path;

use orogeny_store::{EntryId, MAX_CACHE_BYTES, Recorder, Store};

use crate::{Error, Result};

/// What painting may be ahead of the file at most, in bytes of pages.
const MAX_PENDING_BYTES: u64 = 64 << 20;

/// What rows of a raster on their way in or out may take, however small the budget is: with less, a wide raster would decode
/// and code its pages again for every few rows.
const MIN_BAND_BYTES: u64 = 16 << 20;

/// Pages of a band that are decoded or coded at once, on all cores: of a wide raster never a whole row of them.
pub(crate) const PAGES_AT_ONCE: usize = 32;

/// Bytes of rows of a raster that are read or written at once.
pub(crate) fn band_bytes(budget_in_bytes: u64) -> u64 {
    (budget_in_bytes / 4).max(MIN_BAND_BYTES)
}

/// Rows of `width` heights that fit into a band, at least one.
pub(crate) fn band_rows(width: u32, max_band_bytes: u64) -> i32 {
    let row_bytes = u64::from(width).max(1) * size_of::<f32>() as u64;
    i32::try_from(max_band_bytes / row_bytes).unwrap_or(i32::MAX).max(1)
}

/// How the budget for pages in memory is shared out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shares {
    /// Pages that the executor keeps.
    pub(crate) executor_in_bytes: u64,
    /// Pages on their way to the file.
    pub(crate) pending_in_bytes: u64,
    /// Pages that the store remembers.
    pub(crate) cache_in_bytes: u64,
    /// Pages that were read or painted last.
    pub(crate) recent_in_bytes: u64,
    /// Pages of the composite that took long to work out, and half as much again while they are worked out.
    pub(crate) composite_in_bytes: u64,
}

impl Shares {
    /// Of a whole budget: half of it at least are for painting.
    pub(crate) fn of(budget_in_bytes: u64) -> Self {
        let pending_in_bytes = MAX_PENDING_BYTES.min(budget_in_bytes / 8);
        let cache_in_bytes = MAX_CACHE_BYTES.min(budget_in_bytes / 8);
        let composite_in_bytes = budget_in_bytes / 8;
        let recent_in_bytes = budget_in_bytes / 16;
        let others = pending_in_bytes + cache_in_bytes + recent_in_bytes + composite_in_bytes / 2 * 3;
        let executor_in_bytes = budget_in_bytes - others;
        Self { executor_in_bytes, pending_in_bytes, cache_in_bytes, recent_in_bytes, composite_in_bytes }
    }
}

/// An open terrain file.
#[derive(Debug)]
pub(crate) enum Access {
    Write(Recorder),
    Read(Store),
}

impl Access {
    /// Of a store that is open for writing.
    pub(crate) fn writing(store: Store, budget_in_bytes: u64) -> Result<Self> {
        let shares = Shares::of(budget_in_bytes);
        store.limit_cache(shares.cache_in_bytes);
        Ok(Self::Write(Recorder::start(store, shares.pending_in_bytes, shares.recent_in_bytes)?))
    }

    pub(crate) fn reading(path: &Path) -> Result<Self> {
        let mut store = up_to_date(path, Store::open_to_read)?;
        store.hold()?;
        Ok(Self::Read(store))
    }

    /// For reading as of an entry of the history.
    pub(crate) fn reading_at(path: &Path, entry: EntryId) -> Result<Self> {
        Ok(Self::Read(up_to_date(path, |path| Store::open_to_read_at(path, entry))?))
    }

    /// Lets a reader show what was committed last; a writer does so anyway.
    pub(crate) fn refresh(&mut self) -> Result<()> {
        match self {
            Self::Write(_) => Ok(()),
            Self::Read(store) => Ok(store.hold()?),
        }
    }

    /// The terrain as it is, once everything that is finished is on disk.
    pub(crate) fn settled(&self) -> Result<&Store> {
        match self {
            Self::Write(recorder) => {
                recorder.wait_until_durable();
                Ok(recorder.on_disk()?)
            }
            Self::Read(store) => Ok(store),
        }
    }

    /// The terrain as it is on disk.
    pub(crate) fn on_disk(&self) -> Result<&Store> {
        match self {
            Self::Write(recorder) => Ok(recorder.on_disk()?),
            Self::Read(store) => Ok(store),
        }
    }

    pub(crate) fn recorder(&mut self) -> Result<&mut Recorder> {
        match self {
            Self::Write(recorder) => Ok(recorder),
            Self::Read(store) => {
                let path = store.path().to_owned();
                Err(Error::Store(orogeny_store::Error::OpenedToRead { path }))
            }
        }
    }

    pub(crate) fn close(self) -> Result<()> {
        match self {
            Self::Write(recorder) => Ok(recorder.close()?),
            Self::Read(store) => Ok(store.close()?),
        }
    }

    /// Bytes of pages that it keeps in memory.
    pub(crate) fn memory_in_bytes(&self) -> u64 {
        match self {
            Self::Write(recorder) => recorder.memory_in_bytes(),
            Self::Read(store) => store.cached_bytes(),
        }
    }
}

/// Reads a terrain; one of an older version is brought up to date first, as there is no other way to read it.
pub(crate) fn up_to_date<T>(
    path: &Path,
    read: impl Fn(&Path) -> orogeny_store::Result<T>,
) -> orogeny_store::Result<T> {
    match read(path) {
        Err(orogeny_store::Error::OlderVersion { .. }) => {
            open_to_write(path)?.close()?;
            read(path)
        }
        result => result,
    }
}

/// Opens a store for writing, and says where that changed its version.
pub(crate) fn open_to_write(path: &Path) -> orogeny_store::Result<Store> {
    let store = Store::open(path)?;
    if let Some(version) = store.upgraded_from() {
        tracing::warn!("`{}` had format version {version} and was brought up to date", path.display());
    }
    Ok(store)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shares_come_to_the_budget_and_most_of_it_is_for_painting() {
        for mebibytes in [1, 8, 64, 128, 512, 1024, 65_536] {
            let budget = mebibytes << 20;
            let shares = Shares::of(budget);
            let Shares { executor_in_bytes, pending_in_bytes, cache_in_bytes, .. } = shares;
            assert!(executor_in_bytes >= budget / 2, "{mebibytes} MiB");
            let kept = shares.recent_in_bytes + shares.composite_in_bytes / 2 * 3;
            let sum = executor_in_bytes + pending_in_bytes + cache_in_bytes + kept;
            assert_eq!(sum, budget, "{mebibytes} MiB");
        }
        assert_eq!(Shares::of(1 << 30).cache_in_bytes, MAX_CACHE_BYTES);
    }
}
