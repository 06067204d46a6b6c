//! The profile of a brush: its weight over the distance from the centre.

use std::sync::Arc;

use crate::{Curve, CurveTable};

/// A shape with its own parameters (section 2 of the kernel specification).
#[derive(Debug, Clone, PartialEq)]
pub enum ProfileShape {
    /// `(1 - r^P) / (1 - r0^P)`, `P` in 0.1..16 (de Carpentier's equation 8-1, written so that it does not overflow).
    Power {
        /// The exponent `P`.
        power: f64,
    },
    /// `t`.
    Linear,
    /// `t^2 (3 - 2t)`.
    Smooth,
    /// `sqrt(1 - (1 - t)^2)`: a dome.
    Sphere,
    /// `1 - sqrt(1 - t^2)`: a spike.
    Tip,
    /// `(exp(-4.5 (1 - t)^2) - e^-4.5) / (1 - e^-4.5)`.
    Gauss,
    /// `tanh(k (1 - r)) / tanh(k)` over the whole radius, whatever the falloff (after Koca & Güdükbay).
    Sigmoid {
        /// The steepness `k`, above 0.
        steepness: f64,
    },
    /// A user's curve of `t`, 0 at the edge to 1 inside the slope.
    Curve(Curve),
}

/// A shape and how wide its slope is.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The shape.
    pub shape: ProfileShape,
    /// Falloff width over radius, 0..1: 0 is a hard edge, 1 slopes from the centre.
    pub falloff_ratio: f64,
}

impl Profile {
    /// Below this falloff ratio every shape is a disc with a hard edge.
    pub const HARD_EDGE_RATIO: f64 = 1.0e-4;

    /// Whether the weight is 1 inside the radius and 0 outside, with no slope.
    #[must_use]
    pub fn is_hard_edge(&self) -> bool {
        self.falloff_ratio < Self::HARD_EDGE_RATIO
    }
}

/// Which formula a kernel uses for the weight; the number is the kernels' `PROFILE` constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum FalloffFormula {
    /// 1 inside, 0 outside.
    HardEdge = 0,
    /// `t`; also `Power` with exponent 1, which is the same.
    Linear = 1,
    /// [`ProfileShape::Smooth`].
    Smooth = 2,
    /// [`ProfileShape::Sphere`].
    Sphere = 3,
    /// [`ProfileShape::Tip`].
    Tip = 4,
    /// [`ProfileShape::Gauss`].
    Gauss = 5,
    /// [`ProfileShape::Power`].
    Power = 6,
    /// [`ProfileShape::Sigmoid`].
    Sigmoid = 7,
    /// [`ProfileShape::Curve`].
    Curve = 8,
}

/// A profile as kernels take it: the formula, and what of it is the same at every sample, worked out in `f64`.
#[derive(Debug, Clone, PartialEq)]
pub struct Falloff {
    /// Which formula.
    pub formula: FalloffFormula,
    /// `R / F`: `t = min((1 - r) * inverse_falloff_ratio, 1)`.
    pub inverse_falloff_ratio: f32,
    /// The exponent `P` of a power, the steepness `k` of a sigmoid; otherwise 0.
    pub exponent: f32,
    /// `1 / (1 - r0^P)` of a power, `1 / tanh(k)` of a sigmoid; otherwise 1.
    pub scale: f32,
    /// Of [`FalloffFormula::Curve`].
    pub table: Option<Arc<CurveTable>>,
}

impl Falloff {
    /// Weight 1 everywhere inside, for fills.
    pub const HARD_EDGE: Self = Self {
        formula: FalloffFormula::HardEdge,
        inverse_falloff_ratio: 1.0,
        exponent: 0.0,
        scale: 1.0,
        table: None,
    };
}

impl From<Profile> for Falloff {
    fn from(profile: Profile) -> Self {
        if profile.is_hard_edge() {
            return Self::HARD_EDGE;
        }
        let plain = |formula| Self {
            formula,
            inverse_falloff_ratio: (1.0 / profile.falloff_ratio) as f32,
            exponent: 0.0,
            scale: 1.0,
            table: None,
        };
        match profile.shape {
            ProfileShape::Curve(curve) => {
                Self { table: Some(Arc::new(curve.table(0.0, 1.0))), ..plain(FalloffFormula::Curve) }
            }
            ProfileShape::Linear => plain(FalloffFormula::Linear),
            ProfileShape::Power { power } if power.to_bits() == 1.0_f64.to_bits() => {
                plain(FalloffFormula::Linear)
            }
            ProfileShape::Smooth => plain(FalloffFormula::Smooth),
            ProfileShape::Sphere => plain(FalloffFormula::Sphere),
            ProfileShape::Tip => plain(FalloffFormula::Tip),
            ProfileShape::Gauss => plain(FalloffFormula::Gauss),
            ProfileShape::Power { power } => {
                // 1 - r0^P without the loss of digits that a narrow falloff would bring.
                let one_minus_plateau = -(power * (-profile.falloff_ratio).ln_1p()).exp_m1();
                let scale = (1.0 / one_minus_plateau) as f32;
                Self { exponent: power as f32, scale, ..plain(FalloffFormula::Power) }
            }
            ProfileShape::Sigmoid { steepness } => {
                let scale = (1.0 / steepness.tanh()) as f32;
                Self { exponent: steepness as f32, scale, ..plain(FalloffFormula::Sigmoid) }
            }
        }
    }
}
