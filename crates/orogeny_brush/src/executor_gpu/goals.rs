//! What filters make of the ground, block by block, on its way to the pages.

use orogeny_field::{FieldId, PageKey, Plane, SampleRect};
use orogeny_gpu::Gpu;
use orogeny_pages::PageStore;

use super::planes::{GpuPlane, GpuPlanes};
use super::{GpuExecutor, Shared};
use crate::execute::Watch;
use crate::filter::region::load_before;
use crate::filter::{self, Filter, Step};
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
        // Where nothing of it is known yet, no page of the operation has changed.
        let load = |field, rect| load_before(field, rect, store);
        self.regions.work_out(&filter.graph, None, load, watch)?;
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
        let graph = &*filter.graph;
        let rects = graph.plan(rect);
        let num_nodes = rects.len();
        let mut encoder = self.encoder();
        let mut made = Vec::with_capacity(num_nodes);
        let mut work = 0;
        for (place, (node, rect)) in graph.nodes().iter().zip(&rects).enumerate() {
            let plane = match &node.step {
                Step::Heights => {
                    let field = batch.pass.field;
                    self.ground(&mut encoder, *rect, field, filter.is_sequential, store)?
                }
                Step::Field(field) => self.ground(&mut encoder, *rect, *field, false, store)?,
                Step::Raster(raster) => {
                    rows_of(&self.gpu, &mut self.planes, &mut encoder, *rect, Some(raster))?
                }
                Step::Region(kernel) => {
                    let region = self.regions.plane(kernel);
                    rows_of(&self.gpu, &mut self.planes, &mut encoder, *rect, region)?
                }
                Step::Gate(gate) => {
                    let pages = gate.pages(rect, store)?;
                    self.plane_of_pages(&mut encoder, *rect, &pages)?
                }
                Step::Weights(weights) => self.weights(&mut encoder, *rect, weights, store)?,
                _ => self.planes.record(&self.gpu, &mut encoder, graph, place, *rect, &made)?,
            };
            made.push(Some(plane));
            // What no later plane is made of gives its memory back.
            for input in graph.done_with(place) {
                if let Some(plane) = made.get_mut(input).and_then(Option::take) {
                    self.planes.give_back(plane);
                }
            }
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
        match made.pop().flatten() {
            // It has no reader that could have taken it.
            Some(last) => Ok(last),
            None => self.planes.plane(&self.gpu, SampleRect::EMPTY, 1),
        }
    }

    /// The pages of a field that a rectangle is cut into.
    pub(super) fn keys_in(&self, field: FieldId, rect: SampleRect) -> impl Iterator<Item = PageKey> + use<> {
        self.layout.pages_in(rect).map(move |(x, z)| PageKey::full_resolution(field, x, z))
    }

    /// Records a plane of the ground, as it is now or as it was before the operation: copies from textures where pages are
    /// resident in that state, else from memory.
    pub(super) fn ground(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        rect: SampleRect,
        field: FieldId,
        wants_now: bool,
        store: &mut dyn PageStore,
    ) -> Result<GpuPlane> {
        let plane = self.planes.plane(&self.gpu, rect, 1)?;
        let keys: Vec<_> = self.keys_in(field, rect).collect();
        self.await_pages(&keys, store)?;
        let mut rows = Rows::default();
        for key in &keys {
            let page_rect = self.layout.page_rect(key);
            let both = plane.rect.intersection(&page_rect);
            let is_now_wanted = wants_now || !self.changed.contains(key);
            let resident =
                if is_now_wanted { self.heights.texture(key) } else { self.scratch.before_texture(key) };
            let first = [both.x0.abs_diff(page_rect.x0), both.z0.abs_diff(page_rect.z0)];
            if let Some((texture, layer)) = resident {
                copy_from_texture(encoder, texture, layer, first, &plane, &both);
                continue;
            }
            let loaded = if is_now_wanted { store.load(key) } else { store.load_before(key) };
            let loaded = loaded.map_err(orogeny_pages::Error::Source)?;
            for z in both.z0..both.z1 {
                let row = loaded
                    .as_ref()
                    .and_then(|page| page.row(z.abs_diff(page_rect.z0), first[0], first[0] + both.width()));
                match row {
                    Some(row) => rows.add(&plane, both.x0, z, row.iter().copied()),
                    None => {
                        let constant = store.constant(key.field);
                        rows.add(&plane, both.x0, z, std::iter::repeat_n(constant, both.width() as usize));
                    }
                }
            }
        }
        rows.record(&self.gpu, encoder, &plane)?;
        Ok(plane)
    }
}

/// Records a plane of what another on the CPU has of it.
fn rows_of(
    gpu: &Gpu,
    planes: &mut GpuPlanes,
    encoder: &mut wgpu::CommandEncoder,
    rect: SampleRect,
    source: Option<&Plane>,
) -> Result<GpuPlane> {
    let plane = planes.plane(gpu, rect, 1)?;
    let mut rows = Rows::default();
    for z in rect.z0..rect.z1 {
        let row = source.and_then(|source| {
            let first = rect.x0.abs_diff(source.rect().x0) as usize;
            source.row(z)?.get(first..first + rect.width() as usize)
        });
        rows.add(&plane, rect.x0, z, row.unwrap_or_default().iter().copied());
    }
    rows.record(gpu, encoder, &plane)?;
    Ok(plane)
}

/// Rows on their way into a plane, as one buffer and a copy for each.
#[derive(Default)]
pub(super) struct Rows {
    values: Vec<f32>,
    /// Where each lies here, where in the plane in bytes, and how many values it has.
    places: Vec<(usize, u64, usize)>,
}

impl Rows {
    pub(super) fn add(&mut self, plane: &GpuPlane, x: i32, z: i32, row: impl Iterator<Item = f32>) {
        let first = self.values.len();
        self.values.extend(row);
        self.places.push((first, plane.offset(x, z), self.values.len() - first));
    }

    pub(super) fn record(
        self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        plane: &GpuPlane,
    ) -> Result<()> {
        if self.values.is_empty() {
            return Ok(());
        }
        let usage = wgpu::BufferUsages::COPY_SRC;
        let staging =
            gpu.create_buffer_with("orogeny.brush.ground", usage, bytemuck::cast_slice(&self.values))?;
        for (first, offset, length) in self.places {
            let size = length as u64 * 4;
            encoder.copy_buffer_to_buffer(&staging, first as u64 * 4, &plane.buffer, offset, size);
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
