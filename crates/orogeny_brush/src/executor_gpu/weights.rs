//! The weights of a whole stroke, worked out for a rectangle at once.

use orogeny_field::{Page, SampleRect};
use orogeny_pages::PageStore;

use super::goals::Rows;
use super::planes::GpuPlane;
use super::uniforms::{self, BrushUniform};
use super::{GpuExecutor, NO_FIELD, tiles_binding, workgroups};
use crate::Result;
use crate::filter::Weights;
use crate::filter::kernels::weights::STEM;
use crate::kernels::Rule;
use crate::plan::{Batch, Pass};
use crate::tiles::{PageLayers, TileList};

impl GpuExecutor {
    /// Records a plane of weights.
    pub(super) fn weights(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        rect: SampleRect,
        weights: &Weights,
        store: &mut dyn PageStore,
    ) -> Result<GpuPlane> {
        let plane = self.planes.plane(&self.gpu, rect, 1)?;
        encoder.clear_buffer(&plane.buffer, 0, None);
        // Cut into pages and tiles as a batch is, though what is written is no page.
        let reaching = weights.instances.iter().zip(&weights.bounds);
        let (instances, bounds) = reaching
            .map(|(instance, bound)| (*instance, bound.intersection(&rect)))
            .filter(|(_, bound)| !bound.is_empty())
            .unzip();
        let pass = Pass::new(Rule::Raise, weights.footprint.clone(), NO_FIELD);
        let batch = Batch::new(pass, self.layout, instances, bounds);
        let mut list = TileList::default();
        for work in &batch.pages {
            list.add_page(&batch, work, self.layout, PageLayers::default());
        }
        if list.tiles.is_empty() {
            return Ok(plane);
        }
        let gate = self.gate_of(encoder, &plane, weights, store)?;
        self.use_alpha(batch.pass.bitmap())?;
        let (uniform, storage) = (wgpu::BufferUsages::UNIFORM, wgpu::BufferUsages::STORAGE);
        let buffer = |usage, bytes: &[u8]| self.gpu.create_buffer_with("orogeny.brush.weights", usage, bytes);
        let brush = buffer(uniform, bytemuck::bytes_of(&BrushUniform::from(&batch.pass)))?;
        let curves = buffer(storage, bytemuck::cast_slice(&uniforms::curves(&batch.pass)))?;
        let instances = buffer(storage, bytemuck::cast_slice(&batch.instances))?;
        let tiles = buffer(storage, bytemuck::cast_slice(&list.tiles))?;
        let indices = buffer(storage, bytemuck::cast_slice(&list.indices))?;
        let place = buffer(uniform, bytemuck::bytes_of(&plane.uniform()))?;
        let no_gate = buffer(storage, &[0; 4])?;
        let resources = vec![
            brush.as_entire_binding(),
            wgpu::BindingResource::TextureView(self.alpha_view(batch.pass.bitmap())),
            curves.as_entire_binding(),
            instances.as_entire_binding(),
            tiles_binding(&tiles, &list),
            indices.as_entire_binding(),
            place.as_entire_binding(),
            gate.as_ref().map_or(&no_gate, |gate| &gate.buffer).as_entire_binding(),
            plane.buffer.as_entire_binding(),
        ];
        let is_gated = ("IS_GATED", u32::from(gate.is_some()));
        let constants: Vec<_> = uniforms::footprint_constants(&weights.footprint, &weights.instances)
            .into_iter()
            .chain([is_gated])
            .collect();
        let kernel = self.gpu.kernel(STEM, &constants)?;
        kernel.record(&self.gpu, encoder, STEM, resources, workgroups(&self.gpu, &list));
        if let Some(gate) = gate {
            self.planes.give_back(gate);
        }
        Ok(plane)
    }

    /// Records a plane of what the gate lets through; `None` where there is no gate.
    fn gate_of(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        like: &GpuPlane,
        weights: &Weights,
        store: &mut dyn PageStore,
    ) -> Result<Option<GpuPlane>> {
        if weights.gate.is_none() {
            return Ok(None);
        }
        let pages = weights.pages_let_through(&like.rect, store)?;
        self.plane_of_pages(encoder, like.rect, &pages).map(Some)
    }

    /// Records a plane of what pages have of it.
    pub(super) fn plane_of_pages(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        rect: SampleRect,
        pages: &[(SampleRect, Page)],
    ) -> Result<GpuPlane> {
        let plane = self.planes.plane(&self.gpu, rect, 1)?;
        let mut rows = Rows::default();
        for (page_rect, page) in pages {
            let both = page_rect.intersection(&rect);
            let (x0, x1) = (both.x0.abs_diff(page_rect.x0), both.x1.abs_diff(page_rect.x0));
            for z in both.z0..both.z1 {
                let row = page.row(z.abs_diff(page_rect.z0), x0, x1).unwrap_or_default();
                rows.add(&plane, both.x0, z, row.iter().copied());
            }
        }
        rows.record(&self.gpu, encoder, &plane)?;
        Ok(plane)
    }
}
