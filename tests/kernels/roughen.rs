//! Roughen.

use orogeny_field::{Brush, BrushType};

use crate::agreement::back_ends_agree;
use crate::numpy::assert_stroke_matches;

fn brushes() -> Vec<(&'static str, Brush)> {
    vec![("roughen", Brush::new(BrushType::Roughen, 1.0, 1.0))]
}

back_ends_agree!(brushes);

#[test]
fn matches_numpy() {
    assert_stroke_matches("roughen");
}
