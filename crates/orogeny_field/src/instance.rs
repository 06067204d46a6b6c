//! A brush instance as kernels take it.

/// One dab of a brush. The layout is that of `Instance` in `shaders/driver/local.wgsl`.
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
    /// The height that a ledge refers to, in metres.
    pub reference_height_m: f32,
    /// 1 over the outer radius in metres.
    pub inverse_radius_m: f32,
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
    /// `A` is the largest `a w` of the stroke, kept beside the page, and applied to the heights before the stroke.
    Wash = 2,
}
