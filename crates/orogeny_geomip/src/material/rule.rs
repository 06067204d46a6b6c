//! What a set comes to for one terrain: numbers alone, as a GPU takes them.

use bytemuck::{Pod, Zeroable};

/// In [`LayerRule::ids`]: the layer has no mask.
pub const NO_MASK: u32 = u32::MAX;

/// A layer's numbers, in groups of 16 bytes without gaps, as a shader's `array<vec4>` has them.
///
/// A *ramp* is four numbers `[rise, per rise, fall, per fall]`: the layer's share at `x` is
/// `smooth((x - rise) * per_rise) * (1 - smooth((x - fall) * per_fall))`, where `smooth(t)` keeps `t` to 0..1 and is `t² (3 - 2 t)`. An open side
/// rises or falls 1e30 away.
#[derive(Debug, Clone, Copy, PartialEq, Zeroable, Pod)]
#[repr(C)]
pub struct LayerRule {
    /// The ramp of heights, metres.
    pub height_m: [f32; 4],
    /// The ramp of slopes, as tangents: rise over run.
    pub slope_tangent: [f32; 4],
    /// The ramp of curvatures, 1/m.
    pub curvature: [f32; 4],
    /// Features a metre; how far borders move; the value above which patches lie and how steeply they begin (1 over the width):
    /// `smooth((noise - [2]) * [3])`.
    pub noise: [f32; 4],
    /// The greatest weight; repeats of the texture a metre; 0; 0.
    pub look: [f32; 4],
    /// The noise's seed; the mask's place in [`ResolvedSet::masks`](super::ResolvedSet), or [`NO_MASK`]; 0; 0.
    pub ids: [u32; 4],
}

/// A set's own numbers, in one group of 16 bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct SetRule {
    /// How far reliefs reach into each other.
    pub blend_depth: f32,
    /// How much borders follow relief, 0..1.
    pub blend_contrast: f32,
    /// Features of the variation over long ways, a metre.
    pub macro_per_m: f32,
    /// How far brightness goes up and down, 0..1.
    pub macro_amount: f32,
}
