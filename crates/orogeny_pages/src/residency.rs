//! Which page is where: the page table, least recently used first to go.

use lru::LruCache;
use orogeny_field::PageKey;

/// The page table of a fixed number of slots. `S` names a slot: a layer of the atlas, or an index.
///
/// A step of work first [`touch`](Self::touch)es all its pages and then [`admit`](Self::admit)s those that are not resident. As
/// long as it needs no more pages than there are slots, no admission evicts a page of the same step, since all of them were
/// used later than every other one: that is what pins them.
#[derive(Debug)]
pub struct Residency<S> {
    resident: LruCache<PageKey, Resident<S>>,
    free: Vec<S>,
}

#[derive(Debug, Clone, Copy)]
struct Resident<S> {
    slot: S,
    is_dirty: bool,
}

/// A page that had to make room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Evicted {
    /// Which page.
    pub key: PageKey,
    /// Whether it was changed since it was last written back; then it must be read back before its slot is overwritten.
    pub is_dirty: bool,
}

/// The slot for a page that was not resident, and who made room for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Admitted<S> {
    /// The slot; its content is not the page's yet.
    pub slot: S,
    /// The page whose slot it was.
    pub evicted: Option<Evicted>,
}

impl<S: Copy> Residency<S> {
    /// With all slots free; they are handed out from the last to the first.
    #[must_use]
    pub fn new(free: Vec<S>) -> Self {
        Self { resident: LruCache::unbounded(), free }
    }

    /// The slot of a resident page, which becomes the most recently used.
    pub fn touch(&mut self, key: &PageKey) -> Option<S> {
        self.resident.get(key).map(|resident| resident.slot)
    }

    /// The slot of a resident page, without using it.
    #[must_use]
    pub fn slot(&self, key: &PageKey) -> Option<S> {
        self.resident.peek(key).map(|resident| resident.slot)
    }

    /// Gives a slot to a page that is not resident, clean and most recently used. `None` where there are no slots at all.
    pub fn admit(&mut self, key: PageKey) -> Option<Admitted<S>> {
        let (slot, evicted) = match self.free.pop() {
            Some(slot) => (slot, None),
            None => {
                let (key, resident) = self.resident.pop_lru()?;
                (resident.slot, Some(Evicted { key, is_dirty: resident.is_dirty }))
            }
        };
        self.resident.put(key, Resident { slot, is_dirty: false });
        Some(Admitted { slot, evicted })
    }

    /// Notes that a resident page was changed.
    pub fn mark_dirty(&mut self, key: &PageKey) {
        if let Some(resident) = self.resident.peek_mut(key) {
            resident.is_dirty = true;
        }
    }

    /// The changed pages and their slots, in the order of their keys; they count as clean from now on.
    pub fn take_dirty(&mut self) -> Vec<(PageKey, S)> {
        let mut dirty: Vec<_> = self
            .resident
            .iter_mut()
            .filter(|(_, resident)| resident.is_dirty)
            .map(|(key, resident)| {
                resident.is_dirty = false;
                (*key, resident.slot)
            })
            .collect();
        dirty.sort_by_key(|(key, _)| *key);
        dirty
    }

    /// Forgets a page, dirty or not, and frees its slot.
    pub fn forget(&mut self, key: &PageKey) {
        self.free.extend(self.resident.pop(key).map(|resident| resident.slot));
    }

    /// Forgets all pages, dirty or not.
    pub fn forget_all(&mut self) {
        while let Some((_, resident)) = self.resident.pop_lru() {
            self.free.push(resident.slot);
        }
    }

    /// Gives up free slots that are no longer to be used.
    pub fn retain_free(&mut self, is_kept: impl FnMut(S) -> bool) {
        let mut is_kept = is_kept;
        self.free.retain(|slot| is_kept(*slot));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::FieldId;
    use proptest::prelude::*;
    use std::collections::HashMap;

    fn key(x: u32) -> PageKey {
        PageKey::full_resolution(FieldId(1), x, 0)
    }

    #[test]
    fn with_no_slots_nothing_is_admitted() {
        assert_eq!(Residency::<u8>::new(Vec::new()).admit(key(0)), None);
    }

    #[test]
    fn the_least_recently_used_page_goes_and_says_whether_it_was_changed() {
        let mut residency = Residency::new(vec![1, 0]);
        residency.admit(key(0)).unwrap();
        residency.admit(key(1)).unwrap();
        residency.mark_dirty(&key(1));
        residency.touch(&key(0));
        let admitted = residency.admit(key(2)).unwrap();
        assert_eq!(admitted, Admitted { slot: 1, evicted: Some(Evicted { key: key(1), is_dirty: true }) });
        assert!(residency.take_dirty().is_empty());
    }

    #[test]
    fn free_slots_that_are_given_up_are_not_handed_out() {
        let mut residency = Residency::new(vec![2, 1, 0]);
        residency.admit(key(0)).unwrap();
        residency.retain_free(|slot| slot < 2);
        assert_eq!(residency.admit(key(1)).unwrap().slot, 1);
        assert_eq!(
            residency.admit(key(2)).unwrap(),
            Admitted { slot: 0, evicted: Some(Evicted { key: key(0), is_dirty: false }) }
        );
    }

    proptest! {
        #[test]
        fn no_slot_has_two_pages_and_a_step_that_fits_is_resident_as_a_whole(
            steps in prop::collection::vec(prop::collection::vec(0_u32..12, 1..=4), 1..40),
        ) {
            let mut residency = Residency::new((0..4).collect());
            for step in steps {
                let step: std::collections::BTreeSet<_> = step.into_iter().collect();
                let absent: Vec<_> = step.iter().filter(|x| residency.touch(&key(**x)).is_none()).collect();
                for x in absent {
                    let evicted = residency.admit(key(*x)).unwrap().evicted;
                    prop_assert!(evicted.is_none_or(|evicted| !step.contains(&evicted.key.x)));
                }
                let mut owners = HashMap::new();
                for x in 0..12 {
                    if let Some(slot) = residency.slot(&key(x)) {
                        prop_assert!(owners.insert(slot, x).is_none());
                    }
                }
                for x in step {
                    prop_assert!(residency.slot(&key(x)).is_some());
                }
                prop_assert!(owners.len() <= 4);
            }
        }
    }
}
