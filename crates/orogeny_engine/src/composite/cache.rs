//! Pages that took long to work out, the least recently used of which make room.

use std::collections::HashMap;
use std::sync::Arc;

use orogeny_field::{Page, SampleRect};

use super::stale::Stale;

/// What a page holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    /// What the stack comes to, with the layer.
    Result,
    /// What the layer is made of.
    Content,
}

/// Which page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct CacheKey {
    /// The layer's id.
    pub(super) layer: u32,
    pub(super) kind: Kind,
    pub(super) level: u8,
    pub(super) z: u32,
    pub(super) x: u32,
}

#[derive(Debug)]
struct Held {
    page: Arc<Page>,
    /// What of it is no longer true, in samples of its level.
    stale: Stale,
    /// When it was last asked for.
    used: u64,
}

/// Pages within a budget.
#[derive(Debug, Default)]
pub(super) struct Cache {
    held: HashMap<CacheKey, Held>,
    budget_in_bytes: u64,
    size_in_bytes: u64,
    clock: u64,
}

impl Cache {
    pub(super) fn new(budget_in_bytes: u64) -> Self {
        Self { budget_in_bytes, ..Self::default() }
    }

    pub(super) const fn size_in_bytes(&self) -> u64 {
        self.size_in_bytes
    }

    /// A page, and what of it is no longer true.
    pub(super) fn get(&mut self, key: &CacheKey) -> Option<(Arc<Page>, Stale)> {
        self.clock += 1;
        let held = self.held.get_mut(key)?;
        held.used = self.clock;
        Some((Arc::clone(&held.page), held.stale.clone()))
    }

    pub(super) fn put(&mut self, key: CacheKey, page: Arc<Page>, stale: Stale) {
        self.clock += 1;
        self.size_in_bytes += size_of_page(&page);
        let held = Held { page, stale, used: self.clock };
        if let Some(before) = self.held.insert(key, held) {
            self.size_in_bytes -= size_of_page(&before.page);
        }
        if self.size_in_bytes > self.budget_in_bytes {
            self.make_room();
        }
    }

    /// Drops a quarter, so that it is not looked for the oldest at every page.
    fn make_room(&mut self) {
        let mut oldest: Vec<(u64, CacheKey)> =
            self.held.iter().map(|(key, held)| (held.used, *key)).collect();
        oldest.sort_unstable_by_key(|(used, _)| *used);
        let goal = self.budget_in_bytes / 4 * 3;
        for (_, key) in oldest {
            if self.size_in_bytes <= goal {
                break;
            }
            self.drop_page(&key);
        }
    }

    pub(super) fn drop_page(&mut self, key: &CacheKey) {
        if let Some(held) = self.held.remove(key) {
            self.size_in_bytes -= size_of_page(&held.page);
        }
    }

    /// Notes what of pages is no longer true: `stale_of` gives a rectangle that the part of the page lies within, empty for none.
    pub(super) fn note_stale(&mut self, stale_of: impl Fn(&CacheKey) -> SampleRect) {
        for (key, held) in &mut self.held {
            held.stale.add(stale_of(key));
        }
    }

    /// Drops what is no longer true.
    pub(super) fn drop_where(&mut self, is_stale: impl Fn(&CacheKey) -> bool) {
        let stale: Vec<_> = self.held.keys().filter(|key| is_stale(key)).copied().collect();
        stale.iter().for_each(|key| self.drop_page(key));
    }
}

fn size_of_page(page: &Page) -> u64 {
    size_of_val(page.samples()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::PageLayout;

    #[test]
    fn the_least_recently_used_pages_make_room() {
        let layout = PageLayout::new(64).unwrap();
        let page = || Arc::new(Page::constant(layout, 1.0));
        let mut cache = Cache::new(8 * layout.size_in_bytes());
        let key = |x| CacheKey { layer: 1, kind: Kind::Result, level: 0, z: 0, x };
        for x in 0..8 {
            cache.put(key(x), page(), Stale::default());
        }
        assert!(cache.get(&key(0)).is_some());
        cache.put(key(8), page(), Stale::default());
        assert!(cache.size_in_bytes() <= 8 * layout.size_in_bytes());
        assert!(cache.get(&key(0)).is_some() && cache.get(&key(8)).is_some() && cache.get(&key(1)).is_none());
        let part = SampleRect::new(1, 2, 3, 4);
        cache.note_stale(|key| if key.x == 0 { part } else { SampleRect::EMPTY });
        assert_eq!(cache.get(&key(0)).unwrap().1.within(&SampleRect::new(0, 0, 64, 64)), part);
        assert!(cache.get(&key(8)).unwrap().1 == Stale::default());
        cache.put(key(0), page(), Stale::default());
        assert!(cache.get(&key(0)).unwrap().1 == Stale::default());
        cache.drop_where(|key| key.x == 8);
        assert!(cache.get(&key(8)).is_none());
        cache.drop_where(|_| true);
        assert_eq!(cache.size_in_bytes(), 0);
    }
}
