//! Graphs worked out on the GPU: each plane a buffer, one dispatch a step.

use orogeny_field::{Mirrors, SampleRect};
use orogeny_gpu::Gpu;

use super::uniforms::own_buffers;
use crate::filter::kernels::{InputUniform, PlaneUniform, StepUniform};
use crate::filter::{Graph, MAX_INPUTS};
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
    fn stride_of(rect: &SampleRect) -> u32 {
        rect.width().max(1).next_multiple_of(STRIDE_UNIT)
    }

    /// Samples of a rectangle with what lies between its rows.
    pub(super) fn num_samples(rect: &SampleRect) -> u64 {
        u64::from(Self::stride_of(rect)) * u64::from(rect.depth().max(1))
    }

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
        let stride = GpuPlane::stride_of(&rect);
        let size = GpuPlane::num_samples(&rect) * u64::from(num_channels) * 4;
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
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_DST
                    | wgpu::BufferUsages::COPY_SRC,
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

    /// Records the step that makes plane number `place` of a graph over a rectangle; those that it is made of are there.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        graph: &Graph,
        place: usize,
        rect: SampleRect,
        made: &[Option<GpuPlane>],
    ) -> Result<GpuPlane> {
        let node = graph.nodes().get(place);
        let plane = self.plane(gpu, rect, node.map_or(1, |node| node.step.num_channels()))?;
        let Some(node) = node.filter(|_| !rect.is_empty()) else { return Ok(plane) };
        let inputs: Vec<_> = (node.inputs.iter())
            .filter_map(|input| Some((made.get(*input)?.as_ref()?, graph.mirrors(*input))))
            .collect();
        // A step that is made of nothing has something bound there all the same, which it does not read.
        let nothing = if inputs.is_empty() { Some(self.plane(gpu, SampleRect::EMPTY, 1)?) } else { None };
        let first = inputs.first().copied().or_else(|| Some((nothing.as_ref()?, Mirrors::NONE)));
        if let (Some(stem), Some(first)) = (node.step.stem(), first) {
            let input = |number: usize| inputs.get(number).copied().unwrap_or(first);
            let bound: [_; MAX_INPUTS] = std::array::from_fn(input);
            let uniform = StepUniform {
                result: plane.uniform(),
                inputs: bound.map(|(plane, mirrors)| InputUniform {
                    plane: plane.uniform(),
                    periods: mirrors.periods.map(Option::unwrap_or_default),
                    padding: [0; 2],
                }),
                size: [rect.width(), rect.depth()],
                extent: graph.extent(),
            };
            let [first, second, third, fourth] = bound.map(|(plane, _)| &plane.buffer);
            // Along x and z of the first, along x and z of the second …
            let axes = bound.iter().flat_map(|(_, mirrors)| mirrors.periods);
            let mirrored = axes.enumerate().map(|(axis, period)| u32::from(period.is_some()) << axis).sum();
            let mut own = node.step.data(&rect, inputs.len());
            let [along_x, along_z] = node.step.at_once();
            own.constants.extend([
                ("MIRRORED_AXES", mirrored),
                ("AT_ONCE_ALONG_X", along_x),
                ("AT_ONCE_ALONG_Z", along_z),
            ]);
            let own_buffers = own_buffers(gpu, &own)?;
            let buffers = [first, second, third, fourth, &plane.buffer].into_iter().chain(&own_buffers);
            let invocations = [rect.width().div_ceil(along_x), rect.depth().div_ceil(along_z)];
            dispatch(gpu, encoder, stem, &own.constants, &uniform, buffers, invocations)?;
        }
        if let Some(nothing) = nothing {
            self.give_back(nothing);
        }
        Ok(plane)
    }
}

/// A step of one plane that is no graph's: what its kernel is told beside the planes.
pub(super) struct StepDispatch {
    /// Samples of the ground along x and z that the plane which is read is a part of.
    pub(super) extent: [u32; 2],
    /// Samples along x and z that an invocation makes, or looks at.
    pub(super) at_once: [u32; 2],
}

impl StepDispatch {
    /// Records it: from a plane to another, or to a buffer of the kernel's own.
    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        stem: &'static str,
        source: &GpuPlane,
        result: &GpuPlane,
        own: Option<&wgpu::Buffer>,
    ) -> Result<()> {
        let Self { extent, at_once: [along_x, along_z] } = *self;
        let size = [result.rect.width(), result.rect.depth()];
        let input = InputUniform { plane: source.uniform(), ..InputUniform::default() };
        let uniform = StepUniform { result: result.uniform(), inputs: [input; MAX_INPUTS], size, extent };
        // Nothing is written where the kernel has a buffer of its own for that.
        let written = match own {
            None => result.buffer.clone(),
            Some(_) => gpu.create_buffer_with("orogeny.brush.nothing", wgpu::BufferUsages::STORAGE, &[])?,
        };
        let [first, second, third, fourth] = [&source.buffer; MAX_INPUTS];
        dispatch(
            gpu,
            encoder,
            stem,
            &[("MIRRORED_AXES", 0), ("AT_ONCE_ALONG_X", along_x), ("AT_ONCE_ALONG_Z", along_z)],
            &uniform,
            [first, second, third, fourth, &written].into_iter().chain(own),
            [size[0].div_ceil(along_x), size[1].div_ceil(along_z)],
        )
    }
}

/// Records a step: `buffers` are those of the planes that are read, of the one that is written, and of the kernel's own.
fn dispatch<'a>(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    stem: &'static str,
    constants: &[(&'static str, u32)],
    uniform: &StepUniform,
    buffers: impl Iterator<Item = &'a wgpu::Buffer>,
    invocations: [u32; 2],
) -> Result<()> {
    let kernel = gpu.kernel(stem, constants)?;
    let usage = wgpu::BufferUsages::UNIFORM;
    let uniform = gpu.create_buffer_with("orogeny.brush.step", usage, bytemuck::bytes_of(uniform))?;
    let bindings =
        std::iter::once(uniform.as_entire_binding()).chain(buffers.map(|buffer| buffer.as_entire_binding()));
    let workgroups = invocations.map(|num| num.div_ceil(WORKGROUP_SIDE));
    kernel.record(gpu, encoder, stem, bindings, workgroups);
    Ok(())
}
