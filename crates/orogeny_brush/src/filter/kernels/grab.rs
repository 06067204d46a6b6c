//! Ground moved along with brushes.

use orogeny_field::GrabKernel;

use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/grab";

/// The layout is that of `Grab` in `shaders/field/grab.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct GrabUniform {
    /// Brushes.
    pub num_drags: u32,
    /// Steps of their way.
    pub num_steps: u32,
    /// 1 over it.
    pub inverse_num_steps: f32,
}

pub(super) fn data(kernel: &GrabKernel) -> OwnData {
    let mut data = OwnData::uniform(&GrabUniform {
        num_drags: kernel.drags.len() as u32,
        num_steps: kernel.num_steps,
        inverse_num_steps: kernel.inverse_num_steps,
    });
    data.storage =
        vec![bytemuck::cast_slice(&kernel.drags).to_vec(), bytemuck::cast_slice(&kernel.weights).to_vec()];
    data
}
