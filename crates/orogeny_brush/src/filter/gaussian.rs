//! A Gaussian of any width: directly while it is narrow, else on the level of a pyramid where it is.
//!
//! A step down the pyramid and one up again each have a variance of one sample of the finer level, so `k` of both make
//! `2 (4^k − 1) / 3` samples; the Gaussian in between has what is left of `σ²`. What a step down folds over is
//! what that Gaussian then takes away.

use std::sync::Arc;

use orogeny_field::gaussian_weights;

use super::{Axis, Graph, Step, pyramid};

/// The widest Gaussian that is worked out directly, in samples: wider ones cost more so than by a pyramid.
const MAX_DIRECT_SIGMA: f64 = 4.0;

/// The narrowest Gaussian, in samples: narrower ones change nothing.
const MIN_SIGMA: f64 = 0.25;

/// Adds a plane smoothed by a Gaussian of standard deviation `sigma` samples.
pub(super) fn add(graph: &mut Graph, input: usize, sigma: f64) -> usize {
    let (num_levels, sigma) = on_level(sigma.max(MIN_SIGMA));
    let mut node = (0..num_levels).fold(input, |node, _| pyramid::reduce(graph, node));
    let weights: Arc<[f32]> = gaussian_weights(sigma).into();
    for axis in [Axis::X, Axis::Z] {
        node = graph.add(Step::Convolve { axis, stride: 1, weights: Arc::clone(&weights) }, &[node]);
    }
    (0..num_levels).fold(node, |node, _| pyramid::expand(graph, node))
}

/// The level on which a Gaussian is worked out, and its standard deviation in samples of that level.
fn on_level(sigma: f64) -> (u32, f64) {
    let (mut num_levels, mut on_level, mut scale) = (0, sigma, 1.0_f64);
    while on_level > MAX_DIRECT_SIGMA {
        num_levels += 1;
        scale *= 4.0;
        on_level = ((sigma * sigma - 2.0 * (scale - 1.0) / 3.0) / scale).sqrt();
    }
    (num_levels, on_level)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variances_of_all_steps_add_up_to_that_of_the_gaussian() {
        for sigma in [0.4, 3.9, 4.1, 7.9, 8.1, 33.3, 500.0, 3.0e4] {
            let (num_levels, on_level) = on_level(sigma);
            let steps: f64 = (0..num_levels).map(|level| 2.0 * 4.0_f64.powi(level as i32)).sum();
            let variance = steps + on_level * on_level * 4.0_f64.powi(num_levels as i32);
            assert!((variance / (sigma * sigma) - 1.0).abs() < 1.0e-12, "{sigma}");
            assert!(
                on_level <= MAX_DIRECT_SIGMA && (num_levels == 0 || on_level > 1.5),
                "{sigma}: {on_level}"
            );
        }
    }
}
