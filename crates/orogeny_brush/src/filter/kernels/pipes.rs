//! Erosion by running water. Its uniform is [`PipesKernel`] itself.

use orogeny_field::PipesKernel;

use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/pipes";

pub(super) fn data(kernel: &PipesKernel, has_hardness: bool) -> OwnData {
    OwnData::uniform(kernel).with_constants(&[("HAS_HARDNESS", u32::from(has_hardness))])
}
