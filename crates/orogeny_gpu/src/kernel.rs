//! Compute pipelines, made once for each stem and set of constants.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

use orogeny_shaders::{Binding, BindingKind, SampleType, Shader, TextureAccess, TextureDimension, shader};

use crate::{Error, Gpu, Result};

/// The bind group that belongs to the kernel; 0 is the frame's.
const KERNEL_GROUP: u32 = 1;

/// A compute kernel with its constants set.
#[derive(Debug)]
pub struct Kernel {
    /// The pipeline.
    pub pipeline: wgpu::ComputePipeline,
    /// The layout of bind group 1, reflected from the shader.
    pub bind_group_layout: wgpu::BindGroupLayout,
}

impl Kernel {
    /// Records one dispatch, with its resources in the order of their bindings, over so many workgroups along x and y.
    pub fn record<'a>(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        label: &str,
        resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
        [columns, rows]: [u32; 2],
    ) {
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let bind_group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: &self.bind_group_layout,
            entries: &entries,
        });
        let mut pass = encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes: None });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(KERNEL_GROUP, &bind_group, &[]);
        pass.dispatch_workgroups(columns, rows, 1);
    }
}

/// The kernels that a device has built.
pub(crate) type BuiltKernels = HashMap<Variant, Arc<Kernel>>;

/// A stem, or what tells a kernel that does not come with the program from others, and its constants, in the order in which they
/// were given.
type Variant = (Cow<'static, str>, Vec<(&'static str, u32)>);

impl Gpu {
    /// The kernel of a stem (`brush/raise`) with its pipeline-overridable constants; built when it is first asked for.
    ///
    /// # Errors
    /// [`Error::NoKernel`] for an unknown stem, [`Error::Validation`] when the driver refuses it.
    pub fn kernel(&self, stem: &'static str, constants: &[(&'static str, u32)]) -> Result<Arc<Kernel>> {
        let shader = shader(stem).ok_or_else(|| Error::NoKernel { stem: stem.to_owned() })?;
        self.built_once(shader, Cow::Borrowed(stem), constants)
    }

    /// The kernel of a shader that does not come with the program; `identity` tells it from others.
    ///
    /// # Errors
    /// [`Error::Validation`] when the driver refuses it.
    pub fn kernel_of(
        &self,
        shader: &Shader,
        identity: &str,
        constants: &[(&'static str, u32)],
    ) -> Result<Arc<Kernel>> {
        self.built_once(shader, Cow::Owned(identity.to_owned()), constants)
    }

    fn built_once(
        &self,
        shader: &Shader,
        name: Cow<'static, str>,
        constants: &[(&'static str, u32)],
    ) -> Result<Arc<Kernel>> {
        let variant = (name, constants.to_vec());
        if let Some(kernel) = self.built_kernels().get(&variant) {
            return Ok(Arc::clone(kernel));
        }
        // Not under the lock: drivers take long. Should two threads build one at a time, they have the same.
        let kernel = Arc::new(self.build(shader, constants)?);
        self.built_kernels().insert(variant, Arc::clone(&kernel));
        Ok(kernel)
    }

    fn build(&self, shader: &Shader, constants: &[(&str, u32)]) -> Result<Kernel> {
        let stem = &shader.stem;
        let device = self.device();
        let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let label = format!("orogeny.{stem}");
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(&label),
            source: wgpu::ShaderSource::Wgsl(shader.wgsl.as_ref().into()),
        });
        let entries: Vec<_> = shader
            .bindings
            .iter()
            .filter(|binding| binding.group == KERNEL_GROUP)
            .map(|binding| layout_entry(binding, wgpu::ShaderStages::COMPUTE, false))
            .collect();
        let bind_group_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(&label),
            entries: &entries,
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&label),
            bind_group_layouts: &[None, Some(&bind_group_layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&label),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(&shader.entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &own_constants(shader, constants),
                ..wgpu::PipelineCompilationOptions::default()
            },
            cache: None,
        });
        match pollster::block_on(validation.pop()) {
            Some(error) => Err(Error::Validation { messages: format!("kernel `{stem}`: {error}") }),
            None => Ok(Kernel { pipeline, bind_group_layout }),
        }
    }
}

/// The constants that the shader declares: a driver shared by kernels may use more of them than each kernel has.
pub(crate) fn own_constants<'a>(shader: &Shader, constants: &[(&'a str, u32)]) -> Vec<(&'a str, f64)> {
    let declared = |name: &str| shader.overrides.iter().any(|constant| constant.name == name);
    constants
        .iter()
        .filter(|(name, _)| declared(name))
        .map(|(name, value)| (*name, f64::from(*value)))
        .collect()
}

/// How a binding is laid out for some stages. `is_filtered` says whether a sampler may look between its texels.
pub(crate) fn layout_entry(
    binding: &Binding,
    visibility: wgpu::ShaderStages,
    is_filtered: bool,
) -> wgpu::BindGroupLayoutEntry {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: std::num::NonZeroU64::new(binding.size_in_bytes),
    };
    let ty = match binding.kind {
        BindingKind::UniformBuffer => buffer(wgpu::BufferBindingType::Uniform),
        BindingKind::StorageBuffer { writable } => {
            buffer(wgpu::BufferBindingType::Storage { read_only: !writable })
        }
        BindingKind::Texture { dimension, sample_type, multisampled } => wgpu::BindingType::Texture {
            sample_type: match sample_type {
                // Heights are R32Float, which WebGPU does not filter.
                SampleType::Float => wgpu::TextureSampleType::Float { filterable: is_filtered },
                SampleType::Sint => wgpu::TextureSampleType::Sint,
                SampleType::Uint => wgpu::TextureSampleType::Uint,
                SampleType::Depth => wgpu::TextureSampleType::Depth,
            },
            view_dimension: view_dimension(dimension),
            multisampled,
        },
        BindingKind::StorageTexture { dimension, access, .. } => wgpu::BindingType::StorageTexture {
            access: match access {
                TextureAccess::Read => wgpu::StorageTextureAccess::ReadOnly,
                TextureAccess::Write => wgpu::StorageTextureAccess::WriteOnly,
                TextureAccess::ReadWrite => wgpu::StorageTextureAccess::ReadWrite,
            },
            // The only format that kernels write (shaders/README.md).
            format: wgpu::TextureFormat::R32Float,
            view_dimension: view_dimension(dimension),
        },
        BindingKind::Sampler { comparison } => wgpu::BindingType::Sampler(if comparison {
            wgpu::SamplerBindingType::Comparison
        } else if is_filtered {
            wgpu::SamplerBindingType::Filtering
        } else {
            wgpu::SamplerBindingType::NonFiltering
        }),
    };
    wgpu::BindGroupLayoutEntry { binding: binding.binding, visibility, ty, count: None }
}

fn view_dimension(dimension: TextureDimension) -> wgpu::TextureViewDimension {
    match dimension {
        TextureDimension::D1 => wgpu::TextureViewDimension::D1,
        TextureDimension::D2 => wgpu::TextureViewDimension::D2,
        TextureDimension::D2Array => wgpu::TextureViewDimension::D2Array,
        TextureDimension::D3 => wgpu::TextureViewDimension::D3,
        TextureDimension::Cube => wgpu::TextureViewDimension::Cube,
    }
}
