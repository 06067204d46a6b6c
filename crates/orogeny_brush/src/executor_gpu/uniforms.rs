//! What a pass is to the kernels: the mirrors of `shaders/driver/`, the constants, and what each kernel has of its own.

use orogeny_field::{CURVE_TABLE_LENGTH, CurveTable, FalloffFormula, Footprint, Instance};
use orogeny_gpu::Gpu;

use crate::Result;
use crate::kernels::{
    OwnData, Rule, custom, ledge, level, mask, noise, ramp, range_map, roughen, stamp, terrace,
};
use crate::plan::{Batch, Pass};

/// Size of `Counters`.
pub(super) const COUNTERS_SIZE_IN_BYTES: u64 = 4;

/// What is the same for all instances of a pass. The layout is that of `Brush` in `shaders/driver/footprint.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct BrushUniform {
    /// See [`orogeny_field::Falloff`].
    pub inverse_falloff_ratio: f32,
    /// See [`orogeny_field::Falloff`].
    pub falloff_exponent: f32,
    /// See [`orogeny_field::Falloff`].
    pub falloff_scale: f32,
}

impl From<&Pass> for BrushUniform {
    fn from(pass: &Pass) -> Self {
        let falloff = &pass.footprint.falloff;
        Self {
            inverse_falloff_ratio: falloff.inverse_falloff_ratio,
            falloff_exponent: falloff.exponent,
            falloff_scale: falloff.scale,
        }
    }
}

/// What a batch's kernel has of its own.
pub(super) fn own_data(batch: &Batch) -> OwnData {
    match &batch.pass.rule {
        Rule::Raise | Rule::Filter(_) => OwnData::default(),
        Rule::Ledge(direction) => ledge::data(*direction),
        Rule::Level { target_height_m, only } => level::data(*target_height_m, *only),
        Rule::Ramp { along, only } => ramp::data(*along, *only),
        Rule::Roughen { seed } => roughen::data(*seed),
        Rule::Noise(kernel) => noise::data(kernel, &batch.frames, batch.pass.roughness.is_some()),
        Rule::Terrace(steps) => terrace::data(steps),
        Rule::RangeMap(range) => range_map::data(range),
        Rule::Stamp { scale_m, mode, .. } => stamp::data(*scale_m, *mode),
        Rule::Mask { value } => mask::data(*value),
        Rule::Custom(rule) => custom::data(rule),
    }
}

/// The constants that a pass's kernel is built with, beside its own.
pub(super) fn constants(batch: &Batch) -> impl Iterator<Item = (&'static str, u32)> {
    let pass = &batch.pass;
    let of_pass = [("IS_GATED", u32::from(pass.gate.is_some())), ("IS_MASK", u32::from(pass.is_mask))];
    footprint_constants(&pass.footprint, &batch.instances).into_iter().chain(of_pass)
}

/// The constants by which instances cover samples.
pub(super) fn footprint_constants(footprint: &Footprint, instances: &[Instance]) -> [(&'static str, u32); 5] {
    // A fill: how far a sample is away is a third of what a software driver does for it.
    let is_everywhere = footprint.falloff.formula == FalloffFormula::HardEdge
        && !footprint.is_segment
        && instances.iter().all(|instance| instance.inverse_radius == 0.0);
    [
        ("IS_EVERYWHERE", u32::from(is_everywhere)),
        ("FALLOFF_FORMULA", footprint.falloff.formula as u32),
        ("WEIGHT_MODE", footprint.weight_mode as u32),
        ("IS_SEGMENT", u32::from(footprint.is_segment)),
        ("HAS_ALPHA", u32::from(footprint.alpha.is_some())),
    ]
}

/// The tables that a pass reads, in the order of `shaders/driver/footprint.wgsl`: falloff, transfer, result. Those that it does
/// not have are zeros, as far as others come after them.
pub(super) fn curves(pass: &Pass) -> Vec<f32> {
    let (transfer, result) = match &pass.rule {
        Rule::Noise(kernel) => (kernel.transfer.as_ref(), kernel.curve.as_ref()),
        Rule::RangeMap(range) => (None, range.table.as_deref()),
        _ => (None, None),
    };
    let tables: [Option<&CurveTable>; 3] = [pass.footprint.falloff.table.as_deref(), transfer, result];
    let mut values = Vec::new();
    for (place, table) in tables.into_iter().enumerate() {
        if let Some(table) = table {
            values.resize(place * CURVE_TABLE_LENGTH, 0.0);
            values.extend(table.values);
        }
    }
    if values.is_empty() {
        values.push(0.0);
    }
    values
}

/// The buffers of what a kernel has of its own, in the order of their bindings.
pub(super) fn own_buffers(gpu: &Gpu, own: &OwnData) -> Result<Vec<wgpu::Buffer>> {
    let (uniform, storage) = (wgpu::BufferUsages::UNIFORM, wgpu::BufferUsages::STORAGE);
    (own.uniforms.iter().map(|bytes| (uniform, bytes)))
        .chain(own.storage.iter().map(|bytes| (storage, bytes)))
        .map(|(usage, bytes)| Ok(gpu.create_buffer_with("orogeny.brush.own", usage, bytes)?))
        .collect()
}
