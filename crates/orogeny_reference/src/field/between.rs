//! Values between the samples of a plane: the Catmull-Rom spline along x and then along z (Catmull & Rom 1974; Keys 1981 with
//! a = −½), held to the least and the greatest of the 4 × 4 samples that it is made of, so that a cliff is followed by no trench.

use orogeny_field::{Mirrors, Plane};

/// A plane, and how the ground that it is a part of goes on beyond its border.
#[derive(Debug, Clone, Copy)]
pub struct Ground<'a> {
    /// The plane.
    pub plane: &'a Plane,
    /// Where the ground is mirrored.
    pub mirrors: Mirrors,
}

impl Ground<'_> {
    /// The value `fraction` after a sample, 0..1 along x and z: the sample itself where that is nothing.
    #[inline]
    #[must_use]
    pub fn between(&self, [x, z]: [i32; 2], fraction: [f32; 2]) -> f32 {
        if fraction == [0.0, 0.0] {
            return self.at(x, z);
        }
        let [share_x, share_z] = fraction;
        let weights_x = weights(share_x);
        let mut column = [0.0; 4];
        let (mut lowest, mut highest) = (f32::INFINITY, f32::NEG_INFINITY);
        for (value, z) in column.iter_mut().zip(z.wrapping_sub(1)..) {
            let row = self.four(x.wrapping_sub(1), z);
            for sample in row {
                (lowest, highest) = (lowest.min(sample), highest.max(sample));
            }
            *value = sum(row, weights_x);
        }
        sum(column, weights(share_z)).max(lowest).min(highest)
    }

    /// Four samples of a row from column `x` on.
    #[inline(always)]
    fn four(&self, x: i32, z: i32) -> [f32; 4] {
        let first = x.wrapping_sub(self.plane.rect().x0) as usize;
        let whole = self.plane.row(z).and_then(|row| row.get(first..)?.first_chunk());
        whole.copied().unwrap_or_else(|| std::array::from_fn(|k| self.at(x.wrapping_add(k as i32), z)))
    }

    /// A sample.
    #[inline]
    fn at(&self, x: i32, z: i32) -> f32 {
        let sample = self.plane.at(self.mirrors.column(x), self.mirrors.row(z));
        debug_assert!(sample.is_some(), "{x}, {z} of {:?}", self.plane.rect());
        sample.unwrap_or_default()
    }
}

/// Of the sample before, the one at, and the two after a place `t` after the second; the third is what is left to 1.
#[inline(always)]
fn weights(t: f32) -> [f32; 3] {
    let before = t * (t * (1.0 - 0.5 * t) - 0.5);
    let next = t * (t * (2.0 - 1.5 * t) + 0.5);
    let after_next = t * t * (0.5 * t - 0.5);
    [before, next, after_next]
}

/// In differences from the second sample, so that equal ones keep their bits.
#[inline(always)]
fn sum([a, b, c, d]: [f32; 4], [before, next, after_next]: [f32; 3]) -> f32 {
    b + before * (a - b) + next * (c - b) + after_next * (d - b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::SampleRect;

    fn plane(height: impl Fn(i32, i32) -> f32) -> Plane {
        let samples = (0..9).flat_map(|z| (0..12).map(move |x| (x, z))).map(|(x, z)| height(x, z)).collect();
        Plane::from_samples(SampleRect::new(0, 0, 12, 9), 1, samples).unwrap()
    }

    #[test]
    fn a_plane_is_met_between_its_samples_and_a_sample_keeps_its_bits() {
        let slope = plane(|x, z| 3.0 * x as f32 - 2.0 * z as f32 + 0.1);
        let ground = Ground { plane: &slope, mirrors: Mirrors::of_extent([12, 9]) };
        for (x, z, share_x, share_z) in [(1, 1, 0.3, 0.0), (4, 5, 0.5, 0.75), (9, 6, 0.99, 0.01)] {
            let expected = 3.0 * (x as f32 + share_x) - 2.0 * (z as f32 + share_z) + 0.1;
            let found = ground.between([x, z], [share_x, share_z]);
            assert!((found - expected).abs() < 2.0e-5, "{x}, {z}: {found} and {expected}");
        }
        assert_eq!(ground.between([7, 3], [0.0, 0.0]).to_bits(), slope.at(7, 3).unwrap().to_bits());
        // Beyond its border it is mirrored.
        assert_eq!(ground.between([-2, 10], [0.0, 0.0]), slope.at(2, 6).unwrap());
        assert_eq!(ground.between([-3, 0], [0.5, 0.0]), ground.between([2, 0], [0.5, 0.0]));
    }

    #[test]
    fn a_cliff_is_followed_by_no_trench() {
        let cliff = plane(|x, _| if x < 6 { 100.0 } else { 7.0 });
        let ground = Ground { plane: &cliff, mirrors: Mirrors::NONE };
        for tenth in 0..40 {
            let place = 4.0 + tenth as f32 * 0.1;
            let found = ground.between([place.floor() as i32, 4], [place.fract(), 0.25]);
            assert!((7.0..=100.0).contains(&found), "{place}: {found}");
        }
    }
}
