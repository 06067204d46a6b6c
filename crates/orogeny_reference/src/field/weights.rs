//! How much a whole stroke takes of what is made: the largest weight of its instances.

use orogeny_field::{Footprint, Instance};

use crate::amounts;

/// Samples of a row that are worked at once: their amounts stay in the first-level cache.
const ROW_CHUNK: usize = 256;

/// Gathers an instance into a row of weights, 0 at first, from sample `(x, z)` on.
pub fn gather_row(weights: &mut [f32], x: i32, z: i32, instance: &Instance, footprint: &Footprint) {
    let mut amounts = [0.0; ROW_CHUNK];
    for (x, weights) in (x..).step_by(ROW_CHUNK).zip(weights.chunks_mut(ROW_CHUNK)) {
        let Some(amounts) = amounts.get_mut(..weights.len()) else { continue };
        amounts::row(amounts, x, z, instance, footprint);
        amounts::gather(weights, amounts, instance.flow);
    }
}
