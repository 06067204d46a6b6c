//! Where water goes: how pits are filled, how flow is shared out, and how its areas become a mask.

/// How closed depressions are raised so that water leaves them.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct FillPits {
    /// Metres by which each raised sample lies above the one that it drains to, at least; 0 or more. With 0, the default,
    /// a filled pit is level.
    pub slope_m: f32,
    /// Pits deeper than this, in metres, are left as they are; `None`, the default, fills them all. A pit is what one
    /// lake would cover, and its depth that of the lake.
    pub max_depth_m: Option<f32>,
}

/// How the water of a sample is shared among its lower neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FlowRouting {
    /// All to the steepest (O'Callaghan & Mark 1984): rivers one sample wide.
    #[default]
    Steepest,
    /// To all, in proportion to a power of the slope (Freeman 1991): water spreads on slopes and gathers in valleys.
    Shared {
        /// The power, 0 to 100: [`FlowRouting::EXPONENT`] or near it. With 0 all lower neighbours get the same; the larger, the
        /// more goes to the steepest.
        exponent: f32,
    },
}

impl FlowRouting {
    /// What Freeman (1991) found to spread water evenly on a cone.
    pub const EXPONENT: f32 = 1.1;

    /// [`Self::Shared`] with [`Self::EXPONENT`].
    #[must_use]
    pub const fn shared() -> Self {
        Self::Shared { exponent: Self::EXPONENT }
    }
}

/// Which drained areas a mask of flow tells apart, on a logarithmic scale.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct FlowMask {
    /// Up to this area, in m², the mask is 0; above 0.
    pub from_m2: f32,
    /// From this area on, in m², the mask is 1; above [`Self::from_m2`].
    pub to_m2: f32,
}

impl Default for FlowMask {
    /// From a hectare, where a rill may begin, to ten square kilometres, which feed a river.
    fn default() -> Self {
        Self { from_m2: 1.0e4, to_m2: 1.0e7 }
    }
}

/// What a mask of rain shows of a shower ([`crate::Pipes`]) over the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RainShows {
    /// How deep water stands when it ends.
    #[default]
    Water,
    /// How much rock the water carries then.
    Sediment,
    /// How much ground it laid down.
    Deposits,
    /// How much ground it took away.
    Wear,
}

/// What a mask of rain tells apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RainMask {
    /// Of what.
    pub shows: RainShows,
    /// Up to so many metres the mask is 0.
    pub from_m: f64,
    /// From so many metres on it is 1; above [`Self::from_m`].
    pub to_m: f64,
}

impl Default for RainMask {
    fn default() -> Self {
        Self { shows: RainShows::default(), from_m: 0.0, to_m: 1.0 }
    }
}
