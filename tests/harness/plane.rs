//! The heights of a whole terrain, apart from pages.

use orogeny_field::{FieldId, Page, PageKey, PageLayout, SampleRect};
use orogeny_pages::MemoryPages;

/// What the samples of a page beyond the terrain's edge hold in tests, in metres: no brush may change a bit of it.
pub const PADDING_M: f32 = -54_321.5;

/// Heights in metres, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    width: u32,
    depth: u32,
    samples: Vec<f32>,
}

impl Plane {
    /// From its samples, row by row.
    ///
    /// # Panics
    /// Unless there are `width * depth`.
    #[must_use]
    pub fn new(width: u32, depth: u32, samples: Vec<f32>) -> Self {
        assert_eq!(samples.len(), width as usize * depth as usize, "a plane of {width} x {depth} samples");
        Self { width, depth, samples }
    }

    /// From a function of column and row.
    #[must_use]
    pub fn from_fn(width: u32, depth: u32, mut height_m: impl FnMut(u32, u32) -> f32) -> Self {
        let places = (0..depth).flat_map(|z| (0..width).map(move |x| (x, z)));
        Self::new(width, depth, places.map(|(x, z)| height_m(x, z)).collect())
    }

    /// Samples along x.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Samples along z.
    #[must_use]
    pub const fn depth(&self) -> u32 {
        self.depth
    }

    /// All samples, row by row.
    #[must_use]
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }

    /// All samples, to be changed.
    #[must_use]
    pub fn samples_mut(&mut self) -> &mut [f32] {
        &mut self.samples
    }

    /// One sample.
    ///
    /// # Panics
    /// Outside the plane.
    #[must_use]
    pub fn at(&self, x: u32, z: u32) -> f32 {
        assert!(x < self.width && z < self.depth, "{x}, {z}");
        self.samples[self.index(x, z)]
    }

    /// The place of a sample in [`samples`](Self::samples).
    #[must_use]
    pub const fn index(&self, x: u32, z: u32) -> usize {
        z as usize * self.width as usize + x as usize
    }

    /// All its samples as a rectangle.
    #[must_use]
    pub const fn bounds(&self) -> SampleRect {
        SampleRect::new(0, 0, self.width.cast_signed(), self.depth.cast_signed())
    }

    /// The keys of its pages.
    #[must_use]
    pub fn keys(&self, layout: PageLayout, field: FieldId) -> Vec<PageKey> {
        layout.pages_in(self.bounds()).map(|(x, z)| PageKey::full_resolution(field, x, z)).collect()
    }

    /// Cut into pages, all of them there and from before the next operation; beyond the edge lies [`PADDING_M`].
    #[must_use]
    pub fn to_pages(&self, layout: PageLayout, field: FieldId) -> MemoryPages {
        use orogeny_pages::PageStore as _;
        let mut store = MemoryPages::new(layout, PADDING_M);
        let pages = self.keys(layout, field).into_iter().map(|key| {
            let mut page = Page::constant(layout, PADDING_M);
            for (x, z, row, column) in self.samples_of(layout, &key) {
                page.row_mut(row, column, column + 1).expect("within the page")[0] = self.at(x, z);
            }
            (key, page)
        });
        store.save(pages.collect()).expect("memory takes pages");
        store.commit();
        store
    }

    /// The plane that pages hold.
    ///
    /// # Panics
    /// Where a page is missing, where a page lies outside, and where a sample beyond the edge is no longer [`PADDING_M`].
    #[must_use]
    pub fn from_pages(
        width: u32,
        depth: u32,
        store: &MemoryPages,
        layout: PageLayout,
        field: FieldId,
    ) -> Self {
        let mut plane = Self::from_fn(width, depth, |_, _| f32::NAN);
        let keys = plane.keys(layout, field);
        let pages = store.pages_unsorted();
        assert!(pages.keys().all(|key| keys.contains(key)), "a page outside the terrain was saved");
        for key in keys {
            let page = pages.get(&key).unwrap_or_else(|| panic!("{key:?} is missing"));
            let mut num_padding = layout.num_samples();
            for (x, z, row, column) in plane.samples_of(layout, &key) {
                let index = plane.index(x, z);
                plane.samples[index] = page.row(row, column, column + 1).expect("within the page")[0];
                num_padding -= 1;
            }
            let inside = plane.bounds().intersection(&layout.page_rect(&key));
            let is_padding = |index: usize| {
                let size = layout.size() as usize;
                index % size >= inside.width() as usize || index / size >= inside.depth() as usize
            };
            let padding: Vec<_> = page.samples().iter().enumerate().filter(|(i, _)| is_padding(*i)).collect();
            assert_eq!(padding.len(), num_padding);
            let changed = padding.iter().find(|(_, height)| height.to_bits() != PADDING_M.to_bits());
            assert!(changed.is_none(), "{key:?}: a sample beyond the terrain was changed: {changed:?}");
        }
        plane
    }

    /// Column and row on the plane, row and column in the page, of each sample that a page shares with the plane.
    fn samples_of(&self, layout: PageLayout, key: &PageKey) -> Vec<(u32, u32, u32, u32)> {
        let page = layout.page_rect(key);
        let inside = page.intersection(&self.bounds());
        let sample = |x: i32, z: i32| {
            let [column, row] = [x.abs_diff(page.x0), z.abs_diff(page.z0)];
            (x.cast_unsigned(), z.cast_unsigned(), row, column)
        };
        (inside.z0..inside.z1).flat_map(|z| (inside.x0..inside.x1).map(move |x| sample(x, z))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_pages::PageStore as _;

    fn plane() -> Plane {
        Plane::from_fn(100, 70, |x, z| (x * 1000 + z) as f32)
    }

    #[test]
    fn pages_hold_the_plane_and_give_it_back() {
        for size in [64, 128] {
            let layout = PageLayout::new(size).unwrap();
            let store = plane().to_pages(layout, FieldId(3));
            assert_eq!(store.pages_unsorted().len(), if size == 64 { 4 } else { 1 });
            assert_eq!(Plane::from_pages(100, 70, &store, layout, FieldId(3)), plane());
        }
    }

    fn with_change(change: impl FnOnce(&mut MemoryPages, PageLayout)) -> Plane {
        let layout = PageLayout::new(64).unwrap();
        let mut store = plane().to_pages(layout, FieldId(3));
        change(&mut store, layout);
        Plane::from_pages(100, 70, &store, layout, FieldId(3))
    }

    #[test]
    #[should_panic(expected = "a sample beyond the terrain was changed")]
    fn a_change_beyond_the_edge_is_seen() {
        let _ = with_change(|store, _| {
            let key = PageKey::full_resolution(FieldId(3), 1, 1);
            let mut page = store.load(&key).unwrap().unwrap();
            page.row_mut(5, 63, 64).unwrap()[0] = 0.0;
            store.save(vec![(key, page)]).unwrap();
        });
    }

    #[test]
    #[should_panic(expected = "a page outside the terrain")]
    fn a_page_too_many_is_seen() {
        let _ = with_change(|store, layout| {
            let key = PageKey::full_resolution(FieldId(3), 2, 0);
            store.save(vec![(key, Page::constant(layout, 0.0))]).unwrap();
        });
    }

    #[test]
    #[should_panic(expected = "is missing")]
    fn a_page_too_few_is_seen() {
        let layout = PageLayout::new(64).unwrap();
        let _ = Plane::from_pages(100, 70, &MemoryPages::new(layout, 0.0), layout, FieldId(3));
    }
}
