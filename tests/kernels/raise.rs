//! Raise and lower.

use orogeny_field::{Brush, BrushType};

use crate::agreement::back_ends_agree;
use crate::numpy::assert_stroke_matches;

fn brushes() -> Vec<(&'static str, Brush)> {
    [BrushType::Raise, BrushType::Lower].map(|kind| (kind.name(), Brush::new(kind, 1.0, 1.0))).to_vec()
}

back_ends_agree!(brushes);

#[test]
fn matches_numpy() {
    assert_stroke_matches("raise");
    assert_stroke_matches("lower");
}
