//! The textures of the shadow maps.

use orogeny_gpu::{Gpu, Result};

use super::targets::DEPTH_FORMAT;
use crate::shadow::MAX_CASCADES;

/// Depths from the sun, a layer a map.
#[derive(Debug)]
pub(super) struct ShadowMaps {
    pub(super) texels: u32,
    /// To be looked up.
    pub(super) all: wgpu::TextureView,
    /// To be drawn into.
    pub(super) layers: Vec<wgpu::TextureView>,
}

impl ShadowMaps {
    /// Maps of so many texels a side.
    pub(super) fn new(gpu: &Gpu, texels: u32) -> Result<Self> {
        let size =
            wgpu::Extent3d { width: texels, height: texels, depth_or_array_layers: MAX_CASCADES as u32 };
        let maps = gpu.create_texture(&wgpu::TextureDescriptor {
            label: Some("orogeny.shadow_maps"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        })?;
        let as_array = wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..wgpu::TextureViewDescriptor::default()
        };
        let layer = |layer: u32| {
            maps.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            })
        };
        Ok(Self {
            texels,
            all: maps.create_view(&as_array),
            layers: (0..MAX_CASCADES as u32).map(layer).collect(),
        })
    }
}
