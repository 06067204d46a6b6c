//! A plane of numbers, and how far those of the engine may be from them.

use orogeny_tests::Plane;

/// Numbers of all samples of a level, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    pub width: usize,
    pub depth: usize,
    pub values: Vec<f64>,
    /// How far from any of them the engine's, which are `f32`, may be, by rounding alone: grows with each step by what that makes of
    /// what was off before.
    pub off: f64,
}

/// So many units in the last place of an `f32` of a magnitude.
pub fn ulps(count: f64, magnitude: f64) -> f64 {
    count * magnitude.abs() * f64::from(f32::EPSILON)
}

impl Sheet {
    pub fn constant(width: usize, depth: usize, value: f64) -> Self {
        Self { width, depth, values: vec![value; width * depth], off: 0.0 }
    }

    pub fn from_fn(width: usize, depth: usize, mut value: impl FnMut(i32, i32) -> f64) -> Self {
        let places = (0..depth as i32).flat_map(|z| (0..width as i32).map(move |x| (x, z)));
        Self { width, depth, values: places.map(|(x, z)| value(x, z)).collect(), off: 0.0 }
    }

    pub fn at(&self, x: i32, z: i32) -> f64 {
        self.values[self.index(x, z)]
    }

    pub fn at_mut(&mut self, x: i32, z: i32) -> &mut f64 {
        let index = self.index(x, z);
        &mut self.values[index]
    }

    fn index(&self, x: i32, z: i32) -> usize {
        let (x, z) = (usize::try_from(x).unwrap(), usize::try_from(z).unwrap());
        assert!(x < self.width && z < self.depth, "{x}, {z}");
        z * self.width + x
    }

    /// The value where the terrain is mirrored at its first and last samples.
    pub fn mirrored(&self, x: i32, z: i32) -> f64 {
        let fold = |place: i32, count: usize| {
            let last = count as i32 - 1;
            let mut place = place;
            while last > 0 && !(0..=last).contains(&place) {
                place = if place < 0 { -place } else { 2 * last - place };
            }
            if last == 0 { 0 } else { place }
        };
        self.at(fold(x, self.width), fold(z, self.depth))
    }

    /// The greatest magnitude.
    pub fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
    }

    /// The same numbers with another doubt.
    pub fn off_by(self, off: f64) -> Self {
        Self { off, ..self }
    }

    pub fn off_by_both(self, a: &Self, b: &Self) -> Self {
        self.off_by(a.off + b.off + ulps(1.0, 1.0))
    }

    pub fn off_by_both_times(self, a: &Self, b: &Self) -> Self {
        self.off_by(a.off * b.largest() + b.off * a.largest())
    }

    /// Each value by itself, by what is at most so steep.
    pub fn map(&self, steepness: f64, change: impl Fn(f64) -> f64) -> Self {
        let values = self.values.iter().map(|value| change(*value)).collect();
        Self { values, off: steepness * self.off + ulps(1.0, 1.0), ..*self }
    }

    /// Two made one; exact until it is said otherwise.
    pub fn zip(&self, other: &Self, join: impl Fn(f64, f64) -> f64) -> Self {
        assert_eq!((self.width, self.depth), (other.width, other.depth));
        let values = self.values.iter().zip(&other.values).map(|(a, b)| join(*a, *b)).collect();
        Self { values, off: 0.0, ..*self }
    }

    pub fn zip3(&self, second: &Self, third: &Self, join: impl Fn(f64, f64, f64) -> f64) -> Self {
        assert_eq!((self.width, self.depth), (third.width, third.depth));
        let pairs = self.values.iter().zip(&second.values).zip(&third.values);
        Self { values: pairs.map(|((a, b), c)| join(*a, *b, *c)).collect(), off: 0.0, ..*self }
    }

    /// Two weights multiplied: one that is 1 takes nothing of the other's exactness.
    pub fn times(&self, other: &Self) -> Self {
        let is_one = |sheet: &Self| sheet.off == 0.0 && sheet.values.iter().all(|value| *value == 1.0);
        if is_one(other) {
            return self.clone();
        }
        if is_one(self) {
            return other.clone();
        }
        self.zip(other, |a, b| a * b).off_by_both(self, other)
    }

    /// Rounded to `f32`.
    pub fn plane(&self) -> Plane {
        Plane::new(
            self.width as u32,
            self.depth as u32,
            self.values.iter().map(|value| *value as f32).collect(),
        )
    }

    /// Of a plane's heights.
    pub fn of(plane: &Plane) -> Self {
        let values = plane.samples().iter().map(|height| f64::from(*height)).collect();
        Self { width: plane.width() as usize, depth: plane.depth() as usize, values, off: 0.0 }
    }
}

#[test]
fn a_sheet_is_mirrored_at_its_ends() {
    let sheet = Sheet::from_fn(3, 1, |x, _| f64::from(x));
    let found: Vec<f64> = (-5..8).map(|x| sheet.mirrored(x, x)).collect();
    assert_eq!(found, [1.0, 0.0, 1.0, 2.0, 1.0, 0.0, 1.0, 2.0, 1.0, 0.0, 1.0, 2.0, 1.0]);
}
