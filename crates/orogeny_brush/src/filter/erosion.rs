//! Erosion: iterations of a simulation, one after another.
//!
//! What a sample becomes depends on no more than the samples that the iterations reach, so a simulation over any part of the
//! terrain and those around it gives the bits of one over all of it.

use std::sync::Arc;

use orogeny_field::{PipesKernel, ThermalKernel};

use super::{Graph, PipesPhase, Step, ThermalPhase};

/// Adds the ground after `iterations` of thermal erosion.
pub(super) fn add_thermal(graph: &mut Graph, input: usize, kernel: ThermalKernel, iterations: u32) -> usize {
    let kernel = Arc::new(kernel);
    let step = |phase| Step::Thermal { phase, kernel: Arc::clone(&kernel) };
    (0..iterations).fold(input, |heights, _| {
        let shares = graph.add(step(ThermalPhase::Shares), &[heights]);
        graph.add(step(ThermalPhase::Heights), &[heights, shares])
    })
}

/// Adds the ground after `iterations` of running water.
pub(super) fn add_pipes(graph: &mut Graph, input: usize, kernel: PipesKernel, iterations: u32) -> usize {
    let kernel = Arc::new(kernel);
    let step = |phase| Step::Pipes { phase, kernel: Arc::clone(&kernel) };
    let mut state = graph.add(step(PipesPhase::Begin), &[input]);
    let mut flux = None;
    for _ in 0..iterations {
        let new = match flux {
            None => graph.add(step(PipesPhase::FirstFlux), &[state]),
            Some(flux) => graph.add(step(PipesPhase::Flux), &[state, flux]),
        };
        state = graph.add(step(PipesPhase::Ground), &[state, new]);
        flux = Some(new);
    }
    graph.add(step(PipesPhase::Settle), &[state])
}
