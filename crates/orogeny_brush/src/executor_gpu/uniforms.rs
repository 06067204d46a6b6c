//! What a pass is to the kernels: the mirrors of `shaders/driver/local.wgsl`.

use orogeny_field::{LedgeDirection, LevelOnly};

use crate::plan::Pass;

/// Size of `Counters`.
pub(super) const COUNTERS_SIZE_IN_BYTES: u64 = 4;

/// What is the same for all instances of a pass. The layout is that of `Brush` in `shaders/driver/local.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct BrushUniform {
    /// See [`orogeny_field::Falloff`].
    pub inverse_falloff_ratio: f32,
    /// See [`orogeny_field::Falloff`].
    pub falloff_exponent: f32,
    /// See [`orogeny_field::Falloff`].
    pub falloff_scale: f32,
    /// Goal of `level`, metres.
    pub target_height_m: f32,
    /// 1 where a ledge raises, -1 where it lowers.
    pub ledge_direction: f32,
    /// 0 both ways, 1 cut, 2 fill.
    pub level_only: u32,
    /// Feeds `roughen`.
    pub seed: u32,
}

impl From<&Pass> for BrushUniform {
    fn from(pass: &Pass) -> Self {
        Self {
            inverse_falloff_ratio: pass.falloff.inverse_falloff_ratio,
            falloff_exponent: pass.falloff.exponent,
            falloff_scale: pass.falloff.scale,
            target_height_m: pass.target_height_m,
            ledge_direction: match pass.ledge_direction {
                LedgeDirection::Raise => 1.0,
                LedgeDirection::Lower => -1.0,
            },
            level_only: match pass.level_only {
                LevelOnly::Both => 0,
                LevelOnly::Cut => 1,
                LevelOnly::Fill => 2,
            },
            seed: pass.seed,
        }
    }
}

/// The constants that a pass's kernel is built with.
pub(super) fn constants(pass: &Pass) -> [(&'static str, u32); 2] {
    [("FALLOFF_FORMULA", pass.falloff.formula as u32), ("WEIGHT_MODE", pass.weight_mode as u32)]
}
