//! Layers: what they are made of, how they join what is below, where they count.
//!
//! The composite is worked out from the bottom, from 0 m. With what is below `C`, the layer's heights `h` and its weight `w`, its
//! opacity times its mask, all of them at one sample:
//!
//! | blend | becomes |
//! | --- | --- |
//! | add | `C + w h` |
//! | subtract | `C - w h` |
//! | max, min | `lerp(C, max(C, h), w)`, `lerp(C, min(C, h), w)` |
//! | multiply | `lerp(C, C h, w)` |
//! | replace | `lerp(C, h, w)` |
//! | laplacian | `C` and `h` blended band by band by their Laplacian pyramids, as `w` says |
//!
//! At level `k` all of them are those of level `k`.

mod content;
mod mask;
mod transform;

pub use content::{LayerContent, Procedure};
pub use mask::{MAX_MASK_TERMS, MaskCombine, MaskSource, MaskTerm};
pub use transform::LayerTransform;

/// Levels of the pyramids by which [`Blend::Laplacian`] blends: what is `4 * 2^levels` samples away still counts.
pub const LAYER_PYRAMID_LEVELS: u32 = 5;

/// How a layer's heights join those below it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Blend {
    /// The sum of both.
    #[default]
    Add,
    /// What is below, less the layer.
    Subtract,
    /// The higher of the two.
    Max,
    /// The lower of the two.
    Min,
    /// The product of both.
    Multiply,
    /// The layer alone.
    Replace,
    /// Both, band by band of their Laplacian pyramids.
    Laplacian,
}

impl Blend {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Self; 7] =
        [Self::Add, Self::Subtract, Self::Max, Self::Min, Self::Multiply, Self::Replace, Self::Laplacian];

    /// As recipes have it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Add => "add",
            Self::Subtract => "subtract",
            Self::Max => "max",
            Self::Min => "min",
            Self::Multiply => "multiply",
            Self::Replace => "replace",
            Self::Laplacian => "laplacian",
        }
    }
}
