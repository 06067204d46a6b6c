//! Pages on the GPU: the heights, what a wash keeps beside them, and what gates let through.

use orogeny_field::{Bitmap, Page, PageKey, PageLayout};
use orogeny_gpu::{Gpu, ReadbackBelt};
use orogeny_pages::{Admitted, Atlas, AtlasLimits, BoxError, PageStore, Residency, Slot};

use super::ReadbackTag;
use crate::gate::GatePlan;
use crate::plan::PageWork;
use crate::spill::Spill;
use crate::{Error, Result};

/// Whether the pages of a step could all be given a slot.
pub(super) enum Resident {
    /// They were, and their uploads are recorded.
    All,
    /// There is no memory for a further texture array. Those that were already resident still are; what made room is on its
    /// way back, so the encoder is to be submitted.
    TextureMemoryShort(orogeny_pages::Error),
}

/// The heights of pages.
#[derive(Debug)]
pub(super) struct Heights {
    layout: PageLayout,
    atlas: Atlas,
    residency: Residency<Slot>,
}

impl Heights {
    pub(super) fn new(gpu: &Gpu, layout: PageLayout, limits: AtlasLimits) -> Result<Self> {
        let atlas = Atlas::new(gpu, "heights", layout, limits, 1)?;
        let residency = Residency::new(atlas.slots());
        Ok(Self { layout, atlas, residency })
    }

    /// Makes the pages of a step resident. Changed pages that make room are read back before they are overwritten.
    pub(super) fn make_resident(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        belt: &mut ReadbackBelt<ReadbackTag>,
        works: &[PageWork],
        store: &mut dyn PageStore,
    ) -> Result<Resident> {
        let mut uploads = Uploads::new(self.layout);
        let mut admitted = Vec::new();
        for key in absent(&mut self.residency, works) {
            let Some(Admitted { slot, evicted }) = self.residency.admit(key) else { continue };
            admitted.push(key);
            if let Err(err) = self.atlas.prepare(gpu, slot) {
                admitted.iter().for_each(|key| self.residency.forget(key));
                return Ok(Resident::TextureMemoryShort(err));
            }
            if let Some(evicted) = evicted.filter(|evicted| evicted.is_dirty) {
                self.schedule_readback(encoder, belt, evicted.key, slot)?;
            }
            uploads.add_or_constant(store.load(&key), store.constant(key.field), slot)?;
        }
        uploads.record(gpu, encoder, &self.atlas)?;
        Ok(Resident::All)
    }

    /// Gives up the slots whose texture was never made; whether there were any.
    pub(super) fn shrink_to_existing(&mut self) -> bool {
        let num_slots = self.atlas.num_slots();
        self.atlas.shrink_to_existing();
        self.residency.retain_free(|slot| self.atlas.has(slot));
        self.atlas.num_slots() < num_slots
    }

    pub(super) fn schedule_readback(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        belt: &mut ReadbackBelt<ReadbackTag>,
        key: PageKey,
        slot: Slot,
    ) -> Result<()> {
        if let Some(texture) = self.atlas.texture(slot.array) {
            belt.schedule(encoder, texture, slot.layer, ReadbackTag::Heights(key))?;
        }
        Ok(())
    }

    pub(super) fn slot(&self, key: &PageKey) -> Option<Slot> {
        self.residency.slot(key)
    }

    /// The texture array and the layer of a resident page.
    pub(super) fn texture(&self, key: &PageKey) -> Option<(&wgpu::Texture, u32)> {
        let slot = self.residency.slot(key)?;
        Some((self.atlas.texture(slot.array)?, slot.layer))
    }

    pub(super) fn mark_dirty(&mut self, key: &PageKey) {
        self.residency.mark_dirty(key);
    }

    pub(super) fn take_dirty(&mut self) -> Vec<(PageKey, Slot)> {
        self.residency.take_dirty()
    }

    pub(super) fn forget(&mut self, key: &PageKey) {
        self.residency.forget(key);
    }

    pub(super) fn forget_all(&mut self) {
        self.residency.forget_all();
    }

    pub(super) fn view(&self, array: u32) -> Option<&wgpu::TextureView> {
        self.atlas.view(array)
    }

    pub(super) fn num_slots(&self) -> usize {
        self.atlas.num_slots() as usize
    }

    pub(super) fn size_in_bytes(&self) -> u64 {
        self.atlas.size_in_bytes()
    }
}

/// What a wash keeps beside its pages: the heights from before the stroke and the weights so far. Both lie in the same slots
/// of two atlases, apart from the heights, so that no dispatch has one texture as source and target.
#[derive(Debug)]
pub(super) struct Scratch {
    layout: PageLayout,
    before: Atlas,
    weights: Atlas,
    residency: Residency<Slot>,
    spilled_weights: Spill,
    /// One texel each, bound where there is no wash.
    unused: [wgpu::TextureView; 2],
}

impl Scratch {
    pub(super) fn new(gpu: &Gpu, layout: PageLayout, limits: AtlasLimits) -> Result<Self> {
        let before = Atlas::new(gpu, "before", layout, limits, 1)?;
        let weights = Atlas::new(gpu, "weights", layout, limits, 1)?;
        let residency = Residency::new(before.slots());
        let unused = [unused_view(gpu)?, unused_view(gpu)?];
        Ok(Self { layout, before, weights, residency, spilled_weights: Spill::new(layout), unused })
    }

    pub(super) fn make_resident(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        belt: &mut ReadbackBelt<ReadbackTag>,
        works: &[PageWork],
        store: &mut dyn PageStore,
    ) -> Result<Resident> {
        let mut before = Uploads::new(self.layout);
        let mut weights = Uploads::new(self.layout);
        let mut admitted = Vec::new();
        for key in absent(&mut self.residency, works) {
            let Some(Admitted { slot, evicted }) = self.residency.admit(key) else { continue };
            admitted.push(key);
            if let Err(err) = self.before.prepare(gpu, slot).and_then(|()| self.weights.prepare(gpu, slot)) {
                admitted.iter().for_each(|key| self.residency.forget(key));
                return Ok(Resident::TextureMemoryShort(err));
            }
            // Weights change with every batch that touches their page: there are no clean ones.
            if let (Some(evicted), Some(texture)) = (evicted, self.weights.texture(slot.array)) {
                belt.schedule(encoder, texture, slot.layer, ReadbackTag::Weights(evicted.key))?;
            }
            before.add_or_constant(store.load_before(&key), store.constant(key.field), slot)?;
            weights.add_or_constant(Ok(self.spilled_weights.take(&key)?), 0.0, slot)?;
        }
        before.record(gpu, encoder, &self.before)?;
        weights.record(gpu, encoder, &self.weights)?;
        Ok(Resident::All)
    }

    /// Makes the roughness of a noise resident, which has no wash, where a wash has its heights from before. It is worked out
    /// anew where it had to make room.
    pub(super) fn make_rough(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        works: &[PageWork],
        roughness: &GatePlan,
        store: &mut dyn PageStore,
    ) -> Result<Resident> {
        upload_weights(
            self.layout,
            &mut self.before,
            &mut self.residency,
            gpu,
            encoder,
            works,
            roughness,
            store,
        )
    }

    /// Gives up the slots whose textures were never made; whether there were any.
    pub(super) fn shrink_to_existing(&mut self) -> bool {
        let num_slots = self.num_slots();
        self.before.shrink_to_existing();
        self.weights.shrink_to_existing();
        self.residency.retain_free(|slot| self.before.has(slot) && self.weights.has(slot));
        self.num_slots() < num_slots
    }

    pub(super) fn slot(&self, key: &PageKey) -> Option<Slot> {
        self.residency.slot(key)
    }

    /// The texture array and the layer of the heights from before of a resident page.
    pub(super) fn before_texture(&self, key: &PageKey) -> Option<(&wgpu::Texture, u32)> {
        let slot = self.residency.slot(key)?;
        Some((self.before.texture(slot.array)?, slot.layer))
    }

    pub(super) fn keep_weights(&mut self, key: PageKey, weights: &Page) -> Result<()> {
        self.spilled_weights.put(key, weights)
    }

    /// The stroke is over.
    pub(super) fn forget_all(&mut self) {
        self.residency.forget_all();
        self.spilled_weights.clear();
    }

    /// The heights from before and the weights; textures of one texel where an array was never needed.
    pub(super) fn views(&self, array: u32) -> (&wgpu::TextureView, &wgpu::TextureView) {
        let [unused_before, unused_weights] = &self.unused;
        let before = self.before.view(array).unwrap_or(unused_before);
        (before, self.weights.view(array).unwrap_or(unused_weights))
    }

    pub(super) fn num_slots(&self) -> usize {
        self.before.num_slots().min(self.weights.num_slots()) as usize
    }

    pub(super) fn size_in_bytes(&self) -> u64 {
        self.before.size_in_bytes() + self.weights.size_in_bytes()
    }
}

/// What gates let through on pages: worked out anew where it had to make room.
#[derive(Debug)]
pub(super) struct Gates {
    layout: PageLayout,
    atlas: Atlas,
    residency: Residency<Slot>,
    /// One texel, bound where there is no gate.
    unused: wgpu::TextureView,
}

impl Gates {
    pub(super) fn new(gpu: &Gpu, layout: PageLayout, limits: AtlasLimits) -> Result<Self> {
        let atlas = Atlas::new(gpu, "gates", layout, limits, 1)?;
        let residency = Residency::new(atlas.slots());
        Ok(Self { layout, atlas, residency, unused: unused_view(gpu)? })
    }

    pub(super) fn make_resident(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        works: &[PageWork],
        gate: &GatePlan,
        store: &mut dyn PageStore,
    ) -> Result<Resident> {
        upload_weights(self.layout, &mut self.atlas, &mut self.residency, gpu, encoder, works, gate, store)
    }

    /// Gives up the slots whose texture was never made; whether there were any.
    pub(super) fn shrink_to_existing(&mut self) -> bool {
        let num_slots = self.atlas.num_slots();
        self.atlas.shrink_to_existing();
        self.residency.retain_free(|slot| self.atlas.has(slot));
        self.atlas.num_slots() < num_slots
    }

    pub(super) fn slot(&self, key: &PageKey) -> Option<Slot> {
        self.residency.slot(key)
    }

    /// The stroke is over.
    pub(super) fn forget_all(&mut self) {
        self.residency.forget_all();
    }

    /// The gates of an array; a texture of one texel where it was never needed.
    pub(super) fn view(&self, array: u32) -> &wgpu::TextureView {
        self.atlas.view(array).unwrap_or(&self.unused)
    }

    pub(super) fn num_slots(&self) -> usize {
        self.atlas.num_slots() as usize
    }

    pub(super) fn size_in_bytes(&self) -> u64 {
        self.atlas.size_in_bytes()
    }
}

/// Makes the weights of gates resident in an atlas. What makes room is dropped: it is worked out anew when it is needed.
#[expect(clippy::too_many_arguments, reason = "an atlas and its residency are fields of what calls it")]
fn upload_weights(
    layout: PageLayout,
    atlas: &mut Atlas,
    residency: &mut Residency<Slot>,
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    works: &[PageWork],
    gate: &GatePlan,
    store: &mut dyn PageStore,
) -> Result<Resident> {
    let mut uploads = Uploads::new(layout);
    let mut admitted = Vec::new();
    for key in absent(residency, works) {
        let Some(Admitted { slot, .. }) = residency.admit(key) else { continue };
        admitted.push(key);
        if let Err(err) = atlas.prepare(gpu, slot) {
            admitted.iter().for_each(|key| residency.forget(key));
            return Ok(Resident::TextureMemoryShort(err));
        }
        let input = gate.load(&key, store)?;
        uploads.add_or_constant(Ok(Some(gate.page(&key, layout, &input))), 1.0, slot)?;
    }
    uploads.record(gpu, encoder, atlas)?;
    Ok(Resident::All)
}

/// A bitmap as a texture.
pub(super) fn bitmap_view(gpu: &Gpu, bitmap: &Bitmap) -> Result<wgpu::TextureView> {
    let (width, height) = (bitmap.width(), bitmap.height());
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = gpu.create_texture(&wgpu::TextureDescriptor {
        label: Some("orogeny.brush.alpha"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })?;
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 4), rows_per_image: None };
    gpu.queue().write_texture(texture.as_image_copy(), bytemuck::cast_slice(bitmap.values()), layout, size);
    Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
}

/// Uses the resident pages of a step, so that none of them makes room for another, and gives those that are not.
fn absent(residency: &mut Residency<Slot>, works: &[PageWork]) -> Vec<PageKey> {
    works.iter().map(|work| work.key).filter(|key| residency.touch(key).is_none()).collect()
}

fn unused_view(gpu: &Gpu) -> Result<wgpu::TextureView> {
    let texture = gpu.create_texture(&wgpu::TextureDescriptor {
        label: Some("orogeny.brush.unused"),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })?;
    Ok(texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..wgpu::TextureViewDescriptor::default()
    }))
}

/// Pages on their way into an atlas, as one buffer and a copy for each.
struct Uploads {
    layout: PageLayout,
    samples: Vec<f32>,
    slots: Vec<Slot>,
}

impl Uploads {
    const fn new(layout: PageLayout) -> Self {
        Self { layout, samples: Vec::new(), slots: Vec::new() }
    }

    fn add_or_constant(
        &mut self,
        page: Result<Option<Page>, BoxError>,
        constant: f32,
        slot: Slot,
    ) -> Result<()> {
        match page.map_err(orogeny_pages::Error::Source)? {
            Some(page) if page.size() != self.layout.size() => {
                return Err(Error::PageSize { expected: self.layout.size(), actual: page.size() });
            }
            Some(page) => self.samples.extend_from_slice(page.samples()),
            None => self.samples.resize(self.samples.len() + self.layout.num_samples(), constant),
        }
        self.slots.push(slot);
        Ok(())
    }

    fn record(self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, atlas: &Atlas) -> Result<()> {
        if self.slots.is_empty() {
            return Ok(());
        }
        let bytes = bytemuck::cast_slice(&self.samples);
        let buffer = gpu.create_buffer_with("orogeny.brush.uploads", wgpu::BufferUsages::COPY_SRC, bytes)?;
        let size = self.layout.size();
        for (offset, slot) in (0..).step_by(self.layout.size_in_bytes() as usize).zip(&self.slots) {
            let Some(texture) = atlas.texture(slot.array) else { continue };
            let layout =
                wgpu::TexelCopyBufferLayout { offset, bytes_per_row: Some(size * 4), rows_per_image: None };
            encoder.copy_buffer_to_texture(
                wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
                wgpu::TexelCopyTextureInfo {
                    texture,
                    mip_level: 0,
                    origin: wgpu::Origin3d { x: 0, y: 0, z: slot.layer },
                    aspect: wgpu::TextureAspect::All,
                },
                wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
            );
        }
        Ok(())
    }
}
