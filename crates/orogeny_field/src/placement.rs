//! Where the samples of one ground lie on another: moved, turned, enlarged, mirrored.

use crate::{MAX_SIDE_SAMPLES, SampleRect};

/// Places this near to a whole sample, in samples, lie on it.
const ON_A_SAMPLE: f64 = 1.0e-6;
/// Far outside of every ground, in samples: places beyond are as good as there.
const FAR: f64 = 4.0 * MAX_SIDE_SAMPLES as f64;

/// An affine map from the samples of a terrain to places on a source, in the source's samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// What a step along x and one along z become.
    columns: [[f64; 2]; 2],
    /// Where sample (0, 0) lies.
    offset: [f64; 2],
}

/// A part of a place: the whole samples of it and the rest, 0..1. A sample's place is the sum of its column's and its row's.
/// The layout is that of `Place` in `shaders/driver/place.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Place {
    /// Along x and z.
    pub cell: [i32; 2],
    /// Along x and z.
    pub fraction: [f32; 2],
}

/// The part of a source that is copied. The layout is that of `Cover` in `shaders/field/cover.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Part {
    /// Its first sample along x and z.
    pub first: [i32; 2],
    /// Its last sample.
    pub last: [i32; 2],
    /// 1 over the samples over which it begins at its edges; 0 for hard ones.
    pub inverse_feather: f32,
    /// Nothing.
    pub padding: u32,
}

/// How a source lies on a terrain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placing {
    /// A place on the source, in metres …
    pub at_m: [f64; 2],
    /// … and where it comes to lie on the terrain.
    pub to_m: [f64; 2],
    /// Degrees by which the source is turned from x towards z.
    pub rotation_deg: f64,
    /// How much larger it becomes, above 0.
    pub scale: f64,
    /// Whether its left and right change places, before it is turned.
    pub is_mirrored: bool,
    /// Metres between its samples.
    pub source_spacing_m: f64,
    /// Metres between the terrain's.
    pub spacing_m: f64,
}

impl Placement {
    /// The map of a placing. One that neither turns nor scales moves by whole samples, so that what is copied keeps its bits.
    #[must_use]
    pub fn new(placing: &Placing) -> Self {
        let Placing { at_m, to_m, rotation_deg, scale, is_mirrored, source_spacing_m, spacing_m } = *placing;
        let (sin, cos) = rotation_deg.to_radians().sin_cos();
        let mirror = if is_mirrored { -1.0 } else { 1.0 };
        // Back the way that the source came: turned back, made smaller, mirrored.
        let ratio = spacing_m / (scale * source_spacing_m);
        let near_whole = |value: f64| {
            let whole = value.round();
            if (value - whole).abs() < 1.0e-9 { whole } else { value }
        };
        let columns = [[mirror * cos, -sin], [mirror * sin, cos]]
            .map(|column| column.map(|part| near_whole(part * ratio)));
        let [[xx, xz], [zx, zz]] = columns;
        let [to_x, to_z] = to_m.map(|to_m| to_m / spacing_m);
        let [at_x, at_z] = at_m.map(|at_m| at_m / source_spacing_m);
        let offset = [at_x - (xx * to_x + zx * to_z), at_z - (xz * to_x + zz * to_z)];
        let is_grid_kept = columns.iter().flatten().all(|part| [-1.0, 0.0, 1.0].contains(part));
        Self { columns, offset: if is_grid_kept { offset.map(f64::round) } else { offset } }
    }

    /// The same map of what `before` makes of a terrain's samples, a turn or a mirror.
    #[must_use]
    pub fn after(&self, before: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        let place = |sample| self.place(before(sample));
        let offset = place([0.0, 0.0]);
        let step = |[x, z]: [f64; 2]| {
            let [offset_x, offset_z] = offset;
            [x - offset_x, z - offset_z]
        };
        Self { columns: [step(place([1.0, 0.0])), step(place([0.0, 1.0]))], offset }
    }

    /// The place of a terrain's sample.
    #[must_use]
    pub fn place(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        let ([[xx, xz], [zx, zz]], [offset_x, offset_z]) = (self.columns, self.offset);
        [offset_x + (xx * x + zx * z), offset_z + (xz * x + zz * z)]
    }

    /// What column `x` has of its samples' places.
    #[must_use]
    pub fn column(&self, x: i32) -> Place {
        let [[xx, xz], _] = self.columns;
        part([xx * f64::from(x), xz * f64::from(x)])
    }

    /// What row `z` has of them.
    #[must_use]
    pub fn row(&self, z: i32) -> Place {
        let ([_, [zx, zz]], [offset_x, offset_z]) = (self.columns, self.offset);
        part([offset_x + zx * f64::from(z), offset_z + zz * f64::from(z)])
    }

    /// By how many whole samples it moves, where it does nothing else.
    #[must_use]
    pub fn whole_samples(&self) -> Option<[i32; 2]> {
        let is_move = self.columns == [[1.0, 0.0], [0.0, 1.0]];
        let Place { cell, fraction } = self.row(0);
        (is_move && fraction == [0.0, 0.0]).then_some(cell)
    }

    /// How many samples of the source lie between two of the terrain.
    #[must_use]
    pub fn samples_between(&self) -> f64 {
        let [[xx, xz], _] = self.columns;
        xx.hypot(xz)
    }

    /// The same map to the source's level of the pyramid.
    #[must_use]
    pub fn on_level(&self, level: u32) -> Self {
        let scale = 0.5_f64.powi(level.cast_signed());
        Self {
            columns: self.columns.map(|column| column.map(|part| part * scale)),
            offset: self.offset.map(|part| part * scale),
        }
    }

    /// The samples of a terrain, and some around them, whose places lie within a rectangle of the source.
    #[must_use]
    pub fn terrain_rect(&self, rect: &SampleRect) -> SampleRect {
        if let Some([x, z]) = self.whole_samples() {
            let (x0, x1) = (rect.x0.saturating_sub(x), rect.x1.saturating_sub(x));
            return SampleRect::new(x0, rect.z0.saturating_sub(z), x1, rect.z1.saturating_sub(z));
        }
        let [[xx, xz], [zx, zz]] = self.columns;
        let inverse_determinant = 1.0 / (xx * zz - xz * zx);
        let columns = [[zz, -xz], [-zx, xx]].map(|column| column.map(|part| part * inverse_determinant));
        let back = Self { columns, offset: [0.0; 2] };
        let [from_x, from_z] = back.place(self.offset);
        let corners = [(rect.x0, rect.z0), (rect.x1, rect.z0), (rect.x0, rect.z1), (rect.x1, rect.z1)];
        let places = corners.map(|(x, z)| {
            let [x, z] = back.place([f64::from(x), f64::from(z)]);
            [x - from_x, z - from_z]
        });
        let bounds = |along: fn(&[f64; 2]) -> f64| {
            let parts = || places.iter().map(along);
            let (low, high) = (parts().fold(f64::MAX, f64::min), parts().fold(f64::MIN, f64::max));
            // Casts saturate: beyond is no terrain.
            ((low.floor() as i32).saturating_sub(1), (high.ceil() as i32).saturating_add(1))
        };
        let ((x0, x1), (z0, z1)) = (bounds(|[x, _]| *x), bounds(|[_, z]| *z));
        SampleRect::new(x0, z0, x1, z1)
    }

    /// The source's samples at or before the places of a rectangle's samples, and the next ones, if there are places between.
    #[must_use]
    pub fn source_rect(&self, rect: &SampleRect) -> SampleRect {
        if rect.is_empty() {
            return SampleRect::EMPTY;
        }
        if let Some([x, z]) = self.whole_samples() {
            let (x0, x1) = (rect.x0.saturating_add(x), rect.x1.saturating_add(x));
            return SampleRect::new(x0, rect.z0.saturating_add(z), x1, rect.z1.saturating_add(z));
        }
        let corners =
            [(rect.x0, rect.z0), (rect.x1 - 1, rect.z0), (rect.x0, rect.z1 - 1), (rect.x1 - 1, rect.z1 - 1)];
        // Of the parts that kernels add up: far away each is cut by itself, which the place as a whole would not show.
        let cells = corners.map(|(x, z)| Place::sum(self.column(x), self.row(z)).0);
        // Rounding is another in each: a sample more on each side holds whatever comes of it.
        let bounds = |along: fn(&[i32; 2]) -> i32| {
            let parts = || cells.iter().map(along);
            (parts().min().unwrap_or_default() - 1, parts().max().unwrap_or_default() + 3)
        };
        let ((x0, x1), (z0, z1)) = (bounds(|[x, _]| *x), bounds(|[_, z]| *z));
        SampleRect::new(x0, z0, x1, z1)
    }
}

fn part(place: [f64; 2]) -> Place {
    let place = place.map(|part| {
        let part = part.clamp(-FAR, FAR);
        if (part - part.round()).abs() < ON_A_SAMPLE { part.round() } else { part }
    });
    let cell = place.map(f64::floor);
    let [x, z] = place;
    let [cell_x, cell_z] = cell;
    Place { cell: cell.map(|cell| cell as i32), fraction: [(x - cell_x) as f32, (z - cell_z) as f32] }
}

impl Place {
    /// The sample at or before the sum of two parts, and how far after it that lies, 0..1.
    #[inline(always)]
    #[must_use]
    pub fn sum(column: Self, row: Self) -> ([i32; 2], [f32; 2]) {
        let [column_x, column_z] = column.fraction;
        let [row_x, row_z] = row.fraction;
        let [cell_x, cell_z] = column.cell;
        let [row_cell_x, row_cell_z] = row.cell;
        let (x, z) = (column_x + row_x, column_z + row_z);
        // Both are below 1, so at most one whole sample comes of them.
        let (whole_x, whole_z) = (if x >= 1.0 { 1.0 } else { 0.0 }, if z >= 1.0 { 1.0 } else { 0.0 });
        (
            [
                cell_x.wrapping_add(row_cell_x).wrapping_add(whole_x as i32),
                cell_z.wrapping_add(row_cell_z).wrapping_add(whole_z as i32),
            ],
            [x - whole_x, z - whole_z],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HERE: Placing = Placing {
        at_m: [0.0, 0.0],
        to_m: [0.0, 0.0],
        rotation_deg: 0.0,
        scale: 1.0,
        is_mirrored: false,
        source_spacing_m: 2.0,
        spacing_m: 2.0,
    };

    fn assert_place(placing: Placing, sample: [f64; 2], expected: [f64; 2]) {
        let found = Placement::new(&placing).place(sample);
        let apart = (found[0] - expected[0]).hypot(found[1] - expected[1]);
        assert!(apart < 1.0e-9, "{placing:?}: {found:?} instead of {expected:?}");
    }

    #[test]
    fn a_source_is_mirrored_enlarged_turned_and_moved() {
        assert_place(HERE, [5.0, 7.0], [5.0, 7.0]);
        // What lies at (100, 40) m comes to (20, 10) m.
        let moved = Placing { at_m: [100.0, 40.0], to_m: [20.0, 10.0], ..HERE };
        assert_place(moved, [10.0, 5.0], [50.0, 20.0]);
        assert_place(moved, [13.0, 5.0], [53.0, 20.0]);
        // A quarter turn from x towards z: what lay to the east lies to the south.
        assert_place(Placing { rotation_deg: 90.0, ..HERE }, [0.0, 3.0], [3.0, 0.0]);
        assert_place(Placing { scale: 2.0, ..HERE }, [6.0, 8.0], [3.0, 4.0]);
        assert_place(Placing { source_spacing_m: 1.0, ..HERE }, [6.0, 8.0], [12.0, 16.0]);
        assert_place(Placing { is_mirrored: true, ..HERE }, [6.0, 8.0], [-6.0, 8.0]);
        // Mirrored first, then turned: what lay to the west lies to the east, and then to the south.
        assert_place(Placing { is_mirrored: true, rotation_deg: 90.0, ..HERE }, [0.0, 3.0], [-3.0, 0.0]);
    }

    #[test]
    fn a_move_is_one_by_whole_samples() {
        let moved = Placement::new(&Placing { at_m: [101.3, 40.9], to_m: [20.0, 10.0], ..HERE });
        assert_eq!(moved.whole_samples(), Some([41, 15]));
        let turned = Placement::new(&Placing { rotation_deg: 180.0, at_m: [100.7, 41.0], ..HERE });
        assert_eq!(turned.whole_samples(), None);
        assert_eq!(Place::sum(turned.column(3), turned.row(4)), ([47, 17], [0.0, 0.0]));
        assert_eq!(Placement::new(&Placing { scale: 1.5, ..HERE }).whole_samples(), None);
    }

    proptest! {
        /// Column and row together are the place, however far away it is.
        #[test]
        fn a_place_is_that_of_its_column_and_that_of_its_row(
            at in -2.0e6_f64..2.0e6, to in -2.0e6_f64..2.0e6, rotation_deg in -360.0_f64..360.0,
            scale in 0.05_f64..20.0, is_mirrored: bool, x in 0_i32..1 << 20, z in 0_i32..1 << 20,
        ) {
            let placing = Placing { at_m: [at, 100.0], to_m: [to, -3.0], rotation_deg, scale, is_mirrored, ..HERE };
            let placement = Placement::new(&placing);
            let expected = placement.place([f64::from(x), f64::from(z)]);
            prop_assume!(expected.iter().all(|part| part.abs() < 0.4 * FAR));
            let columns_alone = placement.column(x).cell.iter().chain(&placement.row(z).cell).all(|cell| f64::from(cell.abs()) < FAR);
            prop_assume!(columns_alone);
            let (cell, fraction) = Place::sum(placement.column(x), placement.row(z));
            for ((cell, fraction), expected) in cell.iter().zip(fraction).zip(expected) {
                prop_assert!((0.0..1.0).contains(&fraction));
                let found = f64::from(*cell) + f64::from(fraction);
                prop_assert!((found - expected).abs() < 3.0e-6, "{found} instead of {expected}");
            }
            let rect = SampleRect::new(x, z, x + 1, z + 1);
            let [there_x, there_z] = cell;
            let there = SampleRect::new(there_x, there_z, there_x + 1, there_z + 1);
            prop_assert!(placement.terrain_rect(&there).contains(&rect));
            let source = placement.source_rect(&rect);
            let [cell_x, cell_z] = cell;
            let after = if placement.whole_samples().is_some() { 1 } else { 2 };
            prop_assert!(source.contains(&SampleRect::new(cell_x, cell_z, cell_x + after, cell_z + after)));
        }
    }
}
