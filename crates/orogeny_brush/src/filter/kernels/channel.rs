//! One quantity of several, as a mask.

use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/channel";

/// The layout is that of `Channel` in `shaders/field/channel.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ChannelUniform {
    /// Which one.
    pub number: u32,
    /// Up to this it is 0.
    pub from_value: f32,
    /// 1 over how much more it takes to be 1.
    pub inverse_width: f32,
}

pub(super) fn data(number: u32, from_value: f32, inverse_width: f32) -> OwnData {
    OwnData::uniform(&ChannelUniform { number, from_value, inverse_width })
}
