//! Heights of a range spread anew over it: `lerp(H, lo + (hi - lo) m((H - lo) / (hi - lo)), A)` for `lo <= H <= hi`.
//!
//! `bias_b(z) = z^(ln b / ln 1/2)`; `gain_g(z) = bias_{1-g}(2z) / 2` under a half, `1 - bias_{1-g}(2 - 2z) / 2` above (Perlin &
//! Hoffert, "Hypertexture", 1989).

use multiversion::multiversion;
use orogeny_field::{HeightRange, RangeFormula};

use crate::curve::look_up;
use crate::store::{lerp, update_row};
use crate::transcendental::{exp_minus_one, natural_log};

/// Spreads the heights of a range anew by the amounts, 0..1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
pub fn row(heights: &mut [f32], amounts: &[f32], range: &HeightRange) -> u32 {
    match (range.formula, &range.table) {
        (RangeFormula::Bias, _) => row_of(heights, amounts, range, |z| bias(z, range.exponent)),
        (RangeFormula::Gain, _) => row_of(heights, amounts, range, |z| gain(z, range.exponent)),
        (RangeFormula::Curve, Some(table)) => row_of(heights, amounts, range, |z| look_up(table, z).0),
        (RangeFormula::Curve, None) => 0,
    }
}

#[inline(always)]
fn row_of(heights: &mut [f32], amounts: &[f32], range: &HeightRange, map: impl Fn(f32) -> f32) -> u32 {
    let width_m = range.high_m - range.low_m;
    update_row(heights, amounts, |_, height, amount| {
        let z = ((height - range.low_m) * range.inverse_width).clamp(0.0, 1.0);
        let goal = range.low_m + width_m * map(z);
        let is_within = height >= range.low_m && height <= range.high_m;
        if is_within { lerp(height, goal, amount) } else { height }
    })
}

/// `z^exponent`, 0 at 0.
#[inline(always)]
fn bias(z: f32, exponent: f32) -> f32 {
    let power = exp_minus_one(exponent * natural_log(z.max(f32::MIN_POSITIVE))) + 1.0;
    if z > 0.0 { power.clamp(0.0, 1.0) } else { 0.0 }
}

#[inline(always)]
fn gain(z: f32, exponent: f32) -> f32 {
    let is_lower = z < 0.5;
    let half = 0.5 * bias(if is_lower { 2.0 * z } else { 2.0 - 2.0 * z }, exponent);
    if is_lower { half } else { 1.0 - half }
}
