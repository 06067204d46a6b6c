//! The slots of a page cache on the GPU: layers of `R32Float` texture arrays.

use orogeny_field::PageLayout;
use orogeny_gpu::Gpu;

use crate::{Error, Result};

/// The most slots of an atlas, whatever the budget: 256 GiB of pages of 256 x 256 samples.
const MAX_SLOTS: u32 = 1 << 20;

/// A layer of one of the atlas's arrays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Slot {
    /// Which array.
    pub array: u32,
    /// Which layer of it.
    pub layer: u32,
}

/// How large an atlas may grow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AtlasLimits {
    /// Bytes of texture memory.
    pub budget_in_bytes: u64,
    /// Layers of one array, where the budget allows; at most the device's limit. Arrays are made when first needed.
    pub layers_per_array: u32,
}

/// Texture arrays whose layers are page slots. Slots are numbered from the start; the textures are made when they are first
/// asked for, so that a large budget costs nothing until it is used.
#[derive(Debug)]
pub struct Atlas {
    label: String,
    layout: PageLayout,
    layers_per_array: u32,
    num_slots: u32,
    arrays: Vec<Array>,
}

#[derive(Debug)]
struct Array {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Atlas {
    /// An atlas with room for as many pages as the limits allow, at least `needed`.
    ///
    /// # Errors
    /// [`Error::Budget`] when the budget holds fewer than `needed` pages.
    pub fn new(gpu: &Gpu, label: &str, layout: PageLayout, limits: AtlasLimits, needed: u32) -> Result<Self> {
        let num_pages = limits.budget_in_bytes / layout.size_in_bytes();
        if num_pages < u64::from(needed) {
            let budget_in_bytes = limits.budget_in_bytes;
            return Err(Error::Budget { budget_in_bytes, num_pages, needed: u64::from(needed) });
        }
        let num_slots = u32::try_from(num_pages).unwrap_or(MAX_SLOTS).min(MAX_SLOTS);
        let device_limit = gpu.device().limits().max_texture_array_layers;
        let layers_per_array = limits.layers_per_array.clamp(1, device_limit).min(num_slots);
        Ok(Self { label: label.to_owned(), layout, layers_per_array, num_slots, arrays: Vec::new() })
    }

    /// All slots, in such an order that a [`crate::Residency`] hands out the first array's first.
    #[must_use]
    pub fn slots(&self) -> Vec<Slot> {
        let slot =
            |index: u32| Slot { array: index / self.layers_per_array, layer: index % self.layers_per_array };
        (0..self.num_slots).rev().map(slot).collect()
    }

    /// Makes sure that the array of a slot exists.
    ///
    /// # Errors
    /// [`Error::Gpu`] when there is no memory for it.
    pub fn prepare(&mut self, gpu: &Gpu, slot: Slot) -> Result<()> {
        while self.arrays.len() <= slot.array as usize {
            let index = self.arrays.len() as u32;
            let layers = self.layers_per_array.min(self.num_slots - index * self.layers_per_array);
            let texture = gpu.create_texture(&wgpu::TextureDescriptor {
                label: Some(&format!("orogeny.pages.{}[{index}]", self.label)),
                size: wgpu::Extent3d {
                    width: self.layout.size(),
                    height: self.layout.size(),
                    depth_or_array_layers: layers,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::R32Float,
                usage: wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC
                    | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            })?;
            let view = texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..wgpu::TextureViewDescriptor::default()
            });
            self.arrays.push(Array { texture, view });
        }
        Ok(())
    }

    /// Gives up the slots whose texture does not exist: there is no memory for it.
    pub fn shrink_to_existing(&mut self) {
        self.num_slots = self.arrays.iter().map(|array| array.texture.depth_or_array_layers()).sum();
    }

    /// Whether a slot belongs to the atlas, as far as it has shrunk.
    #[must_use]
    pub const fn has(&self, slot: Slot) -> bool {
        (slot.array as u64 * self.layers_per_array as u64 + slot.layer as u64) < self.num_slots as u64
    }

    /// The texture of an array that was [`prepare`](Self::prepare)d.
    #[must_use]
    pub fn texture(&self, array: u32) -> Option<&wgpu::Texture> {
        self.arrays.get(array as usize).map(|array| &array.texture)
    }

    /// The view of all layers of an array that was [`prepare`](Self::prepare)d.
    #[must_use]
    pub fn view(&self, array: u32) -> Option<&wgpu::TextureView> {
        self.arrays.get(array as usize).map(|array| &array.view)
    }

    /// Slots, whether their texture exists or not.
    #[must_use]
    pub const fn num_slots(&self) -> u32 {
        self.num_slots
    }

    /// Bytes of the textures that exist.
    #[must_use]
    pub fn size_in_bytes(&self) -> u64 {
        let layers = |array: &Array| u64::from(array.texture.depth_or_array_layers());
        self.arrays.iter().map(layers).sum::<u64>() * self.layout.size_in_bytes()
    }
}
