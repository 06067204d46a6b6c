//! What filters make of the ground, block by block, on its way to the pages.

use orogeny_field::{PageKey, SampleRect};
use orogeny_pages::PageStore;

use super::planes::GpuPlane;
use super::{GpuExecutor, Shared};
use crate::execute::Watch;
use crate::filter::{self, Filter};
use crate::plan::Batch;
use crate::{Error, Result};

/// Samples that are worked out by one submission: a second or so of a weak GPU.
const STEP_SAMPLES: u64 = 1 << 26;

impl GpuExecutor {
    /// Works out what a filter makes of the ground under a batch, and applies it.
    pub(super) fn run_filter(
        &mut self,
        filter: &Filter,
        batch: &Batch,
        shared: &Shared,
        store: &mut dyn PageStore,
        watch: Watch<'_>,
    ) -> Result<()> {
        let blocks = filter::blocks(self.layout, &batch.pages, &filter.graph);
        // What is made of the ground as it is now is made for all blocks before it changes in any.
        let num_at_once = if filter.is_sequential { blocks.len().max(1) } else { 1 };
        for blocks in blocks.chunks(num_at_once) {
            let goals = blocks
                .iter()
                .map(|block| self.work_out(filter, batch, block.rect, store, watch))
                .collect::<Result<Vec<_>>>()?;
            for (block, goal) in blocks.iter().zip(goals) {
                self.apply(batch, &block.pages, shared, Some(&goal), store)?;
                self.planes.give_back(goal);
            }
        }
        Ok(())
    }

    /// Works out the goals of a rectangle.
    fn work_out(
        &mut self,
        filter: &Filter,
        batch: &Batch,
        rect: SampleRect,
        store: &mut dyn PageStore,
        watch: Watch<'_>,
    ) -> Result<GpuPlane> {
        let rects = filter.graph.plan(rect);
        let ground = rects.first().copied().unwrap_or(SampleRect::EMPTY);
        let keys: Vec<_> = (self.layout.pages_in(ground))
            .map(|(x, z)| PageKey::full_resolution(batch.pass.field, x, z))
            .collect();
        self.await_pages(&keys, store)?;
        let mut encoder = self.encoder();
        let heights = self.planes.plane(&self.gpu, ground, 1)?;
        self.gather(&mut encoder, &heights, &keys, filter.is_sequential, store)?;
        let num_nodes = rects.len();
        let nothing_made = heights.clone();
        let mut made = vec![Some(heights)];
        let mut work = 0;
        for (place, rect) in rects.iter().enumerate().skip(1) {
            let graph = (&*filter.graph, rects.as_slice());
            self.planes.record(&self.gpu, &mut encoder, graph, place, &mut made)?;
            work += rect.area();
            // In steps that no driver takes for hung, with a look in between at whether to go on.
            if work > STEP_SAMPLES {
                work = 0;
                self.submit(std::mem::replace(&mut encoder, self.encoder()))?;
                if !watch(place as f64 / num_nodes as f64) {
                    return Err(Error::Interrupted);
                }
            }
        }
        self.submit(encoder)?;
        // The last plane has no reader that could have taken it.
        Ok(made.pop().flatten().unwrap_or(nothing_made))
    }

    /// Records the copies of pages into a plane: from textures where they are resident in the state that is wanted, else from
    /// memory.
    fn gather(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        plane: &GpuPlane,
        keys: &[PageKey],
        wants_now: bool,
        store: &mut dyn PageStore,
    ) -> Result<()> {
        let mut rows = Vec::new();
        let mut places = Vec::new();
        for key in keys {
            let page_rect = self.layout.page_rect(key);
            let both = plane.rect.intersection(&page_rect);
            let is_now_wanted = wants_now || !self.changed.contains(key);
            let resident =
                if is_now_wanted { self.heights.texture(key) } else { self.scratch.before_texture(key) };
            let first = [both.x0.abs_diff(page_rect.x0), both.z0.abs_diff(page_rect.z0)];
            if let Some((texture, layer)) = resident {
                copy_from_texture(encoder, texture, layer, first, plane, &both);
                continue;
            }
            let loaded = if is_now_wanted { store.load(key) } else { store.load_before(key) };
            let loaded = loaded.map_err(orogeny_pages::Error::Source)?;
            let width = both.width() as usize;
            for z in both.z0..both.z1 {
                places.push((rows.len(), plane.offset(both.x0, z), width));
                let row = loaded
                    .as_ref()
                    .and_then(|page| page.row(z.abs_diff(page_rect.z0), first[0], first[0] + both.width()));
                match row {
                    Some(row) => rows.extend_from_slice(row),
                    None => rows.resize(rows.len() + width, store.constant(key.field)),
                }
            }
        }
        if rows.is_empty() {
            return Ok(());
        }
        let usage = wgpu::BufferUsages::COPY_SRC;
        let staging =
            self.gpu.create_buffer_with("orogeny.brush.ground", usage, bytemuck::cast_slice(&rows))?;
        for (place, offset, width) in places {
            let size = width as u64 * 4;
            encoder.copy_buffer_to_buffer(&staging, place as u64 * 4, &plane.buffer, offset, size);
        }
        Ok(())
    }
}

/// Records the copy of a part of a layer, which begins at `first`, to where it lies in a plane.
fn copy_from_texture(
    encoder: &mut wgpu::CommandEncoder,
    texture: &wgpu::Texture,
    layer: u32,
    first: [u32; 2],
    plane: &GpuPlane,
    rect: &SampleRect,
) {
    let [x, y] = first;
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x, y, z: layer },
            aspect: wgpu::TextureAspect::All,
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &plane.buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: plane.offset(rect.x0, rect.z0),
                bytes_per_row: Some(plane.stride * 4),
                rows_per_image: None,
            },
        },
        wgpu::Extent3d { width: rect.width(), height: rect.depth(), depth_or_array_layers: 1 },
    );
}
