//! The slots of pages that pictures are drawn from: squares of a texture array, four bytes a sample.

use orogeny_field::PageLayout;
use orogeny_gpu::{DevicePlane, Gpu, Result};

/// Samples a side of a layer: 8 x 8 pages of 256.
const LAYER_SIDE: u32 = 2048;

/// Four bytes a sample, in as many slots as fit a budget.
#[derive(Debug)]
pub(super) struct PageTexture {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    layout: PageLayout,
    num_slots: u32,
}

impl PageTexture {
    /// With room for `num_slots` pages, rounded down to whole layers, but at least one layer, and no more than hold `num_needed`. `label` is for
    /// debuggers.
    pub(super) fn new(
        gpu: &Gpu,
        label: &str,
        format: wgpu::TextureFormat,
        layout: PageLayout,
        num_slots: u32,
        num_needed: u32,
    ) -> Result<Self> {
        let slots_a_side = Self::slots_a_side(layout);
        let slots_a_layer = slots_a_side * slots_a_side;
        let max_layers =
            gpu.device().limits().max_texture_array_layers.min(num_needed.div_ceil(slots_a_layer));
        let num_layers = (num_slots / slots_a_layer).clamp(1, max_layers.max(1));
        let side = slots_a_side * layout.size();
        Self::of_size(gpu, label, format, layout, [side, side, num_layers], num_layers * slots_a_layer)
    }

    /// To be bound where there are no pages.
    pub(super) fn none(
        gpu: &Gpu,
        label: &str,
        format: wgpu::TextureFormat,
        layout: PageLayout,
    ) -> Result<Self> {
        Self::of_size(gpu, label, format, layout, [1, 1, 1], 0)
    }

    fn of_size(
        gpu: &Gpu,
        label: &str,
        format: wgpu::TextureFormat,
        layout: PageLayout,
        [width, height, depth_or_array_layers]: [u32; 3],
        num_slots: u32,
    ) -> Result<Self> {
        let texture = gpu.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })?;
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..wgpu::TextureViewDescriptor::default()
        });
        Ok(Self { texture, view, layout, num_slots })
    }

    /// Pages a side of a layer, a power of two.
    pub(super) fn slots_a_side(layout: PageLayout) -> u32 {
        (LAYER_SIDE / layout.size()).max(1)
    }

    pub(super) const fn num_slots(&self) -> u32 {
        self.num_slots
    }

    pub(super) fn format(&self) -> wgpu::TextureFormat {
        self.texture.format()
    }

    pub(super) const fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Copies a page into a slot, before whatever is submitted next.
    pub(super) fn write(&self, gpu: &Gpu, slot: u32, samples: &[u8]) {
        self.write_part(gpu, slot, samples, [0, 0], [self.layout.size(); 2]);
    }

    /// Copies a part of a page, which is given whole: so many samples from a first one on.
    pub(super) fn write_part(
        &self,
        gpu: &Gpu,
        slot: u32,
        samples: &[u8],
        [x, z]: [u32; 2],
        [width, depth]: [u32; 2],
    ) {
        let size = self.layout.size();
        gpu.queue().write_texture(
            self.place(slot, [x, z]),
            samples,
            wgpu::TexelCopyBufferLayout {
                offset: u64::from(z * size + x) * 4,
                bytes_per_row: Some(size * 4),
                rows_per_image: None,
            },
            wgpu::Extent3d { width, height: depth, depth_or_array_layers: 1 },
        );
    }

    /// Records the copy of so many samples from a place in a plane on.
    pub(super) fn copy_part(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        slot: u32,
        plane: &DevicePlane,
        offset: u64,
        first: [u32; 2],
        [width, height]: [u32; 2],
    ) {
        let layout = wgpu::TexelCopyBufferLayout {
            offset,
            bytes_per_row: Some(plane.stride * 4),
            rows_per_image: None,
        };
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo { buffer: &plane.buffer, layout },
            self.place(slot, first),
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
    }

    /// Where a sample of a slot lies.
    fn place(&self, slot: u32, [x, z]: [u32; 2]) -> wgpu::TexelCopyTextureInfo<'_> {
        let (size, slots_a_side) = (self.layout.size(), Self::slots_a_side(self.layout));
        let slots_a_layer = slots_a_side * slots_a_side;
        let cell = slot % slots_a_layer;
        wgpu::TexelCopyTextureInfo {
            texture: &self.texture,
            mip_level: 0,
            origin: wgpu::Origin3d {
                x: cell % slots_a_side * size + x,
                y: cell / slots_a_side * size + z,
                z: slot / slots_a_layer,
            },
            aspect: wgpu::TextureAspect::All,
        }
    }
}
