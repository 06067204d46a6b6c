//! A uniform bicubic B-spline whose control points are every so many samples, anchored to the terrain's grid.

use std::sync::Arc;

use orogeny_field::{PhaseWeights, b_spline_phases};

use super::{Axis, Graph, Step};

/// The widest lattice: a table has as many phases.
const MAX_SPACING: u32 = 1 << 12;

/// Adds the spline over control points about `spacing` samples apart: the nearest power of two, from 2 on.
pub(super) fn add(graph: &mut Graph, input: usize, spacing: f64) -> usize {
    let exponent = spacing.max(1.0).log2().round().clamp(1.0, f64::from(MAX_SPACING.ilog2()));
    let spacing = 1 << exponent as u32;
    let mut node = input;
    for axis in [Axis::X, Axis::Z] {
        node = graph.add(Step::Convolve { axis, stride: spacing, weights: Arc::new([]) }, &[node]);
    }
    let phases: Arc<[PhaseWeights]> = b_spline_phases(spacing).into();
    for axis in [Axis::Z, Axis::X] {
        node = graph.add(Step::Interpolate { axis, phases: Arc::clone(&phases) }, &[node]);
    }
    node
}
