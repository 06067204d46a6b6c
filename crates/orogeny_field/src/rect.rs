//! Rectangles of samples.

/// A half-open rectangle of samples: `x0 <= i < x1`, `z0 <= j < z1`. It may lie outside a terrain, and may be empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SampleRect {
    /// First column.
    pub x0: i32,
    /// First row.
    pub z0: i32,
    /// One past the last column.
    pub x1: i32,
    /// One past the last row.
    pub z1: i32,
}

impl SampleRect {
    /// The rectangle with no samples.
    pub const EMPTY: Self = Self { x0: 0, z0: 0, x1: 0, z1: 0 };

    /// From its half-open edges.
    #[must_use]
    pub const fn new(x0: i32, z0: i32, x1: i32, z1: i32) -> Self {
        Self { x0, z0, x1, z1 }
    }

    /// Whether it holds no sample.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.x0 >= self.x1 || self.z0 >= self.z1
    }

    /// Samples along x; 0 where empty.
    #[must_use]
    pub const fn width(&self) -> u32 {
        if self.is_empty() { 0 } else { self.x1.abs_diff(self.x0) }
    }

    /// Samples along z; 0 where empty.
    #[must_use]
    pub const fn depth(&self) -> u32 {
        if self.is_empty() { 0 } else { self.z1.abs_diff(self.z0) }
    }

    /// Number of samples.
    #[must_use]
    pub const fn area(&self) -> u64 {
        self.width() as u64 * self.depth() as u64
    }

    /// The same rectangle with `margin` samples more on each side. Edges stop at the ends of `i32`.
    #[must_use]
    pub const fn grown(&self, margin: i32) -> Self {
        Self {
            x0: self.x0.saturating_sub(margin),
            z0: self.z0.saturating_sub(margin),
            x1: self.x1.saturating_add(margin),
            z1: self.z1.saturating_add(margin),
        }
    }

    /// Whether it holds all that `other` holds.
    #[must_use]
    pub const fn contains(&self, other: &Self) -> bool {
        other.is_empty()
            || (self.x0 <= other.x0 && self.z0 <= other.z0 && self.x1 >= other.x1 && self.z1 >= other.z1)
    }

    /// What both hold.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let both = Self {
            x0: self.x0.max(other.x0),
            z0: self.z0.max(other.z0),
            x1: self.x1.min(other.x1),
            z1: self.z1.min(other.z1),
        };
        if both.is_empty() { Self::EMPTY } else { both }
    }

    /// The smallest rectangle that holds both.
    #[must_use]
    pub fn bounds_with(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        if other.is_empty() {
            return *self;
        }
        Self {
            x0: self.x0.min(other.x0),
            z0: self.z0.min(other.z0),
            x1: self.x1.max(other.x1),
            z1: self.z1.max(other.z1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_rectangles_have_no_samples_and_no_bounds() {
        let inverted = SampleRect::new(5, 5, 2, 9);
        assert!(inverted.is_empty());
        assert_eq!(inverted.area(), 0);
        let some = SampleRect::new(-3, 1, 4, 2);
        assert_eq!(some.bounds_with(&inverted), some);
        assert_eq!(inverted.bounds_with(&some), some);
        assert_eq!(some.intersection(&SampleRect::new(4, 1, 9, 2)), SampleRect::EMPTY);
    }

    #[test]
    fn the_largest_terrain_has_an_exact_area() {
        let side = 1 << 20;
        assert_eq!(SampleRect::new(0, 0, side, side).area(), 1 << 40);
    }
}
