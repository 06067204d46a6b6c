//! A brush instance as kernels take it, and what all instances of a pass share.

use std::sync::Arc;

use crate::{Bitmap, Falloff};

/// One dab of a brush. The layout is that of `Instance` in `shaders/driver/footprint.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Instance {
    /// The sample at or before the centre, along x and z.
    pub cell: [i32; 2],
    /// From that sample to the centre, 0..1 of a sample. Together they keep their precision anywhere on a terrain.
    pub fraction: [f32; 2],
    /// 1 over the outer radius in samples; 0 covers everything (a fill).
    pub inverse_radius: f32,
    /// What the weight is multiplied by, see [`WeightMode`].
    pub amplitude: f32,
    /// The height that a ledge or a stamp refers to, and that a ramp begins at, in metres.
    pub reference_height_m: f32,
    /// 1 over the outer radius in metres.
    pub inverse_radius_m: f32,
    /// The alpha bitmap's own x axis: cosine and sine of the angle from the terrain's x towards z.
    pub axis: [f32; 2],
    /// -1 where the bitmap's left and right change places, otherwise 1.
    pub mirror: f32,
    /// How much nearer a wash comes to this instance's amount, 0..1.
    pub flow: f32,
    /// Of a ramp: the way from the centre to its end, in samples.
    pub segment: [f32; 2],
    /// Of a ramp: 1 over the square of that way's length; 0 for one that has none.
    pub inverse_segment_squared: f32,
    /// Of a ramp: the height at its end, in metres.
    pub end_height_m: f32,
    /// Of a noise: which of the batch's frames.
    pub frame: u32,
    /// Of a noise that follows the stroke: how much of the next frame, 0..1.
    pub frame_blend: f32,
}

impl Instance {
    /// Everywhere, with an amount of 1: what a fill is made of.
    pub const EVERYWHERE: Self = Self {
        cell: [0, 0],
        fraction: [0.0, 0.0],
        inverse_radius: 0.0,
        amplitude: 1.0,
        reference_height_m: 0.0,
        inverse_radius_m: 0.0,
        axis: [1.0, 0.0],
        mirror: 1.0,
        flow: 1.0,
        segment: [0.0, 0.0],
        inverse_segment_squared: 0.0,
        end_height_m: 0.0,
        frame: 0,
        frame_blend: 0.0,
    };
}

/// What a kernel makes of the profile's weight `w` and the instance's amplitude `a`; the number is the kernels'
/// `WEIGHT_MODE` constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum WeightMode {
    /// `A = a w`: additive brushes, fills, and strokes of one instance.
    Direct = 0,
    /// `A = 1 - exp(a w)`, `a <= 0`: each instance blends again.
    BuildUp = 1,
    /// `A` is the largest `a w` of the stroke, kept beside the page, and applied to the heights before the stroke. With a flow
    /// under 1 it comes nearer to `a w` with every instance: `A <- A + flow max(a w - A, 0)`.
    Wash = 2,
}

/// How the instances of a pass cover samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Footprint {
    /// The profile.
    pub falloff: Falloff,
    /// How weights become amounts.
    pub weight_mode: WeightMode,
    /// What the weight is multiplied by, over the square about the circle.
    pub alpha: Option<Arc<Bitmap>>,
    /// Whether distances are those from the instance's segment, rather than from its centre.
    pub is_segment: bool,
}

impl Footprint {
    /// Full weight everywhere, for fills.
    pub const EVERYWHERE: Self =
        Self { falloff: Falloff::HARD_EDGE, weight_mode: WeightMode::Direct, alpha: None, is_segment: false };
}
