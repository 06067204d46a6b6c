//! Render pipelines from the embedded shaders. What they bind is reflected from both of their stages.

use std::collections::BTreeMap;

use orogeny_shaders::{Shader, shader};

use crate::kernel::{layout_entry, own_constants};
use crate::{Error, Gpu, Result};

/// What a render pipeline is made of.
#[derive(Debug, Clone)]
pub struct DrawingRequest<'a> {
    /// The stem of the vertex shader (`terrain/surface`).
    pub vertex: &'a str,
    /// That of the fragment shader; `None` where only depth is drawn.
    pub fragment: Option<&'a str>,
    /// Pipeline-overridable constants, of either stage.
    pub constants: &'a [(&'a str, u32)],
    /// What the fragment shader writes.
    pub colour: Option<wgpu::ColorTargetState>,
    /// How depth is tested and written.
    pub depth: Option<wgpu::DepthStencilState>,
    /// What the vertices make.
    pub topology: wgpu::PrimitiveTopology,
    /// Textures, by name, that no sampler filters: heights.
    pub unfiltered: &'a [&'a str],
}

/// A render pipeline with the layouts of its bind groups.
#[derive(Debug)]
pub struct Drawing {
    /// The pipeline.
    pub pipeline: wgpu::RenderPipeline,
    /// The layouts of its bind groups, from 0 on.
    pub bind_group_layouts: Vec<wgpu::BindGroupLayout>,
    /// How many bindings each of them has.
    pub num_bindings: Vec<usize>,
}

impl Gpu {
    /// Builds a render pipeline.
    ///
    /// # Errors
    /// [`Error::NoKernel`] for an unknown stem, [`Error::Validation`] when the driver refuses it.
    pub fn drawing(&self, request: &DrawingRequest<'_>) -> Result<Drawing> {
        let found = |stem: &str| shader(stem).ok_or_else(|| Error::NoKernel { stem: stem.to_owned() });
        let vertex = found(request.vertex)?;
        let fragment = request.fragment.map(found).transpose()?;
        let device = self.device();
        let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let name = fragment.map_or(&vertex.stem, |fragment| &fragment.stem);
        let label = format!("orogeny.{name}");
        let entries = entries(vertex, fragment, request.unfiltered);
        let bind_group_layouts: Vec<_> = entries
            .iter()
            .map(|entries| {
                device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: Some(&label),
                    entries,
                })
            })
            .collect();
        let groups: Vec<_> = bind_group_layouts.iter().map(Some).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&label),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let module = |shader: &Shader| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(&label),
                source: wgpu::ShaderSource::Wgsl(shader.wgsl.as_ref().into()),
            })
        };
        let (vertex_module, fragment_module) = (module(vertex), fragment.map(module));
        let vertex_constants = own_constants(vertex, request.constants);
        let fragment_constants =
            fragment.map(|fragment| own_constants(fragment, request.constants)).unwrap_or_default();
        let targets = [request.colour.clone()];
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(&label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &vertex_module,
                entry_point: Some(&vertex.entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &vertex_constants,
                    ..wgpu::PipelineCompilationOptions::default()
                },
                buffers: &[],
            },
            fragment: fragment_module.as_ref().zip(fragment).map(|(module, shader)| wgpu::FragmentState {
                module,
                entry_point: Some(&shader.entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &fragment_constants,
                    ..wgpu::PipelineCompilationOptions::default()
                },
                targets: &targets,
            }),
            primitive: wgpu::PrimitiveState { topology: request.topology, ..wgpu::PrimitiveState::default() },
            depth_stencil: request.depth.clone(),
            multisample: wgpu::MultisampleState::default(),
            multiview_mask: None,
            cache: None,
        });
        match pollster::block_on(validation.pop()) {
            Some(error) => Err(Error::Validation { messages: format!("drawing by `{name}`: {error}") }),
            None => {
                let num_bindings = entries.iter().map(Vec::len).collect();
                Ok(Drawing { pipeline, bind_group_layouts, num_bindings })
            }
        }
    }
}

/// What both stages bind, group by group; a group that neither has is empty.
fn entries(
    vertex: &Shader,
    fragment: Option<&Shader>,
    unfiltered: &[&str],
) -> Vec<Vec<wgpu::BindGroupLayoutEntry>> {
    let mut all: BTreeMap<(u32, u32), wgpu::BindGroupLayoutEntry> = BTreeMap::new();
    let stages = [(Some(vertex), wgpu::ShaderStages::VERTEX), (fragment, wgpu::ShaderStages::FRAGMENT)];
    for (shader, stage) in stages {
        for binding in shader.iter().flat_map(|shader| shader.bindings.iter()) {
            let is_filtered = !unfiltered.contains(&&*binding.name);
            // The frame's bindings are the same for every pipeline, whichever of its stages looks at them.
            let visibility = if binding.group == 0 { wgpu::ShaderStages::VERTEX_FRAGMENT } else { stage };
            let entry = layout_entry(binding, visibility, is_filtered);
            all.entry((binding.group, binding.binding))
                .and_modify(|known| known.visibility |= visibility)
                .or_insert(entry);
        }
    }
    let num_groups = all.keys().next_back().map_or(0, |(group, _)| group + 1);
    let of_group = |group: u32| all.range((group, 0)..(group + 1, 0)).map(|(_, entry)| *entry).collect();
    (0..num_groups).map(of_group).collect()
}
