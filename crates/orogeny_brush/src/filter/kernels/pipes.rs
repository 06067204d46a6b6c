//! Erosion by running water. Its uniform is [`PipesKernel`] itself.

use orogeny_field::PipesKernel;

use crate::filter::PipesPhase;
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/pipes";

pub(super) fn data(kernel: &PipesKernel, phase: PipesPhase, has_hardness: bool) -> OwnData {
    let constants = [("PHASE", phase as u32), ("HAS_HARDNESS", u32::from(has_hardness))];
    OwnData::uniform(kernel).with_constants(&constants)
}
