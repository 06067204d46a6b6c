//! Pages: the unit of caching, storing and undo.

use crate::{Error, Result, SampleRect};

/// Samples a side of a page, unless a test asks for another size.
pub const DEFAULT_PAGE_SIZE: u32 = 256;

/// A sampled scalar plane of a terrain: a layer's heights, a layer's mask, a selection. The number is the store's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct FieldId(pub u32);

/// Where a page lies: its field, its level (0 is full resolution) and its place in units of pages of that level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PageKey {
    /// The plane it belongs to.
    pub field: FieldId,
    /// 0 for full resolution; each next level halves it.
    pub level: u8,
    /// Row of pages.
    pub z: u32,
    /// Column of pages.
    pub x: u32,
}

impl PageKey {
    /// A page at full resolution.
    #[must_use]
    pub const fn full_resolution(field: FieldId, x: u32, z: u32) -> Self {
        Self { field, level: 0, z, x }
    }
}

/// How a plane is cut into pages. 256 samples a side in a terrain file; tests use smaller ones, and one huge page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PageLayout {
    size: u32,
}

impl Default for PageLayout {
    fn default() -> Self {
        Self { size: DEFAULT_PAGE_SIZE }
    }
}

impl PageLayout {
    /// The smallest page: a row of it is one aligned copy for the GPU (256 bytes).
    pub const MIN_SIZE: u32 = 64;
    /// The largest page: WebGPU's default texture side is 8192.
    pub const MAX_SIZE: u32 = 4096;

    /// Pages of `size x size` samples.
    ///
    /// # Errors
    /// [`Error::PageSize`] unless it is a power of two from [`Self::MIN_SIZE`] to [`Self::MAX_SIZE`].
    pub const fn new(size: u32) -> Result<Self> {
        if size.is_power_of_two() && size >= Self::MIN_SIZE && size <= Self::MAX_SIZE {
            Ok(Self { size })
        } else {
            Err(Error::PageSize { size, min: Self::MIN_SIZE, max: Self::MAX_SIZE })
        }
    }

    /// Samples a side.
    #[must_use]
    pub const fn size(&self) -> u32 {
        self.size
    }

    /// Samples in a page.
    #[must_use]
    pub const fn num_samples(&self) -> usize {
        self.size as usize * self.size as usize
    }

    /// Bytes of a page of `f32` heights.
    #[must_use]
    pub const fn size_in_bytes(&self) -> u64 {
        self.num_samples() as u64 * 4
    }

    /// The samples that a page holds, in samples of its own level. Pages at the far edges reach past the terrain.
    #[must_use]
    pub const fn page_rect(&self, key: &PageKey) -> SampleRect {
        let x0 = (key.x * self.size).cast_signed();
        let z0 = (key.z * self.size).cast_signed();
        let size = self.size.cast_signed();
        SampleRect::new(x0, z0, x0 + size, z0 + size)
    }

    /// Columns and rows `(x, z)` of the pages that hold any sample of `rect`, row by row. What lies at negative
    /// coordinates has no pages.
    pub fn pages_in(&self, rect: SampleRect) -> impl Iterator<Item = (u32, u32)> + use<> {
        let size = self.size;
        let first = |edge: i32| edge.max(0).cast_unsigned() / size;
        let last = |edge: i32| edge.max(0).cast_unsigned().div_ceil(size);
        let (columns, rows) = if rect.is_empty() {
            (0..0, 0..0)
        } else {
            (first(rect.x0)..last(rect.x1), first(rect.z0)..last(rect.z1))
        };
        rows.flat_map(move |z| columns.clone().map(move |x| (x, z)))
    }

    /// How many pages hold any sample of `rect`.
    #[must_use]
    pub fn num_pages_in(&self, rect: SampleRect) -> u64 {
        if rect.is_empty() {
            return 0;
        }
        let along = |start: i32, end: i32| {
            let (start, end) = (start.max(0).cast_unsigned(), end.max(0).cast_unsigned());
            u64::from(end.div_ceil(self.size).saturating_sub(start / self.size))
        };
        along(rect.x0, rect.x1) * along(rect.z0, rect.z1)
    }
}

/// The heights of a page, row by row, in metres (or a mask's 0..1). Samples beyond the terrain's edge hold the field's
/// constant and are never written by a brush.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    size: u32,
    samples: Box<[f32]>,
}

impl Page {
    /// A page that holds one value everywhere.
    #[must_use]
    pub fn constant(layout: PageLayout, value: f32) -> Self {
        Self { size: layout.size(), samples: vec![value; layout.num_samples()].into_boxed_slice() }
    }

    /// From its samples, row by row.
    ///
    /// # Errors
    /// [`Error::PageLength`] unless there are exactly as many as the layout asks for.
    pub fn from_samples(layout: PageLayout, samples: Vec<f32>) -> Result<Self> {
        if samples.len() == layout.num_samples() {
            Ok(Self { size: layout.size(), samples: samples.into_boxed_slice() })
        } else {
            Err(Error::PageLength {
                size: layout.size(),
                expected: layout.num_samples(),
                actual: samples.len(),
            })
        }
    }

    /// Samples a side.
    #[must_use]
    pub const fn size(&self) -> u32 {
        self.size
    }

    /// All samples, row by row.
    #[must_use]
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }

    /// All samples, row by row, to be changed.
    #[must_use]
    pub fn samples_mut(&mut self) -> &mut [f32] {
        &mut self.samples
    }

    /// Samples `x0..x1` of row `z`, all local to the page; `None` where the page does not have them.
    #[must_use]
    pub fn row(&self, z: u32, x0: u32, x1: u32) -> Option<&[f32]> {
        self.samples.get(self.row_range(z, x0, x1)?)
    }

    /// As [`Self::row`], to be changed.
    #[must_use]
    pub fn row_mut(&mut self, z: u32, x0: u32, x1: u32) -> Option<&mut [f32]> {
        let range = self.row_range(z, x0, x1)?;
        self.samples.get_mut(range)
    }

    fn row_range(&self, z: u32, x0: u32, x1: u32) -> Option<std::ops::Range<usize>> {
        let start = z as usize * self.size as usize;
        (z < self.size && x0 <= x1 && x1 <= self.size).then(|| start + x0 as usize..start + x1 as usize)
    }
}

impl AsRef<Self> for Page {
    fn as_ref(&self) -> &Self {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn page_sizes_are_powers_of_two_that_the_gpu_can_copy() {
        for bad in [0, 1, 32, 65, 100, 8192] {
            assert!(PageLayout::new(bad).is_err(), "{bad}");
        }
        assert_eq!(PageLayout::default(), PageLayout::new(256).unwrap());
    }

    #[test]
    fn rows_outside_a_page_are_none() {
        let mut page = Page::constant(PageLayout::new(64).unwrap(), 1.0);
        assert!(page.row(64, 0, 1).is_none());
        assert!(page.row(0, 0, 65).is_none());
        assert!(page.row(0, 5, 4).is_none());
        page.row_mut(63, 63, 64).unwrap()[0] = 7.0;
        assert_eq!(page.samples().last(), Some(&7.0));
    }

    proptest! {
        #[test]
        fn pages_in_names_each_page_that_holds_a_sample_once(
            x0 in -300_i32..600, z0 in -300_i32..600, width in -5_i32..400, depth in -5_i32..400,
        ) {
            let layout = PageLayout::new(64).unwrap();
            let rect = SampleRect::new(x0, z0, x0 + width, z0 + depth);
            let found: Vec<_> = layout.pages_in(rect).collect();
            let mut expected = Vec::new();
            for z in 0..20 {
                for x in 0..20 {
                    let page = layout.page_rect(&PageKey::full_resolution(FieldId(0), x, z));
                    if !page.intersection(&rect).is_empty() {
                        expected.push((x, z));
                    }
                }
            }
            prop_assert_eq!(layout.num_pages_in(rect), expected.len() as u64);
            prop_assert_eq!(found, expected);
        }
    }
}
