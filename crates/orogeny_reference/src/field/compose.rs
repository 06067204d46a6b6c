//! A layer joined to what lies below it, and a mask's terms to those before them; see `orogeny_field::Blend`.

use multiversion::multiversion;
use orogeny_field::{Blend, CurveTable, MaskCombine, sanitized_height};

use crate::store::{lerp, pulled};

/// Joins a row of a layer's heights to what lies below it, as far as the weights say, 0..1. [`Blend::Laplacian`] is no matter of
/// single samples: what its pyramids came to is joined as [`Blend::Replace`].
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(below: &mut [f32], heights: &[f32], weights: &[f32], blend: Blend) {
    match blend {
        Blend::Add => add(below, heights, weights, 1.0),
        Blend::Subtract => add(below, heights, weights, -1.0),
        Blend::Max => pull(below, heights, weights, f32::max),
        Blend::Min => pull(below, heights, weights, f32::min),
        Blend::Multiply => pull(below, heights, weights, |below, height| below * height),
        _ => pull(below, heights, weights, |_, height| height),
    }
}

#[inline(always)]
fn add(below: &mut [f32], heights: &[f32], weights: &[f32], sign: f32) {
    for ((below, height), weight) in below.iter_mut().zip(heights).zip(weights) {
        *below = sanitized_height(*below + sign * weight * height);
    }
}

#[inline(always)]
fn pull(below: &mut [f32], heights: &[f32], weights: &[f32], goal: impl Fn(f32, f32) -> f32) {
    for ((below, height), weight) in below.iter_mut().zip(heights).zip(weights) {
        *below = sanitized_height(pulled(*below, sanitized_height(goal(*below, *height)), *weight));
    }
}

/// Makes a term of a mask of heights: 0 at `low` and below, 1 at `high` and above, or the other way where `high` is the lower.
pub fn range_row(values: &mut [f32], low: f64, high: f64) {
    let inverse_width = 1.0 / (high - low);
    for value in values {
        *value = ((f64::from(*value) - low) * inverse_width).clamp(0.0, 1.0) as f32;
    }
}

/// Does to a term what is asked for: inverts it, then bends it by a curve.
pub fn shape_row(values: &mut [f32], is_inverted: bool, curve: Option<&CurveTable>) {
    for value in values {
        let mut shaped = value.clamp(0.0, 1.0);
        if is_inverted {
            shaped = 1.0 - shaped;
        }
        if let Some(curve) = curve {
            shaped = bent(shaped, curve).clamp(0.0, 1.0);
        }
        *value = shaped;
    }
}

/// The value of a curve, linear between two entries of its table.
fn bent(value: f32, curve: &CurveTable) -> f32 {
    let place = ((value - curve.low) * curve.entries_per_unit).clamp(0.0, (curve.values.len() - 1) as f32);
    let first = place as usize;
    let entry = |index: usize| curve.values.get(index).or(curve.values.last()).copied().unwrap_or_default();
    lerp(entry(first), entry(first + 1), place - first as f32)
}

/// Joins a term to the mask before it.
pub fn combine_row(mask: &mut [f32], term: &[f32], combine: MaskCombine) {
    for (mask, term) in mask.iter_mut().zip(term) {
        *mask = match combine {
            MaskCombine::Multiply => *mask * term,
            MaskCombine::Add => (*mask + term).min(1.0),
            MaskCombine::Subtract => (*mask - term).max(0.0),
            MaskCombine::Max => mask.max(*term),
            MaskCombine::Min => mask.min(*term),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Below, layer, weight, and what they come to.
    #[test]
    fn blends_are_as_the_table_has_them() {
        let cases = [
            (Blend::Add, 10.0, 4.0, 0.5, 12.0),
            (Blend::Subtract, 10.0, 4.0, 0.5, 8.0),
            (Blend::Max, 10.0, 4.0, 1.0, 10.0),
            (Blend::Max, 10.0, 14.0, 0.25, 11.0),
            (Blend::Min, 10.0, 4.0, 0.5, 7.0),
            (Blend::Multiply, 10.0, 0.5, 1.0, 5.0),
            (Blend::Multiply, 10.0, 0.5, 0.5, 7.5),
            (Blend::Replace, 10.0, 4.0, 0.5, 7.0),
            (Blend::Replace, 1.0e7, 0.1, 1.0, 0.1),
            (Blend::Multiply, 1.0e7, 1.0e7, 1.0, 1.0e7),
            (Blend::Add, 9.0e6, 9.0e6, 1.0, 1.0e7),
        ];
        for (blend, below, height, weight, expected) in cases {
            let mut row_below = [f32::NAN, below, below];
            row(&mut row_below[1..], &[height, height], &[weight, 0.0], blend);
            assert_eq!(row_below[1..], [expected, below], "{blend:?}");
            assert!(row_below[0].is_nan());
        }
    }

    #[test]
    fn terms_are_shaped_and_joined() {
        let mut heights = [-5.0, 0.0, 25.0, 100.0, 120.0];
        range_row(&mut heights, 0.0, 100.0);
        assert_eq!(heights, [0.0, 0.0, 0.25, 1.0, 1.0]);
        shape_row(&mut heights, true, None);
        assert_eq!(heights, [1.0, 1.0, 0.75, 0.0, 0.0]);
        let curve = orogeny_field::Curve::new("c", vec![[0.0, 1.0], [1.0, 0.0]]).unwrap().table(0.0, 1.0);
        shape_row(&mut heights, false, Some(&curve));
        assert!(
            heights.iter().zip([0.0, 0.0, 0.25, 1.0, 1.0]).all(|(a, b): (&f32, f32)| (a - b).abs() < 1e-6)
        );
        let joined = |combine| {
            let mut mask = [0.5, 0.9];
            combine_row(&mut mask, &[0.25, 1.0], combine);
            mask
        };
        assert_eq!(joined(MaskCombine::Multiply), [0.125, 0.9]);
        assert_eq!(joined(MaskCombine::Add), [0.75, 1.0]);
        assert_eq!(joined(MaskCombine::Subtract), [0.25, 0.0]);
        assert_eq!(joined(MaskCombine::Max), [0.5, 1.0]);
        assert_eq!(joined(MaskCombine::Min), [0.25, 0.9]);
    }
}
