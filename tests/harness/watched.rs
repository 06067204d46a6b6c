//! A page store that counts what is asked of it, and that fails when it is told to.

use std::collections::BTreeSet;

use orogeny_field::{FieldId, Page, PageKey, PageLayout};
use orogeny_pages::{BoxError, MemoryPages, PageStore};

/// Pages in memory, watched.
#[derive(Debug, Clone)]
pub struct WatchedPages {
    pages: MemoryPages,
    loaded: BTreeSet<PageKey>,
    saved: BTreeSet<PageKey>,
    num_calls: u64,
    fails_at: Option<u64>,
}

impl WatchedPages {
    /// Watches pages from now on.
    #[must_use]
    pub const fn new(pages: MemoryPages) -> Self {
        Self { pages, loaded: BTreeSet::new(), saved: BTreeSet::new(), num_calls: 0, fails_at: None }
    }

    /// The same pages, but the call with this number, from 0, fails and does nothing.
    #[must_use]
    pub const fn failing_at(mut self, call: u64) -> Self {
        self.fails_at = Some(call);
        self
    }

    /// The pages.
    #[must_use]
    pub const fn pages(&self) -> &MemoryPages {
        &self.pages
    }

    /// The pages that were loaded, as they are or as they were before.
    #[must_use]
    pub const fn loaded(&self) -> &BTreeSet<PageKey> {
        &self.loaded
    }

    /// The pages that were saved.
    #[must_use]
    pub const fn saved(&self) -> &BTreeSet<PageKey> {
        &self.saved
    }

    /// How often a page was loaded or pages were saved.
    #[must_use]
    pub const fn num_calls(&self) -> u64 {
        self.num_calls
    }

    fn call(&mut self) -> Result<(), BoxError> {
        let call = self.num_calls;
        self.num_calls += 1;
        if self.fails_at == Some(call) { Err(format!("call {call} was made to fail").into()) } else { Ok(()) }
    }
}

impl PageStore for WatchedPages {
    fn layout(&self) -> PageLayout {
        self.pages.layout()
    }

    fn constant(&self, field: FieldId) -> f32 {
        self.pages.constant(field)
    }

    fn load(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        self.call()?;
        self.loaded.insert(*key);
        self.pages.load(key)
    }

    fn load_before(&mut self, key: &PageKey) -> Result<Option<Page>, BoxError> {
        self.call()?;
        self.loaded.insert(*key);
        self.pages.load_before(key)
    }

    fn save(&mut self, pages: Vec<(PageKey, Page)>) -> Result<(), BoxError> {
        self.call()?;
        self.saved.extend(pages.iter().map(|(key, _)| *key));
        self.pages.save(pages)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_are_counted_and_the_one_asked_for_fails() {
        let layout = PageLayout::new(64).unwrap();
        let key = |x| PageKey::full_resolution(FieldId(0), x, 0);
        let mut watched = WatchedPages::new(MemoryPages::new(layout, 1.0)).failing_at(2);
        assert!(watched.load(&key(0)).unwrap().is_none());
        watched.save(vec![(key(1), Page::constant(layout, 2.0))]).unwrap();
        assert!(watched.save(vec![(key(2), Page::constant(layout, 2.0))]).is_err());
        assert!(watched.load_before(&key(3)).unwrap().is_none());
        assert_eq!(watched.num_calls(), 4);
        assert_eq!(watched.loaded().iter().map(|key| key.x).collect::<Vec<_>>(), [0, 3]);
        assert_eq!(watched.saved().iter().map(|key| key.x).collect::<Vec<_>>(), [1]);
        assert_eq!(watched.pages().pages_unsorted().len(), 1);
    }
}
