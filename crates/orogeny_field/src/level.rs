//! Levels of a plane: which samples of one make a sample of the next, and which pages hold them.
//!
//! Sample `(i, j)` of level `k + 1` lies exactly on sample `(2i, 2j)` of level `k` and is the mean of the 3 x 3 samples
//! around it; a level has `⌈n / 2⌉` samples a side of the one below. The last level is the first that fits into one page.

use crate::{PageKey, PageLayout, SampleRect, TerrainGrid};

/// How many heights are looked at side by side: the loop then vectorises.
const LANES: usize = 16;

/// How much larger the error of a coarse page is counted than those below it, at least: so that a small step of a camera is a small one in detail.
pub const MIN_ERROR_GROWTH: f32 = 1.25;

/// Lowest and highest height of some part of a plane, in metres (or a mask's 0..1).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct HeightBounds {
    /// The lowest.
    pub min_m: f32,
    /// The highest.
    pub max_m: f32,
}

impl HeightBounds {
    /// Of one height. -0 counts as +0: they are one height, and which of them `min` and `max` take is not defined.
    #[must_use]
    pub const fn of(height_m: f32) -> Self {
        let height_m = height_m + 0.0;
        Self { min_m: height_m, max_m: height_m }
    }

    /// Of a row of heights; `None` for an empty one.
    #[must_use]
    pub fn of_row(heights: &[f32]) -> Option<Self> {
        let mut lanes = [Self::of(*heights.first()?); LANES];
        let (chunks, rest) = heights.as_chunks::<LANES>();
        for chunk in chunks {
            for (bounds, height_m) in lanes.iter_mut().zip(chunk) {
                *bounds = bounds.with(Self::of(*height_m));
            }
        }
        let rest = rest.iter().map(|height_m| Self::of(*height_m));
        lanes.into_iter().chain(rest).reduce(Self::with)
    }

    /// Of both parts together.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self {
            min_m: if other.min_m < self.min_m { other.min_m } else { self.min_m },
            max_m: if other.max_m > self.max_m { other.max_m } else { self.max_m },
        }
    }
}

impl TerrainGrid {
    /// All samples of a level, in samples of that level.
    #[must_use]
    pub fn bounds_at(&self, level: u8) -> SampleRect {
        let side = |samples: u32| {
            let below = if level < 32 { (samples - 1) >> level } else { 0 };
            (below + 1).cast_signed()
        };
        SampleRect::new(0, 0, side(self.width()), side(self.depth()))
    }
}

impl PageLayout {
    /// The last level: the first whose samples all lie in one page.
    #[must_use]
    pub fn top_level(&self, grid: &TerrainGrid) -> u8 {
        let longest = grid.width().max(grid.depth());
        let is_enough = |level: &u8| ((longest - 1) >> level) < self.size();
        (0..32).find(is_enough).unwrap_or(31)
    }

    /// Columns and rows of pages of a level; `(0, 0)` above [`Self::top_level`].
    #[must_use]
    pub fn num_pages_at(&self, grid: &TerrainGrid, level: u8) -> (u32, u32) {
        if level > self.top_level(grid) {
            return (0, 0);
        }
        let bounds = grid.bounds_at(level);
        (bounds.width().div_ceil(self.size()), bounds.depth().div_ceil(self.size()))
    }
}

impl PageLayout {
    /// Whether a terrain has such a page, which a key from outside need not be.
    #[must_use]
    pub fn has_page(&self, grid: &TerrainGrid, key: &PageKey) -> bool {
        let (columns, rows) = self.num_pages_at(grid, key.level);
        key.x < columns && key.z < rows
    }
}

impl PageKey {
    /// The page one level up that covers this one.
    #[must_use]
    pub const fn parent(&self) -> Self {
        Self { field: self.field, level: self.level.saturating_add(1), z: self.z / 2, x: self.x / 2 }
    }

    /// The four pages one level down that this one covers, row by row; some may lie beyond the terrain's edge. None at
    /// full resolution.
    pub fn children(&self) -> impl Iterator<Item = Self> + use<> {
        let Self { field, level, z, x } = *self;
        let below = level.checked_sub(1);
        below.into_iter().flat_map(move |level| {
            [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().filter_map(move |(dz, dx)| {
                let along = |place: u32, step: u32| place.checked_mul(2)?.checked_add(step);
                Some(Self { field, level, z: along(z, dz)?, x: along(x, dx)? })
            })
        })
    }
}

/// The samples of the next level that read any sample of `rect`.
#[must_use]
pub const fn rect_above(rect: &SampleRect) -> SampleRect {
    if rect.is_empty() {
        return SampleRect::EMPTY;
    }
    SampleRect::new(
        rect.x0.div_euclid(2),
        rect.z0.div_euclid(2),
        rect.x1.div_euclid(2) + 1,
        rect.z1.div_euclid(2) + 1,
    )
}

/// The samples of the level below that `rect` is made of. They may reach one sample past the terrain's edge, where the
/// sample on the edge counts instead.
#[must_use]
pub const fn rect_below(rect: &SampleRect) -> SampleRect {
    if rect.is_empty() {
        return SampleRect::EMPTY;
    }
    SampleRect::new(2 * rect.x0 - 1, 2 * rect.z0 - 1, 2 * rect.x1, 2 * rect.z1)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn any_page(level: u8, x: u32, z: u32) -> PageKey {
        PageKey { field: crate::FieldId(0), level, z, x }
    }

    fn grid(width: u64, depth: u64) -> TerrainGrid {
        TerrainGrid::new(width, depth, 1.0).unwrap()
    }

    #[test]
    fn levels_halve_rounding_up_and_end_with_one_page() {
        let layout = PageLayout::new(64).unwrap();
        let oblong = grid(200, 65);
        let sides: Vec<_> = (0..4).map(|k| oblong.bounds_at(k)).map(|b| (b.x1, b.z1)).collect();
        assert_eq!(sides, [(200, 65), (100, 33), (50, 17), (25, 9)]);
        assert_eq!(layout.top_level(&oblong), 2);
        let pages: Vec<_> = (0..4).map(|level| layout.num_pages_at(&oblong, level)).collect();
        assert_eq!(pages, [(4, 2), (2, 1), (1, 1), (0, 0)]);
        let is_there = |level, x, z| layout.has_page(&oblong, &any_page(level, x, z));
        assert!(is_there(0, 3, 1) && is_there(2, 0, 0));
        assert!(
            !is_there(0, 4, 0) && !is_there(0, 0, 2) && !is_there(3, 0, 0) && !is_there(255, u32::MAX, 0)
        );
        let planet = grid(1 << 20, 1 << 20);
        assert_eq!(PageLayout::default().top_level(&planet), 12);
        assert_eq!(PageLayout::default().num_pages_at(&planet, 0), (4096, 4096));
        assert_eq!(PageLayout::default().num_pages_at(&planet, 12), (1, 1));
        assert_eq!(layout.top_level(&grid(1, 1)), 0);
        for level in [1, 31, 33, 255] {
            assert_eq!(layout.num_pages_at(&grid(1, 1), level), (0, 0), "level {level}");
        }
    }

    #[test]
    fn bounds_hold_both_parts() {
        assert_eq!(HeightBounds::of_row(&[]), None);
        let low = HeightBounds::of_row(&[3.0, -1.0, 2.0]).unwrap();
        assert_eq!(low, HeightBounds { min_m: -1.0, max_m: 3.0 });
        assert_eq!(HeightBounds::of_row(&[-0.0]).map(|bounds| bounds.min_m.to_bits()), Some(0));
        assert_eq!(low.with(HeightBounds::of(7.0)), HeightBounds { min_m: -1.0, max_m: 7.0 });
    }

    proptest! {
        #[test]
        fn a_level_is_half_of_the_one_below(width in 1_u64..=1 << 20, depth in 1_u64..5000, level in 0_u8..20) {
            let grid = grid(width, depth);
            let (below, above) = (grid.bounds_at(level), grid.bounds_at(level + 1));
            prop_assert_eq!(above.width(), below.width().div_ceil(2));
            prop_assert_eq!(above.depth(), below.depth().div_ceil(2));
        }

        #[test]
        fn parents_cover_their_children(x in 0_u32..5000, z in 0_u32..5000, level in 1_u8..12) {
            let page = any_page(level, x, z);
            let children: Vec<_> = page.children().collect();
            prop_assert_eq!(children.len(), 4);
            prop_assert!(children.iter().all(|child| child.parent() == page));
        }

        /// Against the definition: sample `i` reads `2i - 1 ..= 2i + 1`.
        #[test]
        fn what_reads_a_rectangle_is_above_it(x0 in 0_i32..60, z0 in 0_i32..60, width in 1_i32..40, depth in 1_i32..40) {
            let rect = SampleRect::new(x0, z0, x0 + width, z0 + depth);
            let reads = |i: i32, start: i32, end: i32| (2 * i - 1..=2 * i + 1).any(|s| (start..end).contains(&s));
            let columns: Vec<i32> = (-2..80).filter(|i| reads(*i, rect.x0, rect.x1)).collect();
            let rows: Vec<i32> = (-2..80).filter(|i| reads(*i, rect.z0, rect.z1)).collect();
            let above = rect_above(&rect);
            prop_assert_eq!(columns, (above.x0..above.x1).collect::<Vec<_>>());
            prop_assert_eq!(rows, (above.z0..above.z1).collect::<Vec<_>>());
            let below = rect_below(&above);
            prop_assert_eq!((below.x0, below.x1), (2 * above.x0 - 1, 2 * (above.x1 - 1) + 2));
            prop_assert_eq!(below.intersection(&rect), rect);
        }
    }
}
