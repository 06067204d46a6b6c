//! Ledges, raised and lowered.

use orogeny_field::{Brush, BrushType, LedgeDirection};

use crate::agreement::back_ends_agree;
use crate::numpy::assert_stroke_matches;

fn brushes() -> Vec<(&'static str, Brush)> {
    let raise = Brush::new(BrushType::Ledge, 1.0, 1.0);
    let lower = Brush { direction: LedgeDirection::Lower, ..raise.clone() };
    vec![
        ("ledge, raise", raise.clone()),
        ("ledge, raise, given height", Brush { height_m: Some(500.0), ..raise }),
        ("ledge, lower", lower.clone()),
        ("ledge, lower, given height", Brush { height_m: Some(-20.5), ..lower }),
    ]
}

back_ends_agree!(brushes);

#[test]
fn matches_numpy() {
    assert_stroke_matches("ledge_raise");
    assert_stroke_matches("ledge_lower");
}
