//! Thermal erosion.

use orogeny_field::{ThermalKernel, ThermalLayer};

use crate::filter::ThermalPhase;
use crate::kernels::OwnData;

/// The shader's stem.
pub const STEM: &str = "field/thermal";

pub(super) fn data(kernel: &ThermalKernel, phase: ThermalPhase, has_hardness: bool) -> OwnData {
    let layers: Vec<ThermalLayer> = kernel.layers().copied().collect();
    let constants = [
        ("PHASE", phase as u32),
        ("NUM_LAYERS", kernel.num_layers),
        ("HAS_HARDNESS", u32::from(has_hardness)),
    ];
    OwnData::storage(bytemuck::cast_slice(&layers)).with_constants(&constants)
}
