//! Roughen: white noise by the sample's place and the stroke's seed.

use orogeny_field::Instance;
use orogeny_reference::brush::roughen;

use crate::kernels::RowStart;
use crate::plan::Pass;

/// The shader's stem.
pub const STEM: &str = "brush/roughen";

pub(crate) fn apply_row(
    pass: &Pass,
    _instance: &Instance,
    start: RowStart,
    heights: &mut [f32],
    amounts: &[f32],
) -> u32 {
    roughen::row(heights, amounts, start.x, start.z, pass.seed)
}
