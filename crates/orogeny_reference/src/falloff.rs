//! The weight of a brush over the distance from its centre (section 2 of the kernel specification).

use orogeny_field::{Falloff, FalloffFormula};

use crate::curve::look_up;
use crate::transcendental::{exp_minus_one, natural_log};

/// One falloff formula. A type, so that a row's loop is compiled for each and vectorises.
pub trait Formula {
    /// The weight 0..1 at `r` = distance / outer radius, `0 <= r < 1`.
    fn weight(r: f32, falloff: &Falloff) -> f32;

    /// The weight at any `r >= 0`: exactly 0 from 1 on.
    #[inline(always)]
    fn bounded_weight(r: f32, falloff: &Falloff) -> f32 {
        let weight = Self::weight(r, falloff);
        if r < 1.0 { weight } else { 0.0 }
    }
}

/// `t = clamp((R - distance) / F, 0, 1)`.
#[inline(always)]
fn slope(r: f32, falloff: &Falloff) -> f32 {
    ((1.0 - r) * falloff.inverse_falloff_ratio).clamp(0.0, 1.0)
}

macro_rules! formulas {
    ($($(#[$meta:meta])* $name:ident = |$r:ident, $falloff:ident| $weight:expr;)*) => {$(
        $(#[$meta])*
        #[derive(Debug, Clone, Copy)]
        pub struct $name;

        impl Formula for $name {
            #[inline(always)]
            fn weight($r: f32, $falloff: &Falloff) -> f32 {
                $weight
            }
        }
    )*};
}

formulas! {
    /// 1 inside.
    HardEdge = |_r, _falloff| 1.0;
    /// `t`.
    Linear = |r, falloff| slope(r, falloff);
    /// `t^2 (3 - 2t)`.
    Smooth = |r, falloff| {
        let t = slope(r, falloff);
        t * t * (3.0 - 2.0 * t)
    };
    /// `sqrt(1 - (1 - t)^2)`, written `sqrt(t (2 - t))`, which loses no digits near the edge.
    Sphere = |r, falloff| {
        let t = slope(r, falloff);
        (t * (2.0 - t)).sqrt()
    };
    /// `1 - sqrt(1 - t^2)`, written `t^2 / (1 + sqrt(1 - t^2))`, which loses no digits near the edge.
    Tip = |r, falloff| {
        let t = slope(r, falloff);
        let t2 = t * t;
        t2 / (1.0 + (1.0 - t2).sqrt())
    };
    /// `(exp(-4.5 (1 - t)^2) - e^-4.5) / (1 - e^-4.5)`, with both exponentials less 1.
    Gauss = |r, falloff| {
        const EDGE: f32 = -0.988_891; // e^-4.5 - 1
        const SCALE: f32 = 1.011_233_8; // 1 / (1 - e^-4.5)
        let s = 1.0 - slope(r, falloff);
        ((exp_minus_one(-4.5 * s * s) - EDGE) * SCALE).clamp(0.0, 1.0)
    };
    /// `clamp((1 - r^P) / (1 - r0^P), 0, 1)`.
    Power = |r, falloff| {
        let drop = -exp_minus_one(falloff.exponent * natural_log(r));
        let rise = if r > 0.0 { drop } else { 1.0 };
        (rise * falloff.scale).clamp(0.0, 1.0)
    };
    /// `tanh(k (1 - r)) / tanh(k)`, with `tanh y = -m / (2 + m)`, `m = exp(-2y) - 1`.
    Sigmoid = |r, falloff| {
        let m = exp_minus_one(-2.0 * falloff.exponent * (1.0 - r));
        (-m / (2.0 + m) * falloff.scale).clamp(0.0, 1.0)
    };
    /// A user's curve of `t`.
    Curve = |r, falloff| falloff.table.as_ref().map_or(0.0, |table| look_up(table, slope(r, falloff)).0);
}

/// The weight 0..1 at `r` = distance / outer radius, `r >= 0`.
#[must_use]
pub fn weight(r: f32, falloff: &Falloff) -> f32 {
    match falloff.formula {
        FalloffFormula::HardEdge => HardEdge::bounded_weight(r, falloff),
        FalloffFormula::Linear => Linear::bounded_weight(r, falloff),
        FalloffFormula::Smooth => Smooth::bounded_weight(r, falloff),
        FalloffFormula::Sphere => Sphere::bounded_weight(r, falloff),
        FalloffFormula::Tip => Tip::bounded_weight(r, falloff),
        FalloffFormula::Gauss => Gauss::bounded_weight(r, falloff),
        FalloffFormula::Power => Power::bounded_weight(r, falloff),
        FalloffFormula::Sigmoid => Sigmoid::bounded_weight(r, falloff),
        FalloffFormula::Curve => Curve::bounded_weight(r, falloff),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::{Profile, ProfileShape};

    fn shapes() -> Vec<ProfileShape> {
        let mut shapes = vec![
            ProfileShape::Linear,
            ProfileShape::Smooth,
            ProfileShape::Sphere,
            ProfileShape::Tip,
            ProfileShape::Gauss,
        ];
        shapes.extend([0.1, 0.5, 1.0, 2.0, 7.3, 16.0].map(|power| ProfileShape::Power { power }));
        shapes.extend([0.01, 1.0, 3.0, 20.0].map(|steepness| ProfileShape::Sigmoid { steepness }));
        shapes
    }

    #[test]
    fn every_profile_is_one_at_the_centre_zero_at_the_edge_and_never_rises() {
        for shape in shapes() {
            for falloff_ratio in [0.0, 1.0e-4, 0.01, 0.5, 1.0] {
                let falloff = Falloff::from(Profile { shape: shape.clone(), falloff_ratio });
                assert!((weight(0.0, &falloff) - 1.0).abs() < 3.0e-7, "{shape:?} {falloff_ratio}");
                for outside in [1.0, 1.000_000_1, 3.0, 1.0e30] {
                    assert_eq!(weight(outside, &falloff), 0.0, "{shape:?} {falloff_ratio}");
                }
                let mut last = 1.0;
                for k in 0..=10_000 {
                    let w = weight(k as f32 / 10_000.0, &falloff);
                    assert!((0.0..=1.0).contains(&w), "{shape:?} {falloff_ratio} {w}");
                    assert!(w <= last + 3.0e-7, "{shape:?} {falloff_ratio} at {k}: {w} after {last}");
                    last = w;
                }
            }
        }
    }

    #[test]
    fn a_falloff_under_a_ten_thousandth_is_a_disc() {
        for shape in shapes() {
            let falloff = Falloff::from(Profile { shape, falloff_ratio: 0.99e-4 });
            assert_eq!(weight(0.999_999_9, &falloff), 1.0);
        }
    }
}
