//! Raise and lower.

use orogeny_field::{Brush, BrushType};

use crate::agreement::{Ground, assert_back_ends_agree};
use crate::numpy::assert_stroke_matches;

fn brushes() -> Vec<(&'static str, Brush)> {
    [BrushType::Raise, BrushType::Lower].map(|kind| (kind.name(), Brush::new(kind, 1.0, 1.0))).to_vec()
}

#[test]
fn back_ends_agree_on_random_ground() {
    assert_back_ends_agree(Ground::Random, &brushes());
}

#[test]
fn back_ends_agree_on_extreme_ground() {
    assert_back_ends_agree(Ground::Extreme, &brushes());
}

#[test]
fn back_ends_agree_on_real_ground() {
    assert_back_ends_agree(Ground::Real, &brushes());
}

#[test]
fn matches_numpy() {
    assert_stroke_matches("raise");
    assert_stroke_matches("lower");
}
