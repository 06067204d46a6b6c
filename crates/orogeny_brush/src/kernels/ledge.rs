//! Ledge: a step about the height under each instance.

use orogeny_field::{Brush, Instance, LedgeDirection};
use orogeny_reference::brush::ledge;

use crate::kernels::RowStart;
use crate::plan::Pass;

/// The shader's stem.
pub const STEM: &str = "brush/ledge";

/// -1 where the high side goes down.
pub(crate) fn sign(brush: &Brush) -> f64 {
    match brush.direction {
        LedgeDirection::Raise => 1.0,
        LedgeDirection::Lower => -1.0,
    }
}

pub(crate) fn apply_row(
    pass: &Pass,
    instance: &Instance,
    _start: RowStart,
    heights: &mut [f32],
    amounts: &[f32],
) -> u32 {
    ledge::row(heights, amounts, instance, pass.ledge_direction)
}
