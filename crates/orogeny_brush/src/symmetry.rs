//! Copies of a stroke: mirrored in an axis, through a point, or turned about one.

use orogeny_field::{Brush, Symmetry, SymmetryKind, TerrainGrid};

/// Copies nearer to one another than this, in samples, are one: a stroke on its own mirror counts once.
const SAME_PLACE: f64 = 1.0e-3;

/// A rotation or reflection of the plane, in samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Image {
    /// What the unit vectors become.
    columns: [[f64; 2]; 2],
    centre: [f64; 2],
    /// Whether left and right change places.
    pub(crate) is_reflection: bool,
}

impl Image {
    /// Everything where it is.
    pub(crate) const IDENTITY: Self =
        Self { columns: [[1.0, 0.0], [0.0, 1.0]], centre: [0.0, 0.0], is_reflection: false };

    /// What undoes it.
    pub(crate) const fn inverse(&self) -> Self {
        let [[xx, xz], [zx, zz]] = self.columns;
        Self { columns: [[xx, zx], [xz, zz]], ..*self }
    }

    /// What a way becomes.
    pub(crate) fn way(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        let [[xx, xz], [zx, zz]] = self.columns;
        [x * xx + z * zx, x * xz + z * zz]
    }

    /// What a place becomes.
    pub(crate) fn place(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        let [centre_x, centre_z] = self.centre;
        let [x, z] = self.way([x - centre_x, z - centre_z]);
        [centre_x + x, centre_z + z]
    }
}

/// A stroke's images, itself first.
pub(crate) fn images(symmetry: Option<&Symmetry>, grid: &TerrainGrid) -> Vec<Image> {
    let Some(symmetry) = symmetry else { return vec![Image::IDENTITY] };
    let centre = grid.sample_from_world(symmetry.centre_m);
    let turned = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        Image { columns: [[cos, sin], [-sin, cos]], centre, is_reflection: false }
    };
    match symmetry.kind {
        SymmetryKind::Axis { angle_deg } => {
            let (sin, cos) = (2.0 * angle_deg.to_radians()).sin_cos();
            let mirrored = Image { columns: [[cos, sin], [sin, -cos]], centre, is_reflection: true };
            vec![Image::IDENTITY, mirrored]
        }
        SymmetryKind::Point => {
            vec![Image::IDENTITY, Image { columns: [[-1.0, 0.0], [0.0, -1.0]], centre, is_reflection: false }]
        }
        SymmetryKind::Radial { count } => {
            let step = std::f64::consts::TAU / f64::from(count);
            let others = (1..count).map(|k| turned(step * f64::from(k)));
            std::iter::once(Image::IDENTITY).chain(others).collect()
        }
    }
}

/// Where a brush at a place of the terrain acts: there, and at its copies. In samples.
#[must_use]
pub fn copies(brush: &Brush, grid: &TerrainGrid, place: [f64; 2]) -> Vec<[f64; 2]> {
    places(&images(brush.symmetry.as_ref(), grid), place).into_iter().map(|(_, place)| place).collect()
}

/// The images of a place with what makes them, those that fall together once.
pub(crate) fn places(images: &[Image], place: [f64; 2]) -> Vec<(Image, [f64; 2])> {
    let mut places: Vec<(Image, [f64; 2])> = Vec::with_capacity(images.len());
    for image in images {
        let next = image.place(place);
        if places.iter().all(|(_, before)| crate::curve::distance(*before, next) >= SAME_PLACE) {
            places.push((*image, next));
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> TerrainGrid {
        TerrainGrid::new(100, 100, 2.0).unwrap()
    }

    fn found(kind: SymmetryKind, place: [f64; 2]) -> Vec<[f64; 2]> {
        let images = images(Some(&Symmetry { kind, centre_m: [20.0, 40.0] }), &grid());
        places(&images, place).into_iter().map(|(_, place)| place).collect()
    }

    fn assert_near(found: &[[f64; 2]], expected: &[[f64; 2]]) {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!(crate::curve::distance(*found, *expected) < 1.0e-9, "{found:?} {expected:?}");
        }
    }

    #[test]
    fn copies_lie_where_they_should() {
        // The centre is sample (10, 20).
        assert_near(
            &found(SymmetryKind::Axis { angle_deg: 90.0 }, [13.0, 25.0]),
            &[[13.0, 25.0], [7.0, 25.0]],
        );
        assert_near(
            &found(SymmetryKind::Axis { angle_deg: 45.0 }, [13.0, 20.0]),
            &[[13.0, 20.0], [10.0, 23.0]],
        );
        assert_near(&found(SymmetryKind::Point, [13.0, 25.0]), &[[13.0, 25.0], [7.0, 15.0]]);
        assert_near(
            &found(SymmetryKind::Radial { count: 4 }, [13.0, 20.0]),
            &[[13.0, 20.0], [10.0, 23.0], [7.0, 20.0], [10.0, 17.0]],
        );
    }

    #[test]
    fn a_place_on_its_own_mirror_counts_once() {
        assert_near(&found(SymmetryKind::Axis { angle_deg: 90.0 }, [10.0, 3.0]), &[[10.0, 3.0]]);
        assert_near(&found(SymmetryKind::Radial { count: 7 }, [10.0, 20.0]), &[[10.0, 20.0]]);
    }
}
