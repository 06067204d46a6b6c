//! A step: raising fades to nothing one radius above the reference height, lowering one radius below it.
//!
//! Raise: `H + A (1 - clamp((H - H_C) / R, 0, 1))`; lower: `H - A (1 - clamp((H_C - H) / R, 0, 1))`. The planner makes the
//! amounts negative where the ledge lowers, so that their sign says which of the two it is.

use multiversion::multiversion;
use orogeny_field::{Instance, LedgeDirection};

use crate::store::update_row;

/// Raises or lowers the heights by the amounts, in metres, as far as they lie on the side that is moved.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(heights: &mut [f32], amounts: &[f32], instance: &Instance, direction: LedgeDirection) -> u32 {
    let toward_moved_side = match direction {
        LedgeDirection::Raise => 1.0,
        LedgeDirection::Lower => -1.0,
    };
    update_row(heights, amounts, |_, height, amount| {
        let beyond = toward_moved_side * (height - instance.reference_height_m);
        height + amount * (1.0 - (beyond * instance.inverse_radius_m).clamp(0.0, 1.0))
    })
}
