//! Raise, and lower with the opposite sign.

use orogeny_field::{Brush, BrushType, Instance};
use orogeny_reference::brush::raise;

use crate::kernels::RowStart;
use crate::plan::Pass;

/// The shader's stem.
pub const STEM: &str = "brush/raise";

/// -1 for `lower`.
pub(crate) fn sign(brush: &Brush) -> f64 {
    if brush.brush_type == BrushType::Lower { -1.0 } else { 1.0 }
}

pub(crate) fn apply_row(
    _pass: &Pass,
    _instance: &Instance,
    _start: RowStart,
    heights: &mut [f32],
    amounts: &[f32],
) -> u32 {
    raise::row(heights, amounts)
}
