//! Thermal erosion.

use orogeny_field::{ThermalKernel, ThermalLayer};

use crate::filter::ThermalPhase;
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/thermal";

/// The layout is that of `Thermal` in `shaders/field/thermal.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ThermalUniform {
    /// Layers of rock.
    pub num_layers: u32,
}

pub(super) fn data(kernel: &ThermalKernel, phase: ThermalPhase, has_hardness: bool) -> OwnData {
    let layers: Vec<ThermalLayer> = kernel.layers().copied().collect();
    let uniform = ThermalUniform { num_layers: kernel.num_layers };
    let constants = [("PHASE", phase as u32), ("HAS_HARDNESS", u32::from(has_hardness))];
    let mut data = OwnData::uniform(&uniform).with_constants(&constants);
    data.storage = vec![bytemuck::cast_slice(&layers).to_vec()];
    data
}
