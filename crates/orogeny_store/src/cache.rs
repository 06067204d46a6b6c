//! Pages as they are in the file or in the running transaction, decoded: so that a page that is painted again and again, and
//! the few pages above it, are not decoded each time.

use std::sync::Arc;

use lru::LruCache;
use orogeny_field::{HeightBounds, Page, PageKey};

use crate::EntryId;

/// What a writer remembers of decoded pages at most, in bytes: little beside any budget, enough for all levels above a stroke.
pub const MAX_CACHE_BYTES: u64 = 24 << 20;

/// A page as the terrain has it.
#[derive(Debug, Clone)]
pub(crate) struct Content {
    /// The entry whose state it holds.
    pub(crate) revision: EntryId,
    pub(crate) bounds: HeightBounds,
    /// As [`crate::rows::PageInfo::error_m`].
    pub(crate) error_m: f32,
    pub(crate) page: Arc<Page>,
}

/// The pages used last.
#[derive(Debug)]
pub(crate) struct PageCache {
    pages: LruCache<PageKey, Content>,
    size_in_bytes: u64,
    max_bytes: u64,
}

impl Default for PageCache {
    fn default() -> Self {
        Self { pages: LruCache::unbounded(), size_in_bytes: 0, max_bytes: MAX_CACHE_BYTES }
    }
}

fn size_of(content: &Content) -> u64 {
    content.page.samples().len() as u64 * 4
}

impl PageCache {
    pub(crate) fn get(&mut self, key: &PageKey) -> Option<Content> {
        self.pages.get(key).cloned()
    }

    pub(crate) fn put(&mut self, key: PageKey, content: Content) {
        self.size_in_bytes += size_of(&content);
        if let Some(old) = self.pages.put(key, content) {
            self.size_in_bytes -= size_of(&old);
        }
        self.make_room();
    }

    /// Keeps no more than this, and never more than [`MAX_CACHE_BYTES`].
    pub(crate) fn limit(&mut self, max_bytes: u64) {
        self.max_bytes = max_bytes.min(MAX_CACHE_BYTES);
        self.make_room();
    }

    fn make_room(&mut self) {
        while self.size_in_bytes > self.max_bytes
            && let Some((_, oldest)) = self.pages.pop_lru()
        {
            self.size_in_bytes -= size_of(&oldest);
        }
    }

    pub(crate) fn forget(&mut self, key: &PageKey) {
        if let Some(old) = self.pages.pop(key) {
            self.size_in_bytes -= size_of(&old);
        }
    }

    pub(crate) fn clear(&mut self) {
        self.pages.clear();
        self.size_in_bytes = 0;
    }

    pub(crate) const fn size_in_bytes(&self) -> u64 {
        self.size_in_bytes
    }
}

#[cfg(test)]
mod tests {
    use orogeny_field::{FieldId, PageLayout};

    use super::*;

    #[test]
    fn the_cache_keeps_what_was_used_last_and_counts_it() {
        let layout = PageLayout::default();
        let content = |height_m: f32| Content {
            revision: EntryId(1),
            bounds: HeightBounds::of(height_m),
            error_m: 0.0,
            page: Arc::new(Page::constant(layout, height_m)),
        };
        let key = |x: u32| PageKey::full_resolution(FieldId(1), x, 0);
        let mut cache = PageCache::default();
        let max_pages = (MAX_CACHE_BYTES / layout.size_in_bytes()) as u32;
        for x in 0..max_pages {
            cache.put(key(x), content(x as f32));
        }
        assert_eq!(cache.size_in_bytes(), MAX_CACHE_BYTES);
        assert!(cache.get(&key(0)).is_some());
        cache.put(key(max_pages), content(0.0));
        assert!(cache.get(&key(0)).is_some() && cache.get(&key(1)).is_none());
        cache.put(key(0), content(5.0));
        assert_eq!(cache.size_in_bytes(), MAX_CACHE_BYTES);
        cache.forget(&key(0));
        assert_eq!(cache.size_in_bytes(), MAX_CACHE_BYTES - layout.size_in_bytes());
        cache.limit(2 * layout.size_in_bytes());
        assert_eq!(cache.size_in_bytes(), 2 * layout.size_in_bytes());
        cache.clear();
        assert_eq!((cache.size_in_bytes(), cache.get(&key(max_pages)).is_none()), (0, true));
    }
}
