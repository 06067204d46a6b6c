//! Level, and set height, which has its target given.

use orogeny_field::Instance;
use orogeny_reference::brush::level;

use crate::kernels::RowStart;
use crate::plan::Pass;

/// The shader's stem.
pub const STEM: &str = "brush/level";

pub(crate) fn apply_row(
    pass: &Pass,
    _instance: &Instance,
    _start: RowStart,
    heights: &mut [f32],
    amounts: &[f32],
) -> u32 {
    level::row(heights, amounts, pass.target_height_m, pass.level_only)
}
