//! Ground moved along with brushes.

use std::sync::Arc;

use orogeny_field::{GrabKernel, TerrainGrid};

use super::{Filter, Graph, Step};

/// What moves the ground before the stroke by a kernel.
pub(crate) fn filter(grid: &TerrainGrid, kernel: GrabKernel) -> Filter {
    let mut graph = Graph::new([grid.width(), grid.depth()]);
    graph.add(Step::Grab(Arc::new(kernel)), &[Graph::HEIGHTS]);
    Filter { graph: Arc::new(graph), is_sequential: false }
}
