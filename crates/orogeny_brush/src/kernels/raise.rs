//! Raise, and lower with the opposite sign.

use orogeny_field::{Brush, BrushType};

/// The shader's stem.
pub const STEM: &str = "brush/raise";

/// -1 for `lower`.
pub(crate) fn sign(brush: &Brush) -> f64 {
    if brush.brush_type == BrushType::Lower { -1.0 } else { 1.0 }
}
