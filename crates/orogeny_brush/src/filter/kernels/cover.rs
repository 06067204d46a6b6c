//! Where there is another ground.

use orogeny_field::{Placement, SampleRect};

use super::places;
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/cover";

/// The layout is that of `Cover` in `shaders/field/cover.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CoverUniform {
    /// Its samples along x and z.
    pub extent: [u32; 2],
}

pub(super) fn data(
    placement: &Placement,
    extent: [u32; 2],
    has_selection: bool,
    rect: &SampleRect,
) -> OwnData {
    let mut data = OwnData::uniform(&CoverUniform { extent })
        .with_constants(&[("HAS_SELECTION", u32::from(has_selection))]);
    data.storage = places(placement, rect);
    data
}
