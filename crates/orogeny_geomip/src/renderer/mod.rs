//! Draws a terrain: shadow maps, ground, sky, water, and what a screen shows of their light.
//!
//! A frame in order: [`Renderer::want`] says which pages the picture lacks; whoever has them [`upload`](Renderer::upload)s some;
//! [`Renderer::draw`] draws from what is there. So no frame waits for a page.

mod materials;
mod page_texture;
mod pages;
mod pipelines;
mod scene;
mod shadow_maps;
mod targets;
mod tiles;
mod uniforms;

use std::collections::HashMap;

use half::f16;
use orogeny_field::{PageLayout, TerrainGrid};
use orogeny_gpu::{Drawing, Gpu, Result};

use self::materials::Materials;
use self::page_texture::PageTexture;
use self::pipelines::Pipelines;
use self::shadow_maps::ShadowMaps;
use self::tiles::{Batch, Lists, Placed};
use self::uniforms::{FrameParts, split};
use crate::material::{ResolvedSet, SetRule, SurfaceTexture};
use crate::{
    Bounds, Camera, Cascade, Holder, MAX_COARSENING, PagePlace, PageRelief, PageSummaries, PageTable,
    SKY_SIZE, Sky, Slots, cascades, indices, select, wanted_pages,
};

pub use materials::MaterialUniform;
pub use scene::{Cursor, Fog, Light, Mode, Overlay, Scene};
pub use targets::Targets;
pub use uniforms::{FrameUniform, MAX_CURSORS, TileInstance};

/// Tiles of a picture, those out of sight too: with those of the shadow maps they fit into one binding.
const MAX_TILES: usize = 1 << 16;

/// Texels a side of a shadow map.
const SHADOW_TEXELS: u32 = 2048;

/// What a frame consisted of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FrameReport {
    /// Tiles of the picture.
    pub num_tiles: u32,
    /// Triangles of the picture, those without an area too.
    pub num_triangles: u64,
    /// Draw calls of the picture's ground.
    pub num_draw_calls: u32,
    /// Pages that it was drawn from.
    pub num_pages: u32,
    /// Pages that it would have wanted beside these: on their way, or without room.
    pub num_missing: u32,
}

/// Draws one terrain on one device.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    grid: TerrainGrid,
    layout: PageLayout,
    unpainted_m: f32,
    heights: PageTexture,
    /// Of no slot, until there is one for every slot of the heights.
    overlay: PageTexture,
    slots: Slots,
    /// What the next picture is drawn from, of what it wants.
    active: HashMap<PagePlace, Holder>,
    /// What it would have wanted beside these.
    num_missing: u32,
    /// Of pages and what lies over them, so far.
    uploaded_bytes: u64,
    pipelines: Pipelines,
    shadow_maps: ShadowMaps,
    sky: Option<(Sky, wgpu::TextureView)>,
    materials: Materials,
    smooth_sampler: wgpu::Sampler,
    shadow_sampler: wgpu::Sampler,
    /// By the logarithm of their steps.
    meshes: Vec<Mesh>,
}

/// What all tiles of one step share.
#[derive(Debug)]
struct Mesh {
    faces: wgpu::Buffer,
    num_face_indices: u32,
    edges: wgpu::Buffer,
    num_edge_indices: u32,
}

impl Renderer {
    /// For a terrain whose unpainted ground has one height, with pages of so many bytes at most, but 16 MiB at least.
    ///
    /// # Errors
    /// When there is no memory for it, or the driver refuses a shader.
    pub fn new(
        gpu: &Gpu,
        grid: TerrainGrid,
        layout: PageLayout,
        unpainted_m: f32,
        page_budget_in_bytes: u64,
    ) -> Result<Self> {
        let num_slots = u32::try_from(page_budget_in_bytes / layout.size_in_bytes()).unwrap_or(u32::MAX);
        let heights = PageTexture::new(
            gpu,
            "orogeny.drawn.heights",
            wgpu::TextureFormat::R32Float,
            layout,
            num_slots,
            num_pages(&grid, layout),
        )?;
        let sampler = |compare| {
            gpu.device().create_sampler(&wgpu::SamplerDescriptor {
                label: Some("orogeny.smooth"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                compare,
                ..wgpu::SamplerDescriptor::default()
            })
        };
        let meshes = (0..=MAX_COARSENING).map(|step| Mesh::new(gpu, 1 << step)).collect::<Result<_>>()?;
        Ok(Self {
            gpu: gpu.clone(),
            grid,
            layout,
            unpainted_m,
            slots: Slots::new(heights.num_slots()),
            heights,
            overlay: PageTexture::none(gpu, "orogeny.no_overlay", wgpu::TextureFormat::R32Float, layout)?,
            active: HashMap::new(),
            num_missing: 0,
            uploaded_bytes: 0,
            pipelines: Pipelines::new(gpu)?,
            shadow_maps: ShadowMaps::new(gpu, SHADOW_TEXELS)?,
            sky: None,
            materials: Materials::new(gpu, plain_set(), &[])?,
            smooth_sampler: sampler(None),
            shadow_sampler: sampler(Some(wgpu::CompareFunction::LessEqual)),
            meshes,
        })
    }

    /// Says from where the next picture is seen; gives the pages that it lacks, most urgent first. It is drawn from no others than those that it
    /// wants, so that it does not depend on what was seen before.
    pub fn want<S: PageSummaries>(
        &mut self,
        camera: &Camera,
        scene: &Scene,
        relief: &PageRelief<'_, S>,
    ) -> Vec<PagePlace> {
        let room = self.heights.num_slots() as usize;
        let (wanted, num_left_out) =
            wanted_pages(&self.grid, self.layout, camera, &scene.detail, relief, room);
        let (constant, held): (Vec<_>, Vec<_>) =
            wanted.into_iter().partition(|place| relief.summary(*place).is_constant);
        let missing = self.slots.want(&held);
        let slots = held.iter().filter_map(|place| Some((*place, Holder::Slot(self.slots.slot(*place)?))));
        self.active = constant.into_iter().map(|place| (place, Holder::Constant)).chain(slots).collect();
        self.num_missing = (missing.len() + num_left_out) as u32;
        missing
    }

    /// The height of the ground where nothing is painted, metres, from now on.
    pub const fn set_unpainted_m(&mut self, unpainted_m: f32) {
        self.unpainted_m = unpainted_m;
    }

    /// Takes a material set, resolved for this terrain, with the texture of each of its layers: all of one size, each with all of its levels
    /// from the largest on.
    ///
    /// # Errors
    /// When there is no memory for the textures.
    pub fn set_materials(&mut self, set: ResolvedSet, layers: &[Vec<SurfaceTexture>]) -> Result<()> {
        self.materials = Materials::new(&self.gpu, set, layers)?;
        Ok(())
    }

    /// Draws a picture from the pages that are there.
    ///
    /// # Errors
    /// When there is no memory, or the driver refuses a shader. What a device does later shows when it is waited for.
    pub fn draw<S: PageSummaries>(
        &mut self,
        camera: &Camera,
        scene: &Scene,
        relief: &PageRelief<'_, S>,
        targets: &Targets,
    ) -> Result<FrameReport> {
        self.pipelines.prepare(&self.gpu, scene.mode)?;
        let (eye_m, spacing_m) = (camera.eye_m(), self.grid.spacing_m());
        let eye_sample = [split(eye_m.x, spacing_m).0, split(eye_m.z, spacing_m).0];
        let table = PageTable::new(&self.grid, self.layout, eye_sample, &self.active);
        let drawn = select(&self.grid, camera, &scene.detail, relief, MAX_TILES);
        let tiles = tiles::placed(&drawn, &self.grid, self.layout, relief, &table);
        let in_sight = tiles::in_sight(&tiles, camera);
        let to_sun = scene.sky.to_sun;
        let maps: Vec<Cascade> = match bounds_of(&tiles) {
            Some(ground) if scene.light.has_shadows && to_sun.y > 0.0 => {
                let range = tiles::depth_range(&in_sight, camera);
                cascades(camera, to_sun, range, &ground, self.shadow_maps.texels).to_vec()
            }
            _ => Vec::new(),
        };
        let mut lists = Lists::default();
        let picture = lists.append(in_sight.iter().copied(), 0.0);
        let top_level = self.layout.top_level(&self.grid);
        let of_maps: Vec<_> = maps
            .iter()
            .map(|map| {
                let finest = tiles::finest_of_map(map, &self.grid, top_level);
                lists.append(tiles::in_map(&tiles, map, camera, to_sun), finest)
            })
            .collect();

        let uniform = FrameParts {
            grid: &self.grid,
            layout: self.layout,
            camera,
            scene,
            table: &table,
            cascades: &maps,
            slots_a_side: PageTexture::slots_a_side(self.layout),
            unpainted_m: self.unpainted_m,
        }
        .uniform();
        let frame = Frame {
            uniform: self.buffer(
                "orogeny.frame",
                wgpu::BufferUsages::UNIFORM,
                bytemuck::bytes_of(&uniform),
            )?,
            table: self.buffer(
                "orogeny.page_table",
                wgpu::BufferUsages::STORAGE,
                bytemuck::cast_slice(table.entries()),
            )?,
            tiles: self.buffer(
                "orogeny.tiles",
                wgpu::BufferUsages::STORAGE,
                bytemuck::cast_slice(&lists.instances),
            )?,
            sky: self.sky_view(&scene.sky)?,
            materials: self.buffer(
                "orogeny.materials",
                wgpu::BufferUsages::UNIFORM,
                bytemuck::bytes_of(&self.materials.uniform(eye_m)),
            )?,
        };

        let mut encoder = self
            .gpu
            .device()
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("orogeny.picture") });
        for ((map, batches), layer) in maps.iter().zip(&of_maps).zip(&self.shadow_maps.layers) {
            let seen = uniform.seen_by(map.clip_from_relative);
            let seen =
                self.buffer("orogeny.shadow", wgpu::BufferUsages::UNIFORM, bytemuck::bytes_of(&seen))?;
            let of_map = Frame { uniform: seen, ..frame.clone() };
            let mut pass = depth_pass(&mut encoder, layer);
            self.draw_tiles(&mut pass, &self.pipelines.shadow, &of_map, batches, false);
        }
        self.draw_light(&mut encoder, scene, &frame, &picture, targets);
        self.draw_picture(&mut encoder, scene, &frame, targets);
        self.gpu.queue().submit([encoder.finish()]);

        let triangles = |batch: &Batch| {
            let of_tile = self.meshes.get(batch.step.trailing_zeros() as usize);
            u64::from(of_tile.map_or(0, |mesh| mesh.num_face_indices / 3)) * batch.instances.len() as u64
        };
        Ok(FrameReport {
            num_tiles: in_sight.len() as u32,
            num_triangles: picture.iter().map(triangles).sum(),
            num_draw_calls: picture.len() as u32,
            num_pages: self.active.values().filter(|holder| **holder != Holder::Constant).count() as u32,
            num_missing: self.num_missing,
        })
    }

    /// Ground, sky and water.
    fn draw_light(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        frame: &Frame,
        picture: &[Batch],
        targets: &Targets,
    ) {
        let (light, depth) = (view(&targets.light), view(&targets.depth));
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("orogeny.ground"),
                color_attachments: &[Some(colour(&light, wgpu::LoadOp::Clear(wgpu::Color::BLACK)))],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                ..wgpu::RenderPassDescriptor::default()
            });
            if let Some(faces) = self.pipelines.faces(scene.mode) {
                self.draw_tiles(&mut pass, faces, frame, picture, false);
            }
            if let Some(edges) = self.pipelines.edges(scene.mode) {
                self.draw_tiles(&mut pass, edges, frame, picture, true);
            }
            self.draw_screen(&mut pass, &self.pipelines.sky, frame, &[]);
        }
        if scene.water_level_m.is_some() {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("orogeny.water"),
                color_attachments: &[Some(colour(&light, wgpu::LoadOp::Load))],
                ..wgpu::RenderPassDescriptor::default()
            });
            self.draw_screen(
                &mut pass,
                self.pipelines.water(scene.mode == Mode::Textured),
                frame,
                &[wgpu::BindingResource::TextureView(&depth)],
            );
        }
    }

    /// What a screen shows of the light.
    fn draw_picture(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        frame: &Frame,
        targets: &Targets,
    ) {
        let (light, picture) = (view(&targets.light), view(&targets.picture));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("orogeny.tone"),
            color_attachments: &[Some(colour(&picture, wgpu::LoadOp::Clear(wgpu::Color::BLACK)))],
            ..wgpu::RenderPassDescriptor::default()
        });
        // What is to be read by its colours keeps them.
        let tone = self.pipelines.tone(scene.mode == Mode::Textured);
        self.draw_screen(&mut pass, tone, frame, &[wgpu::BindingResource::TextureView(&light)]);
    }

    fn draw_tiles(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        drawing: &Drawing,
        frame: &Frame,
        batches: &[Batch],
        are_edges: bool,
    ) {
        let own = [
            frame.tiles.as_entire_binding(),
            frame.materials.as_entire_binding(),
            wgpu::BindingResource::TextureView(&self.materials.albedo_heights),
            wgpu::BindingResource::TextureView(&self.materials.normal_roughnesses),
            wgpu::BindingResource::Sampler(&self.materials.sampler),
        ];
        self.bind(pass, drawing, frame, &own);
        for Batch { step, instances } in batches {
            let Some(mesh) = self.meshes.get(step.trailing_zeros() as usize) else { continue };
            let (buffer, num_indices) = if are_edges {
                (&mesh.edges, mesh.num_edge_indices)
            } else {
                (&mesh.faces, mesh.num_face_indices)
            };
            pass.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint16);
            pass.draw_indexed(0..num_indices, 0, instances.clone());
        }
    }

    fn draw_screen(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        drawing: &Drawing,
        frame: &Frame,
        own: &[wgpu::BindingResource<'_>],
    ) {
        self.bind(pass, drawing, frame, own);
        pass.draw(0..3, 0..1);
    }

    /// Sets a pipeline, the frame, and the pipeline's own resources in the order of their bindings.
    fn bind(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        drawing: &Drawing,
        frame: &Frame,
        own: &[wgpu::BindingResource<'_>],
    ) {
        let all = [
            frame.uniform.as_entire_binding(),
            frame.table.as_entire_binding(),
            wgpu::BindingResource::TextureView(self.heights.view()),
            wgpu::BindingResource::TextureView(self.overlay.view()),
            wgpu::BindingResource::TextureView(&frame.sky),
            wgpu::BindingResource::Sampler(&self.smooth_sampler),
            wgpu::BindingResource::TextureView(&self.shadow_maps.all),
            wgpu::BindingResource::Sampler(&self.shadow_sampler),
        ];
        // Shadow maps cannot be bound while they are drawn: a pipeline has what its shaders name.
        pass.set_pipeline(&drawing.pipeline);
        let layouts = drawing.bind_group_layouts.iter().zip(&drawing.num_bindings);
        for ((group, resources), (layout, num)) in (0..).zip([all.as_slice(), own]).zip(layouts) {
            let entries: Vec<_> = (0..)
                .zip(resources.iter().take(*num))
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
                .collect();
            let bind_group = self.gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("orogeny.picture"),
                layout,
                entries: &entries,
            });
            pass.set_bind_group(group, &bind_group, &[]);
        }
    }

    fn buffer(&self, label: &str, usage: wgpu::BufferUsages, content: &[u8]) -> Result<wgpu::Buffer> {
        self.gpu.create_buffer_with(label, usage, content)
    }

    /// The sky's texture, made anew where the sun has moved.
    fn sky_view(&mut self, sky: &Sky) -> Result<wgpu::TextureView> {
        if let Some((known, view)) = &self.sky
            && known == sky
        {
            return Ok(view.clone());
        }
        let [width, height] = SKY_SIZE;
        let texture = self.gpu.create_texture(&wgpu::TextureDescriptor {
            label: Some("orogeny.sky"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })?;
        let texels: Vec<f16> =
            sky.texels.iter().flat_map(|texel| texel.extend(1.0).to_array()).map(f16::from_f64).collect();
        self.gpu.queue().write_texture(
            texture.as_image_copy(),
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 8), rows_per_image: None },
            texture.size(),
        );
        let view = view(&texture);
        self.sky = Some((sky.clone(), view.clone()));
        Ok(view)
    }
}

/// What is made anew for each frame.
#[derive(Debug, Clone)]
struct Frame {
    uniform: wgpu::Buffer,
    table: wgpu::Buffer,
    tiles: wgpu::Buffer,
    sky: wgpu::TextureView,
    materials: wgpu::Buffer,
}

impl Mesh {
    fn new(gpu: &Gpu, step: u32) -> Result<Self> {
        let faces = indices(step);
        let edges: Vec<u16> =
            faces.as_chunks::<3>().0.iter().flat_map(|[a, b, c]| [*a, *b, *b, *c, *c, *a]).collect();
        let buffer = |content: &[u16]| {
            gpu.create_buffer_with("orogeny.mesh", wgpu::BufferUsages::INDEX, bytemuck::cast_slice(content))
        };
        Ok(Self {
            faces: buffer(&faces)?,
            num_face_indices: faces.len() as u32,
            edges: buffer(&edges)?,
            num_edge_indices: edges.len() as u32,
        })
    }
}

/// What there is before a set is given: nothing.
const fn plain_set() -> ResolvedSet {
    let set = SetRule { blend_depth: 1.0, blend_contrast: 0.0, macro_per_m: 0.0, macro_amount: 0.0 };
    ResolvedSet { layers: Vec::new(), set, masks: Vec::new() }
}

/// Pages of all levels.
fn num_pages(grid: &TerrainGrid, layout: PageLayout) -> u32 {
    let of_level = |level: u8| {
        let (columns, rows) = layout.num_pages_at(grid, level);
        columns.saturating_mul(rows)
    };
    (0..=layout.top_level(grid)).map(of_level).fold(0, u32::saturating_add)
}

/// The box of all tiles.
fn bounds_of(tiles: &[Placed]) -> Option<Bounds> {
    tiles
        .iter()
        .map(|placed| placed.bounds)
        .reduce(|a, b| Bounds { min_m: a.min_m.min(b.min_m), max_m: a.max_m.max(b.max_m) })
}

fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

const fn colour<'a>(
    view: &'a wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPassColorAttachment<'a> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
    }
}

fn depth_pass<'a>(encoder: &'a mut wgpu::CommandEncoder, layer: &wgpu::TextureView) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("orogeny.shadow"),
        color_attachments: &[],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: layer,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..wgpu::RenderPassDescriptor::default()
    })
}
