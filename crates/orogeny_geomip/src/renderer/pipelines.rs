//! The render pipelines of all passes; those of modes are built when first asked for.

use std::collections::HashMap;

use orogeny_gpu::{Drawing, DrawingRequest, Gpu, Result};

use super::scene::Mode;
use super::targets::{DEPTH_FORMAT, LIGHT_FORMAT, PICTURE_FORMAT};

/// Heights are `R32Float`, which nothing filters.
const UNFILTERED: [&str; 2] = ["heights", "overlay"];

/// How the ground is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Ground {
    Textured,
    Analysis(u32),
    Lines,
}

/// What a device has built.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub(super) shadow: Drawing,
    pub(super) sky: Drawing,
    /// These two by whether the tone curve is applied.
    water: [Drawing; 2],
    tone: [Drawing; 2],
    ground: HashMap<Ground, Drawing>,
}

const fn depth(compare: wgpu::CompareFunction, is_written: bool) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(is_written),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState {
            front: wgpu::StencilFaceState::IGNORE,
            back: wgpu::StencilFaceState::IGNORE,
            read_mask: 0,
            write_mask: 0,
        },
        bias: wgpu::DepthBiasState { constant: 0, slope_scale: 0.0, clamp: 0.0 },
    }
}

const fn target(format: wgpu::TextureFormat, blend: Option<wgpu::BlendState>) -> wgpu::ColorTargetState {
    wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL }
}

const SURFACE: DrawingRequest<'static> = DrawingRequest {
    vertex: "terrain/surface",
    fragment: None,
    constants: &[],
    colour: None,
    depth: Some(depth(wgpu::CompareFunction::Greater, true)),
    topology: wgpu::PrimitiveTopology::TriangleList,
    unfiltered: &UNFILTERED,
};

impl Pipelines {
    pub(super) fn new(gpu: &Gpu) -> Result<Self> {
        let screen = DrawingRequest { vertex: "terrain/screen", depth: None, ..SURFACE };
        let tone = |is_filmic: u32| {
            gpu.drawing(&DrawingRequest {
                fragment: Some("terrain/tone"),
                constants: &[("IS_FILMIC", is_filmic)],
                colour: Some(target(PICTURE_FORMAT, None)),
                ..screen.clone()
            })
        };
        let water = |is_toned: u32| {
            gpu.drawing(&DrawingRequest {
                fragment: Some("terrain/water"),
                constants: &[("IS_TONED", is_toned)],
                colour: Some(target(LIGHT_FORMAT, Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING))),
                ..screen.clone()
            })
        };
        Ok(Self {
            shadow: gpu.drawing(&DrawingRequest {
                depth: Some(depth(wgpu::CompareFunction::Less, true)),
                ..SURFACE
            })?,
            sky: gpu.drawing(&DrawingRequest {
                fragment: Some("terrain/sky"),
                colour: Some(target(LIGHT_FORMAT, None)),
                // At depth 0: where there is nothing else.
                depth: Some(depth(wgpu::CompareFunction::GreaterEqual, false)),
                ..screen.clone()
            })?,
            water: [water(0)?, water(1)?],
            tone: [tone(0)?, tone(1)?],
            ground: HashMap::new(),
        })
    }

    /// Builds what a mode needs.
    pub(super) fn prepare(&mut self, gpu: &Gpu, mode: Mode) -> Result<()> {
        for ground in Self::grounds(mode) {
            if self.ground.contains_key(&ground) {
                continue;
            }
            let (fragment, number) = match ground {
                Ground::Textured => ("terrain/textured", 0),
                Ground::Analysis(number) => ("terrain/analysis", number),
                Ground::Lines => ("terrain/lines", 0),
            };
            let drawing = gpu.drawing(&DrawingRequest {
                fragment: Some(fragment),
                constants: &[("MODE", number), ("IS_LINE", u32::from(ground == Ground::Lines))],
                colour: Some(target(LIGHT_FORMAT, None)),
                topology: if ground == Ground::Lines {
                    wgpu::PrimitiveTopology::LineList
                } else {
                    wgpu::PrimitiveTopology::TriangleList
                },
                depth: Some(depth(wgpu::CompareFunction::GreaterEqual, true)),
                ..SURFACE
            })?;
            self.ground.insert(ground, drawing);
        }
        Ok(())
    }

    fn grounds(mode: Mode) -> impl Iterator<Item = Ground> {
        let first = if mode == Mode::Textured { Ground::Textured } else { Ground::Analysis(mode.analysis()) };
        [Some(first), (mode == Mode::Wireframe).then_some(Ground::Lines)].into_iter().flatten()
    }

    /// What draws the ground's faces in a mode that was [`prepare`](Self::prepare)d.
    pub(super) fn faces(&self, mode: Mode) -> Option<&Drawing> {
        self.ground.get(&Self::grounds(mode).next()?)
    }

    /// What draws its edges, in a mode that shows them.
    pub(super) fn edges(&self, mode: Mode) -> Option<&Drawing> {
        self.ground.get(&Self::grounds(mode).nth(1)?)
    }

    /// What draws water.
    pub(super) const fn water(&self, is_toned: bool) -> &Drawing {
        let [plain, toned] = &self.water;
        if is_toned { toned } else { plain }
    }

    /// What makes a picture of light.
    pub(super) fn tone(&self, is_filmic: bool) -> &Drawing {
        let [plain, filmic] = &self.tone;
        if is_filmic { filmic } else { plain }
    }
}
