//! The sample grid of a terrain and its place in the world.

use crate::{Error, Result, SampleRect};

/// The longest side of a terrain, in samples.
pub const MAX_SIDE_SAMPLES: u32 = 1 << 20;
/// The finest sample spacing, in metres.
pub const MIN_SPACING_M: f64 = 1.0e-3;
/// The coarsest sample spacing, in metres.
pub const MAX_SPACING_M: f64 = 1.0e6;

/// Size and sample spacing of a terrain. Sample `(i, j)` lies at `(i * spacing, j * spacing)` metres; the terrain covers
/// `[0, width * spacing) x [0, depth * spacing)`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct TerrainGrid {
    width: u32,
    depth: u32,
    spacing_m: f64,
}

impl TerrainGrid {
    /// A grid of `width x depth` samples, `spacing_m` metres apart.
    ///
    /// # Errors
    /// [`Error::TerrainSize`] unless each side has 1 to [`MAX_SIDE_SAMPLES`] samples; [`Error::Spacing`] unless the
    /// spacing is within [`MIN_SPACING_M`] to [`MAX_SPACING_M`].
    pub fn new(width: u64, depth: u64, spacing_m: f64) -> Result<Self> {
        let side = |samples: u64| u32::try_from(samples).ok().filter(|s| (1..=MAX_SIDE_SAMPLES).contains(s));
        let (Some(width), Some(depth)) = (side(width), side(depth)) else {
            return Err(Error::TerrainSize { width, depth, limit: MAX_SIDE_SAMPLES });
        };
        if !(MIN_SPACING_M..=MAX_SPACING_M).contains(&spacing_m) {
            return Err(Error::Spacing { spacing_m, min_m: MIN_SPACING_M, max_m: MAX_SPACING_M });
        }
        Ok(Self { width, depth, spacing_m })
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

    /// Metres between neighbouring samples.
    #[must_use]
    pub const fn spacing_m(&self) -> f64 {
        self.spacing_m
    }

    /// All samples of the terrain.
    #[must_use]
    pub const fn bounds(&self) -> SampleRect {
        SampleRect::new(0, 0, self.width.cast_signed(), self.depth.cast_signed())
    }

    /// Sample coordinates of a world position, not rounded.
    #[must_use]
    pub fn sample_from_world(&self, [x_m, z_m]: [f64; 2]) -> [f64; 2] {
        [x_m / self.spacing_m, z_m / self.spacing_m]
    }

    /// The samples of the terrain in a region `[x, z, width, depth]` in metres. The far edges are outside; samples within
    /// 1e-6 of a spacing of an edge count as on it.
    ///
    /// # Errors
    /// [`Error::Region`] unless all four are finite and width and depth are above 0.
    pub fn samples_in_region(&self, [x_m, z_m, width_m, depth_m]: [f64; 4]) -> Result<SampleRect> {
        let finite = [x_m, z_m, width_m, depth_m].iter().all(|v| v.is_finite());
        if !finite || width_m <= 0.0 || depth_m <= 0.0 {
            return Err(Error::Region { x_m, z_m, width_m, depth_m });
        }
        // A float to integer cast saturates, which the intersection with the terrain makes right.
        let first = |edge_m: f64| (edge_m / self.spacing_m - 1.0e-6).ceil() as i32;
        let region = SampleRect::new(first(x_m), first(z_m), first(x_m + width_m), first(z_m + depth_m));
        Ok(region.intersection(&self.bounds()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_sizes_and_spacings_are_refused() {
        for (width, depth) in [(0, 8), (8, 0), (1 << 40, 1 << 40), (u64::from(MAX_SIDE_SAMPLES) + 1, 1)] {
            assert!(matches!(TerrainGrid::new(width, depth, 1.0), Err(Error::TerrainSize { .. })));
        }
        for spacing_m in [0.0, -1.0, f64::NAN, f64::INFINITY, 1.0e-9, 1.0e9] {
            assert!(matches!(TerrainGrid::new(8, 8, spacing_m), Err(Error::Spacing { .. })));
        }
        assert!(TerrainGrid::new(1 << 20, 1, 0.001).is_ok());
    }

    #[test]
    fn a_region_holds_the_samples_between_its_edges() {
        let grid = TerrainGrid::new(100, 100, 0.1).unwrap();
        // 0.3 / 0.1 is 2.9999999999999996 in floating point: the sample on the edge must not be lost or doubled.
        let left = grid.samples_in_region([0.0, 0.0, 0.3, 1.0]).unwrap();
        let right = grid.samples_in_region([0.3, 0.0, 0.3, 1.0]).unwrap();
        assert_eq!((left.x0, left.x1), (0, 3));
        assert_eq!((right.x0, right.x1), (3, 6));
        let outside = grid.samples_in_region([1.0e300, 0.0, 1.0, 1.0]).unwrap();
        assert!(outside.is_empty());
        let all = grid.samples_in_region([-1.0e300, -1.0e300, f64::MAX, f64::MAX]).unwrap();
        assert_eq!(all, grid.bounds());
        assert!(grid.samples_in_region([0.0, 0.0, 0.0, 1.0]).is_err());
        assert!(grid.samples_in_region([f64::NAN, 0.0, 1.0, 1.0]).is_err());
    }
}
