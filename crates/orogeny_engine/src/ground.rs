//! A small grid of heights that is to be drawn: what it spans, and which way it slopes.

/// Heights, row by row from the north, at equal distances.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ground {
    /// Heights a row; at least one.
    pub(crate) width: usize,
    /// Whole rows, in metres.
    pub(crate) heights: Vec<f32>,
    /// Metres between neighbours.
    pub(crate) spacing_m: f32,
}

impl Ground {
    /// The number of rows.
    pub(crate) const fn depth(&self) -> usize {
        self.heights.len() / self.width
    }

    /// The lowest and the highest.
    pub(crate) fn range_m(&self) -> [f32; 2] {
        let lowest = self.heights.iter().copied().fold(f32::INFINITY, f32::min);
        [lowest, self.heights.iter().copied().fold(f32::NEG_INFINITY, f32::max)]
    }

    /// The height at a place, or at the nearest where there is none.
    pub(crate) fn at(&self, x: isize, z: isize) -> f32 {
        let x = x.clamp(0, self.width.cast_signed() - 1).unsigned_abs();
        let z = z.clamp(0, self.depth().cast_signed() - 1).unsigned_abs();
        self.heights.get(z * self.width + x).copied().unwrap_or_default()
    }

    /// The height between four samples, linear along both axes.
    pub(crate) fn between(&self, [x, z]: [f32; 2]) -> f32 {
        let (column, row) = (x.floor(), z.floor());
        let (right, down) = (x - column, z - row);
        let (column, row) = (column as isize, row as isize);
        let along = |row| {
            let left = self.at(column, row);
            left + right * (self.at(column + 1, row) - left)
        };
        let upper = along(row);
        upper + down * (along(row + 1) - upper)
    }

    /// The upward normal by Horn's weighted differences (Horn 1981).
    pub(crate) fn normal(&self, x: isize, z: isize) -> [f32; 3] {
        let column = |x: isize| self.at(x, z - 1) + 2.0 * self.at(x, z) + self.at(x, z + 1);
        let row = |z: isize| self.at(x - 1, z) + 2.0 * self.at(x, z) + self.at(x + 1, z);
        let slope_x = (column(x + 1) - column(x - 1)) / (8.0 * self.spacing_m);
        let slope_z = (row(z + 1) - row(z - 1)) / (8.0 * self.spacing_m);
        let length = (slope_x * slope_x + slope_z * slope_z + 1.0).sqrt();
        [-slope_x / length, 1.0 / length, -slope_z / length]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_of_a_plane_is_exact() {
        let height = |k: usize| 0.75 * (k % 5) as f32 - 0.5 * (k / 5) as f32;
        let plane = Ground { width: 5, heights: (0..25).map(height).collect(), spacing_m: 1.0 };
        let length = (0.75_f32 * 0.75 + 0.5 * 0.5 + 1.0).sqrt();
        for (found, expected) in plane.normal(2, 2).iter().zip([-0.75 / length, 1.0 / length, 0.5 / length]) {
            assert!((found - expected).abs() < 1.0e-6);
        }
    }
}
