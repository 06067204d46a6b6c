//! What a field is now, on the levels that are looked at: made of what is resident, for whoever draws on the same device.
//!
//! Nothing is read back but the lowest and the highest height.

use orogeny_field::{FieldId, HeightBounds, SampleRect, TerrainGrid};
use orogeny_gpu::DevicePlane;
use orogeny_pages::PageStore;

use super::GpuExecutor;
use super::planes::{GpuPlane, StepDispatch};
use crate::Result;
use crate::execute::Levels;
use crate::filter::kernels::coarsen;

/// The shader's stem of what finds bounds, and the samples of a row that an invocation looks at.
const BOUNDS_STEM: &str = "field/bounds";
const BOUNDS_RUN: u32 = 64;
/// Samples of full resolution that are looked at once, as they lie in memory: 64 MiB.
const MAX_SAMPLES: u64 = 1 << 24;

impl GpuExecutor {
    /// As [`crate::Executor::levels`].
    pub(super) fn work_out_levels(
        &mut self,
        field: FieldId,
        grid: &TerrainGrid,
        wanted: &[SampleRect],
        store: &mut dyn PageStore,
    ) -> Result<Option<Levels>> {
        let needed = needed(grid, wanted);
        let Some(finest) = needed.first().copied().filter(|rect| !rect.is_empty()) else { return Ok(None) };
        if GpuPlane::num_samples(&finest) > MAX_SAMPLES || !self.holds_most(field, finest) {
            return Ok(None);
        }
        let mut encoder = self.encoder();
        let ground = self.ground(&mut encoder, finest, field, true, store)?;
        // Means lie within what they are made of, so the bounds are those of all levels.
        let read = self.record_bounds(&mut encoder, &ground)?;
        let mut made = vec![ground];
        for (level, rect) in (1_u8..).zip(needed.iter().skip(1)) {
            let Some(below) = made.last() else { break };
            if rect.is_empty() {
                break;
            }
            let plane = self.planes.plane(&self.gpu, *rect, 1)?;
            let bounds = grid.bounds_at(level - 1);
            let step = StepDispatch { extent: [bounds.width(), bounds.depth()], at_once: [1, 1] };
            step.record(&self.gpu, &mut encoder, coarsen::STEM, below, &plane, None)?;
            made.push(plane);
        }
        self.submit(encoder)?;
        let words = self.gpu.read_buffer(&read)?;
        let planes = made.into_iter().zip(wanted).map(|(plane, wanted)| {
            if wanted.is_empty() {
                self.planes.give_back(plane);
                return None;
            }
            // It is never used for anything else: whoever has it may read it when they like.
            let GpuPlane { buffer, rect, stride } = plane;
            let (origin, size) = ([rect.x0, rect.z0], [rect.width(), rect.depth()]);
            Some(DevicePlane { gpu: self.gpu.clone(), buffer, origin, size, stride })
        });
        let planes = planes.collect();
        let [min_m, max_m] =
            [words.first(), words.get(1)].map(|word| height_of(word.copied().unwrap_or_default()));
        Ok(Some(Levels { planes, bounds: HeightBounds::of(min_m).with(HeightBounds::of(max_m)) }))
    }

    /// Whether most of a rectangle is resident: else more would be handed over than is there.
    fn holds_most(&self, field: FieldId, rect: SampleRect) -> bool {
        let resident = self.keys_in(field, rect).filter(|key| self.heights.slot(key).is_some());
        let area: u64 = resident.map(|key| self.layout.page_rect(&key).intersection(&rect).area()).sum();
        2 * area > rect.area()
    }

    /// Records the search for the bounds of a plane; gives the buffer that they can be read from.
    fn record_bounds(&self, encoder: &mut wgpu::CommandEncoder, plane: &GpuPlane) -> Result<wgpu::Buffer> {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let nothing: [u32; 2] = [u32::MAX, 0];
        let bounds =
            self.gpu.create_buffer_with("orogeny.brush.bounds", usage, bytemuck::cast_slice(&nothing))?;
        let step = StepDispatch { extent: [0, 0], at_once: [BOUNDS_RUN, 1] };
        step.record(&self.gpu, encoder, BOUNDS_STEM, plane, plane, Some(&bounds))?;
        let size = size_of_val(&nothing) as u64;
        let read = self.gpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some("orogeny.brush.bounds.readback"),
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })?;
        encoder.copy_buffer_to_buffer(&bounds, 0, &read, 0, size);
        Ok(read)
    }
}

/// What each level must have for the wanted ones to be made of it.
fn needed(grid: &TerrainGrid, wanted: &[SampleRect]) -> Vec<SampleRect> {
    let mut needed = wanted.to_vec();
    for (level, place) in (0_u8..).zip(0..needed.len()) {
        if let Some(rect) = needed.get_mut(place) {
            *rect = rect.intersection(&grid.bounds_at(level));
        }
    }
    for place in (1..needed.len()).rev() {
        let Some(SampleRect { x0, z0, x1, z1 }) = needed.get(place).copied().filter(|rect| !rect.is_empty())
        else {
            continue;
        };
        let around = SampleRect::new(2 * x0 - 1, 2 * z0 - 1, 2 * x1, 2 * z1);
        if let Some(below) = needed.get_mut(place - 1) {
            let level = u8::try_from(place - 1).unwrap_or(u8::MAX);
            *below = below.bounds_with(&around.intersection(&grid.bounds_at(level)));
        }
    }
    needed
}

/// The height that a whole number stands for, in `field/bounds`.
const fn height_of(ordered: u32) -> f32 {
    f32::from_bits(ordered ^ if ordered >> 31 == 1 { 1 << 31 } else { u32::MAX })
}
