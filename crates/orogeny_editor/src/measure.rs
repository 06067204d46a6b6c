//! What a line over the ground measures.

/// Steps that a line is walked in at most.
const MAX_STEPS: f64 = 512.0;

/// The ground along a straight line on the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// How long the line is on the map, metres.
    pub length_m: f64,
    /// Heights at equal distances from its first place to its last, metres: at least two.
    pub heights_m: Vec<f64>,
}

impl Measurement {
    /// Of the line between two places, `[x, z]` in metres, in steps as long as samples lie apart, or in as many as count.
    #[must_use]
    pub fn between(
        [from_m, to_m]: [[f64; 2]; 2],
        spacing_m: f64,
        height_m: impl Fn([f64; 2]) -> f64,
    ) -> Self {
        let way_m = [to_m[0] - from_m[0], to_m[1] - from_m[1]];
        let length_m = way_m[0].hypot(way_m[1]);
        let num_steps = (length_m / spacing_m).ceil().clamp(1.0, MAX_STEPS) as u32;
        let height = |step: u32| {
            let share = f64::from(step) / f64::from(num_steps);
            height_m([from_m[0] + share * way_m[0], from_m[1] + share * way_m[1]])
        };
        Self { length_m, heights_m: (0..=num_steps).map(height).collect() }
    }

    fn step_m(&self) -> f64 {
        self.length_m / (self.heights_m.len().max(2) - 1) as f64
    }

    fn rises_m(&self) -> impl Iterator<Item = f64> {
        self.heights_m.iter().zip(self.heights_m.iter().skip(1)).map(|(from_m, to_m)| to_m - from_m)
    }

    /// How long the way over the ground is, metres.
    #[must_use]
    pub fn along_ground_m(&self) -> f64 {
        let step_m = self.step_m();
        self.rises_m().map(|rise_m| rise_m.hypot(step_m)).sum()
    }

    /// How much higher the last place lies than the first, metres.
    #[must_use]
    pub fn difference_m(&self) -> f64 {
        self.rises_m().sum()
    }

    /// How far up, and how far down, the way goes in all, metres.
    #[must_use]
    pub fn up_down_m(&self) -> [f64; 2] {
        let up_m = self.rises_m().map(|rise_m| rise_m.max(0.0)).sum();
        [up_m, up_m - self.difference_m()]
    }

    /// How steep the way is on average, up or down, degrees.
    #[must_use]
    pub fn mean_slope_degrees(&self) -> f64 {
        let [up_m, down_m] = self.up_down_m();
        if self.length_m > 0.0 { ((up_m + down_m) / self.length_m).atan().to_degrees() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1.0e-6
    }

    #[test]
    fn a_slope_is_as_long_and_as_steep_as_it_is() {
        // 3 m up in 4 m to the east.
        let measured = Measurement::between([[10.0, 5.0], [90.0, 5.0]], 1.0, |[x, _]| 0.75 * x);
        assert_eq!(measured.heights_m.len(), 81);
        assert!(is_near(measured.length_m, 80.0) && is_near(measured.along_ground_m(), 100.0));
        assert!(is_near(measured.difference_m(), 60.0));
        assert!(is_near(measured.mean_slope_degrees(), 0.75_f64.atan().to_degrees()));
    }

    #[test]
    fn over_a_ridge_it_goes_up_and_down() {
        let ridge = |[x, _]: [f64; 2]| 50.0 - (x - 50.0_f64).abs();
        let measured = Measurement::between([[0.0, 0.0], [100.0, 0.0]], 2.0, ridge);
        assert!(is_near(measured.difference_m(), 0.0));
        let [up_m, down_m] = measured.up_down_m();
        assert!(is_near(up_m, 50.0) && is_near(down_m, 50.0));
        assert!(is_near(measured.mean_slope_degrees(), 45.0));
    }

    #[test]
    fn one_place_and_a_very_long_line_are_measured_too() {
        let one = Measurement::between([[3.0, 4.0]; 2], 1.0, |_| 7.0);
        assert_eq!((one.length_m, one.along_ground_m(), one.mean_slope_degrees()), (0.0, 0.0, 0.0));
        let long = Measurement::between([[0.0, 0.0], [0.0, 1.0e6]], 1.0, |_| 0.0);
        assert_eq!(long.heights_m.len(), 513);
        assert!(is_near(long.along_ground_m(), 1.0e6));
    }
}
