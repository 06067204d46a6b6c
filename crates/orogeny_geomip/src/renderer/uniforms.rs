//! Structs that are copied to the GPU as they lie in memory. Their shaders' side is compared with them by a test.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Mat4};
use orogeny_field::{PageLayout, TerrainGrid};

use crate::page_table::{MAX_LEVELS, PageTable};
use crate::renderer::Scene;
use crate::shadow::{Cascade, MAX_CASCADES};
use crate::{Camera, DrawnTile, MIN_NEAR_M};

/// Brush rings that are drawn at most.
pub const MAX_CURSORS: usize = 32;

/// What all that draws a terrain knows: `shaders/scene/ground.wgsl` says what each field is.
#[derive(Debug, Clone, Copy, PartialEq, Zeroable, Pod)]
#[repr(C)]
#[expect(missing_docs, reason = "said where the shaders have them")]
pub struct FrameUniform {
    pub clip_from_relative: [[f32; 4]; 4],
    pub ray_right: [f32; 3],
    pub near_m: f32,
    pub ray_up: [f32; 3],
    pub eye_height_m: f32,
    pub ray_forward: [f32; 3],
    pub spacing_m: f32,
    pub eye_sample: [i32; 2],
    pub eye_offset_m: [f32; 2],
    pub num_samples: [i32; 2],
    pub page_size_log2: u32,
    pub top_level: u32,
    pub slots_a_side_log2: u32,
    pub unpainted_m: f32,
    pub slope_exaggeration: f32,
    pub exposure: f32,
    pub to_sun: [f32; 3],
    pub ambient_occlusion: f32,
    pub sun_light: [f32; 3],
    pub fog_density: f32,
    pub sky_light: [f32; 3],
    pub fog_falloff: f32,
    pub fog_base_m: f32,
    pub water_level_m: f32,
    pub low_m: f32,
    pub high_m: f32,
    pub contour_m: f32,
    pub metre_px: f32,
    pub overlay_low: f32,
    pub overlay_high: f32,
    pub num_cursors: u32,
    pub num_cascades: u32,
    pub pad_a: u32,
    pub pad_b: u32,
    pub unpainted_overlay: [f32; 4],
    pub cascades: [[[f32; 4]; 4]; MAX_CASCADES],
    pub cascade_texel_m: [f32; 4],
    pub windows: [[i32; 4]; MAX_LEVELS],
    pub cursors: [[f32; 4]; MAX_CURSORS],
}

/// A tile as `shaders/terrain/surface.wgsl` has it.
#[derive(Debug, Clone, Copy, PartialEq, Zeroable, Pod)]
#[repr(C)]
#[expect(missing_docs, reason = "said where the shaders have them")]
pub struct TileInstance {
    pub place: [i32; 2],
    pub level: u32,
    pub detail: f32,
    pub rim: [[f32; 4]; 4],
}

impl From<&DrawnTile> for TileInstance {
    fn from(drawn: &DrawnTile) -> Self {
        let mut rim = [[0.0; 4]; 4];
        for (to, from) in rim.as_flattened_mut().iter_mut().zip(drawn.rim) {
            *to = from;
        }
        Self {
            place: [drawn.tile.x.cast_signed(), drawn.tile.z.cast_signed()],
            level: drawn.tile.level.into(),
            detail: drawn.detail,
            rim,
        }
    }
}

/// Of what a frame is made.
pub(super) struct FrameParts<'a> {
    pub(super) grid: &'a TerrainGrid,
    pub(super) layout: PageLayout,
    pub(super) camera: &'a Camera,
    pub(super) scene: &'a Scene,
    pub(super) table: &'a PageTable,
    pub(super) cascades: &'a [Cascade],
    pub(super) slots_a_side: u32,
    pub(super) unpainted_m: f32,
}

/// The sample to the north-west of a place along one axis, and the metres from there to the place.
pub(super) fn split(place_m: f64, spacing_m: f64) -> (i32, f64) {
    // Far off the terrain there is nothing to be exact about.
    let sample = (place_m / spacing_m).floor().clamp(-1.0e9, 1.0e9);
    (sample as i32, place_m - sample * spacing_m)
}

impl FrameParts<'_> {
    pub(super) fn uniform(&self) -> FrameUniform {
        let Self { grid, camera, scene, .. } = self;
        let eye_m = camera.eye_m();
        let [right, up, backward] = camera.axes();
        let [half_width, half_height] = camera.half_extent();
        let ((x, x_m), (z, z_m)) = (split(eye_m.x, grid.spacing_m()), split(eye_m.z, grid.spacing_m()));
        let vector = |vector: DVec3| vector.as_vec3().to_array();
        let mut cascades = [[[0.0; 4]; 4]; MAX_CASCADES];
        let mut cascade_texel_m = [0.0; 4];
        for ((matrix, texel_m), cascade) in cascades.iter_mut().zip(&mut cascade_texel_m).zip(self.cascades) {
            (*matrix, *texel_m) = (cascade.clip_from_relative.to_cols_array_2d(), cascade.texel_m as f32);
        }
        let mut cursors = [[0.0; 4]; MAX_CURSORS];
        for (to, cursor) in cursors.iter_mut().zip(&scene.cursors) {
            let [x, z] = [cursor.centre_m[0] - eye_m.x, cursor.centre_m[1] - eye_m.z];
            *to = [x as f32, z as f32, cursor.radius_m, cursor.hardness];
        }
        FrameUniform {
            clip_from_relative: camera.clip_from_relative().to_cols_array_2d(),
            ray_right: vector(right * half_width),
            near_m: MIN_NEAR_M as f32,
            ray_up: vector(up * half_height),
            eye_height_m: eye_m.y as f32,
            ray_forward: vector(-backward),
            spacing_m: grid.spacing_m() as f32,
            eye_sample: [x, z],
            eye_offset_m: [x_m as f32, z_m as f32],
            num_samples: [grid.width().cast_signed(), grid.depth().cast_signed()],
            page_size_log2: self.layout.size().trailing_zeros(),
            top_level: self.layout.top_level(grid).into(),
            slots_a_side_log2: self.slots_a_side.trailing_zeros(),
            unpainted_m: self.unpainted_m,
            slope_exaggeration: scene.light.slope_exaggeration,
            exposure: scene.light.exposure,
            to_sun: vector(scene.sky.to_sun),
            ambient_occlusion: scene.light.ambient_occlusion,
            sun_light: vector(scene.sky.sun_light),
            fog_density: scene.fog.density,
            sky_light: vector(scene.sky.sky_light),
            fog_falloff: scene.fog.falloff,
            fog_base_m: scene.fog.base_m,
            water_level_m: scene.water_level_m.unwrap_or(f32::MIN),
            low_m: scene.range_m[0],
            high_m: scene.range_m[1],
            contour_m: scene.contour_m,
            metre_px: camera.pixels_at_one_metre() as f32,
            overlay_low: scene.overlay_range[0],
            overlay_high: scene.overlay_range[1],
            num_cursors: scene.cursors.len().min(MAX_CURSORS) as u32,
            num_cascades: self.cascades.len() as u32,
            pad_a: 0,
            pad_b: 0,
            unpainted_overlay: scene.unpainted_overlay,
            cascades,
            cascade_texel_m,
            windows: self.table.windows(),
            cursors,
        }
    }
}

impl FrameUniform {
    /// The same frame as another view sees it.
    pub(super) fn seen_by(&self, clip_from_relative: Mat4) -> Self {
        Self { clip_from_relative: clip_from_relative.to_cols_array_2d(), ..*self }
    }
}
