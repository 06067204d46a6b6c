//! The pages that pictures are drawn from: taken, changed in part, forgotten.

use orogeny_field::Page;
use orogeny_gpu::{DevicePlane, Result};

use super::page_texture::PageTexture;
use super::{Overlay, Renderer};
use crate::{Holder, PagePlace};

impl Renderer {
    /// Takes a page that was wanted: heights, and what lies over them. One for which there is no room is left out. Where another kind lies over
    /// it than over those before, theirs is gone: they are to be [forgotten](Self::forget), or taken again.
    ///
    /// # Errors
    /// When there is no memory for the overlay.
    pub fn upload(&mut self, place: PagePlace, heights: &Page, overlay: Option<Overlay<'_>>) -> Result<()> {
        let Some(slot) = self.slots.admit(place) else { return Ok(()) };
        self.heights.write(&self.gpu, slot, bytemuck::cast_slice(heights.samples()));
        self.uploaded_bytes += self.layout.size_in_bytes();
        if let Some(overlay) = overlay {
            let (format, samples): (_, &[u8]) = match overlay {
                Overlay::Masks(masks) => (wgpu::TextureFormat::Rgba8Unorm, bytemuck::cast_slice(masks)),
                Overlay::Difference(higher_m) => {
                    (wgpu::TextureFormat::R32Float, bytemuck::cast_slice(higher_m))
                }
            };
            let num_slots = self.heights.num_slots();
            if self.overlay.num_slots() < num_slots || self.overlay.format() != format {
                let label = "orogeny.drawn.overlay";
                self.overlay = PageTexture::new(&self.gpu, label, format, self.layout, num_slots, num_slots)?;
            }
            self.overlay.write(&self.gpu, slot, samples);
            self.uploaded_bytes += samples.len() as u64;
        }
        if self.active.insert(place, Holder::Slot(slot)).is_none() {
            self.num_missing = self.num_missing.saturating_sub(1);
        }
        Ok(())
    }

    /// Has nothing lie over the pages that are there.
    ///
    /// # Errors
    /// When there is no memory even for that.
    pub fn forget_overlay(&mut self) -> Result<()> {
        let (label, format) = ("orogeny.no_overlay", wgpu::TextureFormat::R32Float);
        self.overlay = PageTexture::none(&self.gpu, label, format, self.layout)?;
        Ok(())
    }

    /// Takes a part of a page that is there and has changed: so many samples from a first one on, of its heights as they are now. Nothing
    /// happens where the page is not there, or has no such part.
    pub fn upload_part(&mut self, place: PagePlace, heights: &Page, first: [u32; 2], num: [u32; 2]) {
        let size = self.layout.size();
        let is_in_page = first.iter().zip(num).all(|(first, num)| num > 0 && first + num <= size);
        if let Some(slot) = self.slots.slot(place).filter(|_| is_in_page && heights.size() == size) {
            self.heights.write_part(&self.gpu, slot, bytemuck::cast_slice(heights.samples()), first, num);
            self.uploaded_bytes += u64::from(num[0]) * u64::from(num[1]) * 4;
        }
    }

    /// Takes parts of pages that are there and have changed from where they lie on this device: of each page so many samples from a first one on.
    /// What is not there, in the page or in the plane, is left out.
    pub fn copy_parts(&mut self, parts: &[(PagePlace, [u32; 2], [u32; 2], &DevicePlane)]) {
        if parts.is_empty() {
            return;
        }
        let label = Some("orogeny.drawn.parts");
        let mut encoder = self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        for (place, first, num, plane) in parts {
            let size = self.layout.size();
            let [x, z] = [place.x * size + first[0], place.z * size + first[1]].map(u32::cast_signed);
            if let (Some(slot), Some(offset)) = (self.slots.slot(*place), plane.offset([x, z], *num)) {
                self.heights.copy_part(&mut encoder, slot, plane, offset, *first, *num);
            }
        }
        self.gpu.queue().submit([encoder.finish()]);
    }

    /// Bytes of pages, and of what lies over them, that went from memory to the device so far.
    #[must_use]
    pub const fn uploaded_bytes(&self) -> u64 {
        self.uploaded_bytes
    }

    /// Whether a page is there.
    #[must_use]
    pub fn holds(&self, place: PagePlace) -> bool {
        self.slots.slot(place).is_some()
    }

    /// Whether the next picture is drawn from a page, where it is in sight.
    #[must_use]
    pub fn is_shown(&self, place: PagePlace) -> bool {
        self.active.contains_key(&place)
    }

    /// Forgets pages whose heights are no longer so.
    pub fn forget(&mut self, is_forgotten: impl Fn(&PagePlace) -> bool) {
        self.active.retain(|place, _| !is_forgotten(place));
        self.slots.forget(is_forgotten);
    }
}
