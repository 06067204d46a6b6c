//! Samples of a rectangle that lie on a device, for whoever works on it too.

use crate::Gpu;

/// Samples of a rectangle of a grid in a buffer, row by row. Whoever reads them submits after whoever wrote them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DevicePlane {
    /// Where they lie.
    pub gpu: Gpu,
    /// One `f32` a sample; it can be copied from.
    pub buffer: wgpu::Buffer,
    /// The first sample, on its grid.
    pub origin: [i32; 2],
    /// Samples along x and z.
    pub size: [u32; 2],
    /// Samples from row to row: a multiple of 64, as copies to textures ask for.
    pub stride: u32,
}

impl DevicePlane {
    /// Where a sample lies, in bytes; `None` unless it has `num` samples along x and z from there on.
    #[must_use]
    pub fn offset(&self, first: [i32; 2], num: [u32; 2]) -> Option<u64> {
        let place = |axis: usize| -> Option<u64> {
            let from = u32::try_from(first.get(axis)?.checked_sub(*self.origin.get(axis)?)?).ok()?;
            let is_there = from.checked_add(*num.get(axis)?)? <= *self.size.get(axis)?;
            is_there.then_some(u64::from(from))
        };
        Some((place(1)? * u64::from(self.stride) + place(0)?) * 4)
    }
}
