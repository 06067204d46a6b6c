//! Graphs worked out on the GPU: each plane a buffer, one dispatch a step.

use orogeny_field::SampleRect;
use orogeny_gpu::Gpu;

use crate::filter::kernels::{PlaneUniform, StepUniform};
use crate::filter::{Graph, Step};
use crate::{Error, Result};

/// Samples a side of a workgroup.
const WORKGROUP_SIDE: u32 = 16;
/// Samples that a row is a multiple of, so that it can be copied to and from textures: 256 bytes.
const STRIDE_UNIT: u32 = 64;
/// Buffers that are kept for the next graph.
const MAX_POOLED: usize = 8;

/// A plane in a buffer.
#[derive(Debug, Clone)]
pub(super) struct GpuPlane {
    pub(super) buffer: wgpu::Buffer,
    pub(super) rect: SampleRect,
    pub(super) stride: u32,
}

/// Works out graphs, and keeps the memory of their planes.
#[derive(Debug, Default)]
pub(super) struct GpuPlanes {
    pool: Vec<wgpu::Buffer>,
}

impl GpuPlane {
    /// The place of a sample, in bytes.
    pub(super) const fn offset(&self, x: i32, z: i32) -> u64 {
        let (column, row) = (x.abs_diff(self.rect.x0), z.abs_diff(self.rect.z0));
        (row as u64 * self.stride as u64 + column as u64) * 4
    }

    pub(super) const fn uniform(&self) -> PlaneUniform {
        PlaneUniform {
            origin: [self.rect.x0, self.rect.z0],
            stride: self.stride,
            channel_stride: self.stride * self.rect.depth(),
        }
    }
}

impl GpuPlanes {
    /// A plane whose values are to be written.
    ///
    /// # Errors
    /// [`Error::PlaneSize`] for one that no buffer of the device holds; [`Error::Gpu`] when there is no memory.
    pub(super) fn plane(&mut self, gpu: &Gpu, rect: SampleRect, num_channels: u32) -> Result<GpuPlane> {
        let stride = rect.width().max(1).next_multiple_of(STRIDE_UNIT);
        let size = u64::from(stride) * u64::from(rect.depth().max(1)) * u64::from(num_channels) * 4;
        let limit = gpu.device().limits().max_storage_buffer_binding_size;
        if size > limit {
            return Err(Error::PlaneSize { width: rect.width(), depth: rect.depth(), limit_in_bytes: limit });
        }
        let fitting = self.pool.iter().enumerate().filter(|(_, buffer)| buffer.size() >= size);
        let best = fitting.min_by_key(|(_, buffer)| buffer.size()).map(|(place, _)| place);
        let buffer = match best {
            Some(place) => self.pool.swap_remove(place),
            None => gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("orogeny.brush.plane"),
                size,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })?,
        };
        Ok(GpuPlane { buffer, rect, stride })
    }

    /// Takes back the memory of a plane, once what reads it is recorded.
    pub(super) fn give_back(&mut self, plane: GpuPlane) {
        if self.pool.len() < MAX_POOLED {
            self.pool.push(plane.buffer);
        }
    }

    /// Gives up the memory that is kept.
    pub(super) fn clear(&mut self) {
        self.pool.clear();
    }

    pub(super) fn size_in_bytes(&self) -> u64 {
        self.pool.iter().map(wgpu::Buffer::size).sum()
    }

    /// Records the step that makes plane number `place` of a graph, whose planes have the rectangles that it planned; those before it
    /// are there. Gives back the memory of those that no later step reads.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (graph, rects): (&Graph, &[SampleRect]),
        place: usize,
        made: &mut Vec<Option<GpuPlane>>,
    ) -> Result<()> {
        let (Some(node), Some(rect)) = (graph.nodes().get(place), rects.get(place)) else { return Ok(()) };
        let plane = self.plane(gpu, *rect, node.step.num_channels())?;
        let input = |number: usize| {
            let place = node.inputs.get(number)?;
            Some((made.get(*place)?.as_ref()?, graph.nodes().get(*place)?))
        };
        if let (Some(stem), Some((first, first_node))) = (node.step.stem(), input(0)) {
            let second = input(1).map_or(first, |(second, _)| second);
            let uniform = StepUniform {
                result: plane.uniform(),
                first: first.uniform(),
                second: second.uniform(),
                size: [rect.width(), rect.depth()],
                extent: graph.extent(),
                is_mirrored: u32::from(first_node.step == Step::Heights),
                phase: node.step.phase(),
            };
            dispatch(gpu, encoder, stem, &node.step, &uniform, [first, second, &plane])?;
        }
        made.push(Some(plane));
        for input in graph.done_with(place) {
            if let Some(plane) = made.get_mut(input).and_then(Option::take) {
                self.give_back(plane);
            }
        }
        Ok(())
    }
}

fn dispatch(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    stem: &'static str,
    step: &Step,
    uniform: &StepUniform,
    planes: [&GpuPlane; 3],
) -> Result<()> {
    let own = step.data();
    let kernel = gpu.kernel(stem, &own.constants)?;
    let (uniform_usage, storage_usage) = (wgpu::BufferUsages::UNIFORM, wgpu::BufferUsages::STORAGE);
    let small = |usage, bytes: &[u8]| gpu.create_buffer_with("orogeny.brush.step", usage, bytes);
    let uniform_buffer = small(uniform_usage, bytemuck::bytes_of(uniform))?;
    let own: Vec<_> = (own.uniforms.iter().map(|bytes| small(uniform_usage, bytes)))
        .chain(own.storage.iter().map(|bytes| small(storage_usage, bytes)))
        .collect::<Result<_, _>>()?;
    let buffers = std::iter::once(&uniform_buffer).chain(planes.map(|plane| &plane.buffer)).chain(&own);
    let workgroups = uniform.size.map(|samples| samples.div_ceil(WORKGROUP_SIDE));
    kernel.record(gpu, encoder, stem, buffers.map(wgpu::Buffer::as_entire_binding), workgroups);
    Ok(())
}
