//! Erosion: iterations of a simulation, one after another.
//!
//! What a sample becomes depends on no more than the samples that the iterations reach, so a simulation over any part of the
//! terrain and those around it gives the bits of one over all of it.

use std::sync::Arc;

use orogeny_field::{PipesKernel, RainMask, RainShows, ThermalKernel};
use orogeny_reference::field::pipes;

use super::{Graph, PipesPhase, Step, ThermalPhase};
use crate::gate::GatePlan;

/// What is eroded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ground {
    heights: usize,
    /// How hard it is, 0..1.
    hardness: Option<usize>,
}

impl Ground {
    pub(super) fn new(graph: &mut Graph, heights: usize, hardness: Option<&Arc<GatePlan>>) -> Self {
        let hardness = hardness.map(|plan| graph.add(Step::Gate(Arc::clone(plan)), &[]));
        Self { heights, hardness }
    }

    /// The inputs of a step that takes ground away.
    fn with_hardness(self, inputs: &[usize]) -> Vec<usize> {
        inputs.iter().copied().chain(self.hardness).collect()
    }
}

/// Adds the ground after `iterations` of thermal erosion.
pub(super) fn add_thermal(
    graph: &mut Graph,
    ground: Ground,
    kernel: ThermalKernel,
    iterations: u32,
) -> usize {
    let kernel = Arc::new(kernel);
    let step = |phase| Step::Thermal { phase, kernel: Arc::clone(&kernel) };
    (0..iterations).fold(ground.heights, |heights, _| {
        let shares = graph.add(step(ThermalPhase::Shares), &ground.with_hardness(&[heights]));
        graph.add(step(ThermalPhase::Heights), &[heights, shares])
    })
}

/// Adds the ground after `iterations` of running water.
pub(super) fn add_pipes(graph: &mut Graph, ground: Ground, kernel: PipesKernel, iterations: u32) -> usize {
    add_shower(graph, ground, kernel, iterations).1
}

/// Adds a mask of what `iterations` of running water leave on the ground.
pub(super) fn add_rain_mask(
    graph: &mut Graph,
    ground: Ground,
    kernel: PipesKernel,
    iterations: u32,
    mask: &RainMask,
) -> usize {
    let (before, (state, after)) = (ground.heights, add_shower(graph, ground, kernel, iterations));
    let (plane, number) = match mask.shows {
        RainShows::Water => (state, pipes::WATER),
        RainShows::Sediment => (state, pipes::SEDIMENT),
        RainShows::Deposits => (graph.add(Step::Combine { factors: [1.0, -1.0] }, &[after, before]), 0),
        RainShows::Wear => (graph.add(Step::Combine { factors: [-1.0, 1.0] }, &[after, before]), 0),
    };
    // Finite for the narrowest range that `f32` tells apart.
    let inverse_width = (1.0 / (mask.to_m - mask.from_m)).min(f64::from(f32::MAX)) as f32;
    graph.add(Step::Channel { number, from: mask.from_m as f32, inverse_width }, &[plane])
}

/// Adds ground, water and sediment as they are when it ends, and the ground once all is laid down.
fn add_shower(graph: &mut Graph, ground: Ground, kernel: PipesKernel, iterations: u32) -> (usize, usize) {
    let kernel = Arc::new(kernel);
    let step = |phase| Step::Pipes { phase, kernel: Arc::clone(&kernel) };
    let mut state = graph.add(step(PipesPhase::Begin), &[ground.heights]);
    let mut flux = None;
    for _ in 0..iterations {
        let new = match flux {
            None => graph.add(step(PipesPhase::FirstFlux), &[state]),
            Some(flux) => graph.add(step(PipesPhase::Flux), &[state, flux]),
        };
        state = graph.add(step(PipesPhase::Ground), &ground.with_hardness(&[state, new]));
        flux = Some(new);
    }
    (state, graph.add(step(PipesPhase::Settle), &[state]))
}
