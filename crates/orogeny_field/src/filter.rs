//! Weights of the filters along one axis of which neighbourhood kernels are made.

/// Samples after which a Gaussian is cut, in its standard deviations.
const GAUSSIAN_CUT: f64 = 4.0;

/// The kernel `[1 4 6 4 1] / 16`, with which each level of a pyramid is made: weights of the neighbours one and two samples away
/// (Burt & Adelson 1983, with a = 3/8). Its variance is one sample.
pub const PYRAMID_WEIGHTS: [f32; 2] = [4.0 / 16.0, 1.0 / 16.0];

/// The same kernel twice, on a grid with a zero between each two samples: the way up a pyramid.
pub const PYRAMID_PHASES: [PhaseWeights; 2] = [
    PhaseWeights { before: 1.0 / 8.0, next: 1.0 / 8.0, after_next: 0.0 },
    PhaseWeights { before: 0.0, next: 1.0 / 2.0, after_next: 0.0 },
];

/// Weights of three of the four coarse samples `a b c d` around a value between `b` and `c`; `b` has what is left to 1.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct PhaseWeights {
    /// Of `a`.
    pub before: f32,
    /// Of `c`.
    pub next: f32,
    /// Of `d`.
    pub after_next: f32,
}

/// Weights of the neighbours 1, 2, … samples away in a Gaussian of standard deviation `sigma` samples (above 0), cut at four of
/// them and normalised together with the centre's.
#[must_use]
pub fn gaussian_weights(sigma: f64) -> Vec<f32> {
    let radius = (GAUSSIAN_CUT * sigma + 0.5).floor() as u32;
    let value = |away: u32| (-0.5 * (f64::from(away) / sigma).powi(2)).exp();
    let sum = 1.0 + 2.0 * (1..=radius).map(value).sum::<f64>();
    (1..=radius).map(|away| (value(away) / sum) as f32).collect()
}

/// Weights of the uniform cubic B-spline with control points `spacing` samples apart, for each sample from a control point on.
#[must_use]
pub fn b_spline_phases(spacing: u32) -> Vec<PhaseWeights> {
    let phase = |step: u32| {
        let t = f64::from(step) / f64::from(spacing);
        PhaseWeights {
            before: ((1.0 - t).powi(3) / 6.0) as f32,
            next: ((1.0 + 3.0 * t + 3.0 * t * t - 3.0 * t.powi(3)) / 6.0) as f32,
            after_next: (t.powi(3) / 6.0) as f32,
        }
    };
    (0..spacing).map(phase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gaussian_has_its_variance_and_sums_to_one() {
        for sigma in [1.0, 3.7, 8.0, 40.0] {
            let weights = gaussian_weights(sigma);
            assert_eq!(weights.len(), (4.0 * sigma + 0.5) as usize);
            let moment = |power: i32| -> f64 {
                (1..)
                    .zip(&weights)
                    .map(|(away, weight)| 2.0 * f64::from(away).powi(power) * f64::from(*weight))
                    .sum()
            };
            assert!(moment(0) < 1.0, "{sigma}");
            assert!((moment(2) / (sigma * sigma) - 1.0).abs() < 0.002, "{sigma}: {}", moment(2));
        }
    }

    #[test]
    fn a_b_spline_is_the_textbook_one_at_and_between_its_control_points() {
        let phases = b_spline_phases(2);
        let expected = [[1.0 / 6.0, 1.0 / 6.0, 0.0], [1.0 / 48.0, 23.0 / 48.0, 1.0 / 48.0]];
        for (weights, [before, next, after_next]) in phases.iter().zip(expected) {
            for (weight, expected) in
                [(weights.before, before), (weights.next, next), (weights.after_next, after_next)]
            {
                assert!((f64::from(weight) - expected).abs() < 1.0e-7, "{weights:?}");
            }
        }
    }
}
