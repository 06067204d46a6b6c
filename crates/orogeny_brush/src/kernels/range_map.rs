//! Range map: the heights of a range spread anew over it.

use orogeny_field::HeightRange;

use super::OwnData;

/// The shader's stem.
pub const STEM: &str = "brush/range_map";

/// The layout is that of `Range` in `shaders/brush/range_map.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct RangeUniform {
    /// Lower end, metres.
    pub low_m: f32,
    /// Upper end, metres.
    pub high_m: f32,
    /// 1 over its width.
    pub inverse_width: f32,
    /// Of a bias.
    pub exponent: f32,
}

pub(crate) fn data(range: &HeightRange) -> OwnData {
    let HeightRange { low_m, high_m, inverse_width, formula, exponent, .. } = *range;
    OwnData::uniform(&RangeUniform { low_m, high_m, inverse_width, exponent })
        .with_constants(&[("RANGE_FORMULA", formula as u32)])
}
