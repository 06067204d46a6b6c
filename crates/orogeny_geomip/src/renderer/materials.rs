//! A material set on the GPU: its rules, and the textures of its layers.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use orogeny_gpu::{Gpu, Result};

use crate::material::{LayerRule, MAX_LAYERS, ResolvedSet, SurfaceTexture};

/// How many times as large a texture is far away: `FAR_TIMES` in `shaders/scene/material.wgsl`.
const FAR_TIMES: f64 = 7.3;

/// The set's rules, and where the eye is in its textures: `shaders/scene/material.wgsl` says what each field is.
#[derive(Debug, Clone, Copy, PartialEq, Zeroable, Pod)]
#[repr(C)]
#[expect(missing_docs, reason = "said where the shaders have them")]
pub struct MaterialUniform {
    pub blend_depth: f32,
    pub blend_contrast: f32,
    pub macro_per_m: f32,
    pub macro_amount: f32,
    pub num_layers: u32,
    pub pad_a: u32,
    pub pad_b: u32,
    pub pad_c: u32,
    pub layers: [LayerRule; MAX_LAYERS],
    pub eye_repeats: [[f32; 4]; MAX_LAYERS],
    pub eye_far_repeats: [[f32; 4]; MAX_LAYERS],
}

/// A set with the textures of its layers, all of one size and with all smaller levels.
#[derive(Debug)]
pub(super) struct Materials {
    set: ResolvedSet,
    pub(super) albedo_heights: wgpu::TextureView,
    pub(super) normal_roughnesses: wgpu::TextureView,
    pub(super) sampler: wgpu::Sampler,
}

impl Materials {
    /// Of a set's rules and, for each layer, its texture's levels from the largest on.
    pub(super) fn new(gpu: &Gpu, set: ResolvedSet, layers: &[Vec<SurfaceTexture>]) -> Result<Self> {
        let albedo =
            array(gpu, "orogeny.albedo_heights", wgpu::TextureFormat::Rgba8UnormSrgb, layers, |level| {
                &level.albedo_height
            })?;
        let normal =
            array(gpu, "orogeny.normal_roughnesses", wgpu::TextureFormat::Rgba8Unorm, layers, |level| {
                &level.normal_roughness
            })?;
        let sampler = gpu.device().create_sampler(&wgpu::SamplerDescriptor {
            label: Some("orogeny.material"),
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            // Mesa 22.3's software driver does not come back from an anisotropic look-up with gradients.
            anisotropy_clamp: if gpu.description().is_software { 1 } else { 8 },
            ..wgpu::SamplerDescriptor::default()
        });
        Ok(Self { set, albedo_heights: albedo, normal_roughnesses: normal, sampler })
    }

    /// As an eye sees it from a place in metres.
    pub(super) fn uniform(&self, eye_m: DVec3) -> MaterialUniform {
        let mut uniform = MaterialUniform {
            blend_depth: self.set.set.blend_depth,
            blend_contrast: self.set.set.blend_contrast,
            macro_per_m: self.set.set.macro_per_m,
            macro_amount: self.set.set.macro_amount,
            num_layers: self.set.layers.len() as u32,
            ..MaterialUniform::zeroed()
        };
        let far = uniform.eye_far_repeats.iter_mut();
        let to = uniform.layers.iter_mut().zip(uniform.eye_repeats.iter_mut()).zip(far);
        for (((layer, near), far), rule) in to.zip(&self.set.layers) {
            let [_, repeats_per_m, ..] = rule.look;
            // What is left of whole repeats, worked out in 64 bits: textures do not swim far from the origin.
            let repeats = |scale: f64| {
                let at = eye_m * (f64::from(repeats_per_m) * scale);
                (at - at.floor()).as_vec3().extend(0.0).to_array()
            };
            (*layer, *near, *far) = (*rule, repeats(1.0), repeats(1.0 / FAR_TIMES));
        }
        uniform
    }
}

fn array(
    gpu: &Gpu,
    label: &str,
    format: wgpu::TextureFormat,
    layers: &[Vec<SurfaceTexture>],
    texels: impl Fn(&SurfaceTexture) -> &Vec<u8>,
) -> Result<wgpu::TextureView> {
    let levels = layers.first().map_or(&[][..], Vec::as_slice);
    let size = levels.first().map_or(1, |level| level.size);
    let texture = gpu.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: layers.len().max(1) as u32 },
        mip_level_count: levels.len().max(1) as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })?;
    for (layer, levels) in (0_u32..).zip(layers) {
        for (mip_level, level) in (0_u32..).zip(levels) {
            gpu.queue().write_texture(
                wgpu::TexelCopyTextureInfo {
                    texture: &texture,
                    mip_level,
                    origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
                    aspect: wgpu::TextureAspect::All,
                },
                texels(level),
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(level.size * 4),
                    rows_per_image: None,
                },
                wgpu::Extent3d { width: level.size, height: level.size, depth_or_array_layers: 1 },
            );
        }
    }
    Ok(texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..wgpu::TextureViewDescriptor::default()
    }))
}
