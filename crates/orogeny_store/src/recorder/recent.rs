//! The pages of full resolution that were read or painted last, as they are now, whether they are on disk or on their way there: so
//! that what is looked at all the time is neither decoded each time, nor waits for a commit that has it.

use std::cell::RefCell;
use std::sync::Arc;

use lru::LruCache;
use orogeny_field::{Page, PageKey};

/// What a page takes that the field does not have.
const ABSENT_BYTES: u64 = 64;

/// The pages used last, within a budget; `None` for one that the field does not have.
#[derive(Debug)]
pub(super) struct Recent(RefCell<Held>);

#[derive(Debug)]
struct Held {
    pages: LruCache<PageKey, Option<Arc<Page>>>,
    size_in_bytes: u64,
    max_bytes: u64,
}

fn size_of(page: Option<&Arc<Page>>) -> u64 {
    page.map_or(ABSENT_BYTES, |page| page.samples().len() as u64 * 4)
}

impl Recent {
    pub(super) fn new(max_bytes: u64) -> Self {
        Self(RefCell::new(Held { pages: LruCache::unbounded(), size_in_bytes: 0, max_bytes }))
    }

    pub(super) fn get(&self, key: &PageKey) -> Option<Option<Arc<Page>>> {
        self.0.borrow_mut().pages.get(key).cloned()
    }

    /// Keeps a page as it is now. Coarser levels are made by commits, and are not kept.
    pub(super) fn put(&self, key: PageKey, page: Option<Arc<Page>>) {
        if key.level > 0 {
            return;
        }
        let held = &mut *self.0.borrow_mut();
        held.size_in_bytes += size_of(page.as_ref());
        if let Some(before) = held.pages.put(key, page) {
            held.size_in_bytes -= size_of(before.as_ref());
        }
        while held.size_in_bytes > held.max_bytes
            && let Some((_, oldest)) = held.pages.pop_lru()
        {
            held.size_in_bytes -= size_of(oldest.as_ref());
        }
    }

    /// Something else than painting changed pages.
    pub(super) fn clear(&self) {
        let held = &mut *self.0.borrow_mut();
        held.pages.clear();
        held.size_in_bytes = 0;
    }

    pub(super) fn size_in_bytes(&self) -> u64 {
        self.0.borrow().size_in_bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::{FieldId, PageLayout};

    #[test]
    fn the_pages_used_last_are_kept_within_the_budget() {
        let layout = PageLayout::new(64).unwrap();
        let recent = Recent::new(3 * layout.size_in_bytes());
        let key = |x| PageKey::full_resolution(FieldId(1), x, 0);
        for x in 0..3 {
            recent.put(key(x), Some(Arc::new(Page::constant(layout, x as f32))));
        }
        assert!(recent.get(&key(0)).unwrap().is_some());
        recent.put(key(3), Some(Arc::new(Page::constant(layout, 3.0))));
        assert!(recent.get(&key(1)).is_none() && recent.get(&key(0)).is_some());
        recent.put(key(0), None);
        assert_eq!(recent.get(&key(0)), Some(None));
        recent.put(PageKey { level: 1, ..key(9) }, None);
        assert!(recent.get(&PageKey { level: 1, ..key(9) }).is_none());
        assert_eq!(recent.size_in_bytes(), 2 * layout.size_in_bytes() + ABSENT_BYTES);
        recent.clear();
        assert_eq!((recent.size_in_bytes(), recent.get(&key(0))), (0, None));
    }
}
